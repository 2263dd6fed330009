// Which links of a body break, and the shape in which they are tested. Ohta et al. 2009, "Fracturing"; docs/design/fracture.md, "Impacts
// on stiff bodies".

#include "body/body.h"
#include "body/breaking.h"
#include "body/implicit/implicit_motion.h"
#include "body/levels/levels.h"

#include "fracture/constants.h"
#include "fracture/shards/shard_cracks.h"
#include "matching/rotation.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// Time for a crack to cross a cell, s: it grows by one or two cells with each test of the body.
float cellCrackTime( const Lattice& lattice, const Material& material )
{
	const float waves = std::sqrt( material.youngsModulus / material.density );
	return material.stiffness == Stiffness::YoungsModulus ? lattice.cellSize / ( kCrackSpeed * waves ) : 0.0f;
}

/// While it exists, nodes have the positions in which links are tested.
class TestedShape
{
public:
	TestedShape( NodeState& nodes, Breaking& breaking, const ConnectedParts* parts ) :
		m_nodes( nodes ), m_breaking( breaking ), m_isChanged( !breaking.unturned.empty() || !breaking.peak.empty() )
	{
		if ( !m_isChanged )
		{
			return;
		}
		breaking.untested = nodes.x;
		const Vec3 middle = nodes.x.get( 0 );
		for ( int i = 0; i < nodes.count; ++i )
		{
			Vec3 x = nodes.x.get( i ) - middle;
			if ( !breaking.unturned.empty() )
			{
				x = breaking.unturned[std::size_t( parts->partOf( i ) )] * x;
			}
			for ( int k = 0; k < 3 && !breaking.peak.empty(); ++k )
			{
				x[k] += breaking.peak[std::size_t( k * nodes.padded + i )];
			}
			nodes.x.set( i, x );
		}
	}
	~TestedShape()
	{
		if ( m_isChanged )
		{
			std::swap( m_nodes.x, m_breaking.untested );
		}
	}
	TestedShape( const TestedShape& ) = delete;
	TestedShape& operator=( const TestedShape& ) = delete;

private:
	NodeState& m_nodes;
	Breaking& m_breaking;
	bool m_isChanged;
};

/// The symmetric factor of a matrix.
Eigen::Matrix3f shrinkingOf( const Eigen::Matrix3f& unturned )
{
	return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f>( unturned.transpose() * unturned ).operatorSqrt();
}

/// The first thin cell under a node of the octree; null where there is none.
const ThinCell* thinIn( ShardCracks& shards, const Octree& octree, std::uint32_t node )
{
	const ThinCell* found = nullptr;
	for ( std::uint32_t k = octree.cellStart[node]; !found && k < octree.cellStart[node] + octree.cellCount[node]; ++k )
	{
		found = shards.faces().thinCellOf( octree.cells[k] );
	}
	return found;
}

} // namespace

// A crack between shards may start under a coarse node: it is split before the links break.
void Body::noteCoarseOverloads()
{
	const Octree& octree = m_levels->octree();
	const std::vector<std::uint32_t>& above = m_levels->cut().node;
	std::vector<std::uint32_t> coarse;
	for ( std::uint32_t i = 0; i < std::uint32_t( above.size() ); ++i )
	{
		if ( octree.cellCount[above[i]] > 1 )
		{
			coarse.push_back( i );
		}
	}
	std::vector<float> gradients( coarse.size() * 9 );
	nodeDeformationsOf( coarse, gradients.data() );
	for ( std::size_t k = 0; k < coarse.size(); ++k )
	{
		Eigen::Matrix3f gradient = Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>( gradients.data() + 9 * k );
		// F was measured before the step, where the tangents of the last one had stretched the part: by as much as this one's do, unless
		// the rotation has just begun.
		if ( const std::vector<Eigen::Matrix3f>& unturned = m_breaking->unturned; !unturned.empty() )
		{
			gradient = shrinkingOf( unturned[std::size_t( m_implicit->parts().partOf( int( coarse[k] ) ) )] ) * gradient;
		}
		const std::uint32_t node = above[coarse[k]], middle = octree.cellStart[node] + std::uint32_t( octree.cellCount[node] ) / 2;
		// F of a node in one layer has the normal of the layer before the step: across it, it is no strain.
		if ( const ThinCell* const thin = thinIn( *m_breaking->shards, octree, node ) )
		{
			gradient -= gradient * thin->normal[0] * thin->normal[0].transpose();
		}
		m_breaking->shards->noteOverload( *m_lattice, m_breaking->limits, octree.cells[middle], gradient.cast<double>() );
	}
}

// With x = x' + h v the nodes of a part that rotates by the angular velocity w are at
//
//   x = ( 1 + h [ w ]x ) ( r + e )
//
// r + e their former positions and what has strained them since, and the tangents' stretch by ( h w )^2 / 2 is none of the material. The
// next step takes it back where sound crosses the part within it. Cells under coarse nodes of one layer have the rotation that was fitted
// in the former positions: bodies on levels are tested in the former orientation.
void Body::noteTurns( float h )
{
	if ( !m_breaking )
	{
		return;
	}
	std::vector<Eigen::Matrix3f>& unturned = m_breaking->unturned;
	unturned.clear();
	if ( !m_wasImplicit || !m_implicit )
	{
		return;
	}
	const double least = kTestedTurn * weakestBreakStrain();
	double most = 0.0;
	const int parts = m_implicit->parts().count();
	unturned.reserve( std::size_t( parts ) );
	for ( int p = 0; p < parts; ++p )
	{
		const PartTurn turn = turnOf( p, h );
		if ( turn.isArc && !m_levels && m_breaking->peak.empty() ) // peaks are displacements from the former positions
		{
			unturned.push_back( Eigen::Matrix3f::Identity() );
			continue;
		}
		most = std::max( most, m_levels ? turn.angle : 0.5 * turn.angle * turn.angle );
		unturned.push_back( turn.moved.inverse().cast<float>() );
	}
	if ( most < least )
	{
		unturned.clear();
	}
}

void Body::noteImpact( const float* peak, double energy )
{
	m_breaking->impactEnergy = energy;
	m_breaking->peak.assign( peak, peak + 3 * m_nodes.padded );
}

void Body::restLinks( float h )
{
	if ( m_breaking )
	{
		m_breaking->coolDown -= h;
		m_breaking->sinceTest += h;
	}
}

void Body::testLinks( float h )
{
	if ( !m_breaking )
	{
		return;
	}
	Breaking& b = *m_breaking;
	b.coolDown -= h;
	const bool isCool = b.coolDown <= 0.0f;
	if ( b.broken.empty() && ( isCool || b.planes ) )
	{
		const TestedShape shape( m_nodes, b, m_implicit ? &m_implicit->parts() : nullptr );
		findBroken( h, isCool );
		// A crack grows by a cell or two in each test, and the peak of an impact is tested within one step.
		for ( std::size_t before = 0; b.planes && !b.peak.empty() && before < b.broken.size(); )
		{
			before = b.broken.size();
			b.planes->find( *m_lattice, b.limits, testedPositions(), 0.0f, false, b.broken );
		}
		b.energy = energyOf( b.broken );
		if ( !b.broken.empty() && !b.limits.thin.empty() )
		{
			b.faces.update( *m_lattice, b.limits, testedPositions(), double( weakestBreakStrain() ) );
			b.energy += double( m_material.youngsModulus ) * b.faces.hiddenEnergy( b.broken );
		}
		b.energy = b.peak.empty() ? b.energy : std::min( b.energy, b.impactEnergy );
	}
	b.peak.clear();
}

CellPositions Body::testedPositions()
{
	return m_levels
		? CellPositions( m_nodes, m_levels->cut(), m_breaking->refinementStates.update( *m_lattice, m_levels->cut(), m_levels->version() ) )
		: CellPositions( m_nodes );
}

/// Marks the links that break in the nodes' present positions.
void Body::findBroken( float h, bool isCool )
{
	Breaking& b = *m_breaking;
	bool hasBegun = false;
	if ( b.shards )
	{
		b.sinceTest += h;
		const float waves = std::sqrt( m_material.youngsModulus / m_material.density );
		if ( b.shards->canBreak() && b.sinceTest * waves > kTestDistance * float( b.shards->law().size ) )
		{
			b.sinceTest = 0.0f;
			b.shards->findOverloads( *m_lattice, b.limits, testedPositions() );
			m_levels ? noteCoarseOverloads() : void();
			const bool isOverloaded = b.shards->run(
				*m_lattice, b.limits, [this] { return cellPositions(); }, b.broken );
			b.coolDown = isOverloaded ? kRetryFraction * b.settings.coolDown : b.coolDown; // a crack sets all of it, below
		}
	}
	else if ( b.planes )
	{
		b.sinceTest += h;
		if ( b.planes->count() > 0 && b.sinceTest + 0.5f * h < cellCrackTime( *m_lattice, m_material ) )
		{
			return;
		}
		hasBegun = b.planes->find( *m_lattice, b.limits, testedPositions(), b.sinceTest, isCool, b.broken );
		b.sinceTest = 0.0f;
	}
	else
	{
		m_levels ? findOverstretched( b.limits, testedPositions(), b.broken ) : findOverstretched( b.limits, m_nodes, b.broken );
		if ( !b.limits.thin.empty() )
		{
			b.faces.update( *m_lattice, b.limits, testedPositions(), double( weakestBreakStrain() ) );
			b.faces.findOverbent( b.limits, testedPositions(), b.broken );
		}
	}
	if ( hasBegun || ( !b.planes && !b.broken.empty() ) )
	{
		b.coolDown = b.settings.coolDown;
	}
}

} // namespace pliant
