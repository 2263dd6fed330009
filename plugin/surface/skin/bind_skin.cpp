// Which nodes move a vertex. Steinemann et al. 2008, section 7; trilinear embedding: Rivers and James 2007, section 4.

#include "surface/skin/cell_finder.h"
#include "surface/skin/skinning.h"

#include "lattice/union_find.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace pliant {

namespace {

constexpr std::uint32_t kNoGroup = std::numeric_limits<std::uint32_t>::max();

/// Radius of a cell's say over vertices, in cells. At 1.4 a point always has at least two cells of full material in reach, no cell
/// beyond the 27 around it has any say, and on the middles, faces and corners of cells a linear field is met exactly.
constexpr double kSupport = 1.4;

/// ( 1 - r^2 / R^2 )^2 within R, with zero slope at the border: a vertex that slides over the material changes hands without a jerk.
double nearbyWeight( const Vec3d& fromMiddle )
{
	const double rest = 1.0 - fromMiddle.squaredNorm() / ( kSupport * kSupport );
	return rest > 0.0 ? rest * rest : 0.0;
}

/// The cell's weight in the cube of eight cells' middles that holds the point.
double trilinearWeight( const Vec3d& fromMiddle )
{
	return ( 1.0 - fromMiddle.array().abs() ).max( 0.0 ).prod();
}

/// Vertices at one place, taken as one.
struct Spot
{
	Vec3d point = Vec3d::Zero();   ///< m, mesh coordinates
	Vec3d outward = Vec3d::Zero(); ///< area-weighted normal of the rest mesh, unit, or zero
	std::uint32_t first = 0;       ///< its shares in the table of shares
	std::uint32_t last = 0;
};

struct Share
{
	std::uint32_t node;
	double weight;
};

Vec3d meshVertex( const MeshView& mesh, std::size_t i )
{
	const float* p = mesh.positions + i * mesh.positionStride;
	return { p[0], p[1], p[2] };
}

void numberGroups( const MeshView& mesh, const std::vector<std::uint32_t>& weldedVertex, SkinBinding& binding )
{
	std::vector<std::uint32_t> number( mesh.vertexCount, kNoGroup );
	binding.normalGroup.resize( mesh.vertexCount );
	for ( std::size_t i = 0; i < mesh.vertexCount; ++i )
	{
		std::uint32_t& group = number[weldedVertex.empty() ? i : weldedVertex[i]];
		if ( group == kNoGroup )
		{
			group = std::uint32_t( binding.normalGroups++ );
		}
		binding.normalGroup[i] = group;
	}
}

std::vector<Spot> makeSpots( const MeshView& mesh, const SkinBinding& binding )
{
	std::vector<Spot> spots( binding.normalGroups );
	for ( std::size_t i = mesh.vertexCount; i-- > 0; ) // the first vertex of a group stands for it
	{
		spots[binding.normalGroup[i]].point = meshVertex( mesh, i );
	}
	for ( std::size_t t = 0; t < mesh.triangleCount; ++t )
	{
		const std::uint32_t* corner = mesh.indices + 3 * t;
		const Vec3d a = meshVertex( mesh, corner[0] ), b = meshVertex( mesh, corner[1] ), c = meshVertex( mesh, corner[2] );
		const Vec3d area = ( b - a ).cross( c - a );
		for ( int k = 0; k < 3; ++k )
		{
			spots[binding.normalGroup[corner[k]]].outward += area;
		}
	}
	for ( Spot& spot : spots )
	{
		// Scaled by the largest part first: the square of a tiny triangle's area is nothing.
		const double largest = spot.outward.cwiseAbs().maxCoeff();
		if ( largest > 0.0 )
		{
			spot.outward = ( spot.outward / largest ).normalized();
		}
	}
	return spots;
}

/// Binds one spot after the other.
class Binder
{
public:
	Binder( const Lattice& lattice, Skinning kind ) :
		m_lattice( lattice ), m_kind( kind ), m_finder( lattice ), m_mark( lattice.restCentre.size(), 0 )
	{}

	/// Whether the nearest material lies behind the surface here (1), in front of it (-1), or cannot be told (0).
	int sideOfMaterial( const Spot& spot )
	{
		m_finder.cellsAround( m_finder.positionOf( spot.point ), m_around );
		if ( m_around.empty() )
		{
			return 0;
		}
		const double front = m_finder.inFront( m_finder.owner( spot.point, Vec3d::Zero(), m_around ), spot.point, spot.outward );
		return front < 0.0 ? 1 : front > 0.0 ? -1 : 0;
	}

	/// Appends the spot's shares. Their weights sum to 1.
	void bind( const Spot& spot, bool isInsideOut, std::vector<Share>& fractions )
	{
		m_finder.cellsAround( m_finder.positionOf( spot.point ), m_around );
		const Vec3d outward = isInsideOut ? Vec3d( -spot.outward ) : spot.outward;
		const std::uint32_t owner = std::uint32_t( m_finder.owner( spot.point, outward, m_around ) );
		const std::size_t first = fractions.size();
		double sum = 0.0;
		markLinks( owner );
		for ( const std::uint32_t cell : m_around )
		{
			const Vec3d away = m_finder.fromMiddle( int( cell ), spot.point );
			const double weight = m_kind == Skinning::Trilinear ? trilinearWeight( away ) : nearbyWeight( away );
			if ( weight > 0.0 && isWithinTwoLinks( cell ) )
			{
				fractions.push_back( Share{ cell, weight } );
				sum += weight;
			}
		}
		if ( fractions.size() == first ) // out of every cell's reach
		{
			fractions.push_back( Share{ owner, 1.0 } );
			return;
		}
		for ( std::size_t k = first; k < fractions.size(); ++k )
		{
			fractions[k].weight /= sum;
		}
	}

private:
	/// Marks a cell and those one link away.
	void markLinks( std::uint32_t owner )
	{
		++m_round;
		m_mark[owner] = m_round;
		for ( std::uint32_t k = m_lattice.linkStart[owner]; k < m_lattice.linkStart[owner + 1]; ++k )
		{
			m_mark[m_lattice.linkTo[k]] = m_round;
		}
	}

	/// Two links reach all the 27 cells around, wherever the owner is among them, as long as the material is whole between;
	/// what is across a gap is further away.
	bool isWithinTwoLinks( std::uint32_t cell ) const
	{
		if ( m_mark[cell] == m_round )
		{
			return true;
		}
		const auto first = m_lattice.linkTo.begin() + m_lattice.linkStart[cell],
				   last = m_lattice.linkTo.begin() + m_lattice.linkStart[cell + 1];
		return std::any_of( first, last, [this]( std::uint32_t other ) { return m_mark[other] == m_round; } );
	}

	const Lattice& m_lattice;
	Skinning m_kind;
	CellFinder m_finder;
	std::vector<std::uint32_t> m_mark; ///< of the spot at hand where it equals m_round
	std::uint32_t m_round = 0;
	std::vector<std::uint32_t> m_around;
};

/// Shells whose triangles look inwards, by vote of their vertices: the mesh comes as the artist left it.
std::vector<std::uint8_t> findInsideOut( const MeshView& mesh, const SkinBinding& binding, const std::vector<Spot>& spots, Binder& binder )
{
	UnionFind shells( spots.size() );
	for ( std::size_t t = 0; t < mesh.triangleCount; ++t )
	{
		const std::uint32_t* corner = mesh.indices + 3 * t;
		shells.join( binding.normalGroup[corner[0]], binding.normalGroup[corner[1]] );
		shells.join( binding.normalGroup[corner[0]], binding.normalGroup[corner[2]] );
	}
	std::vector<std::int64_t> votes( spots.size(), 0 );
	for ( std::size_t g = 0; g < spots.size(); ++g )
	{
		votes[shells.find( std::uint32_t( g ) )] += binder.sideOfMaterial( spots[g] );
	}
	std::vector<std::uint8_t> isInsideOut( spots.size() );
	for ( std::size_t g = 0; g < spots.size(); ++g )
	{
		isInsideOut[g] = votes[shells.find( std::uint32_t( g ) )] < 0;
	}
	return isInsideOut;
}

} // namespace

SkinBinding bindSkin( const MeshView& mesh, const Lattice& lattice, const std::vector<std::uint32_t>& weldedVertex, Skinning kind )
{
	SkinBinding binding;
	binding.kind = kind;
	if ( kind == Skinning::None )
	{
		return binding;
	}
	numberGroups( mesh, weldedVertex, binding );
	std::vector<Spot> spots = makeSpots( mesh, binding );
	Binder binder( lattice, kind );
	const std::vector<std::uint8_t> isInsideOut = findInsideOut( mesh, binding, spots, binder );
	std::vector<Share> fractions;
	for ( std::size_t g = 0; g < spots.size(); ++g )
	{
		spots[g].first = std::uint32_t( fractions.size() );
		binder.bind( spots[g], isInsideOut[g] != 0, fractions );
		spots[g].last = std::uint32_t( fractions.size() );
	}

	binding.start.reserve( mesh.vertexCount + 1 );
	binding.start.push_back( 0 );
	binding.restPosition.reserve( mesh.vertexCount );
	binding.restNormal.reserve( mesh.vertexCount );
	for ( std::size_t i = 0; i < mesh.vertexCount; ++i )
	{
		// Vertices of one spot have the same shares to the bit: no seam can open between them.
		const Spot& spot = spots[binding.normalGroup[i]];
		for ( std::uint32_t k = spot.first; k < spot.last; ++k )
		{
			binding.node.push_back( fractions[k].node );
			binding.weight.push_back( float( fractions[k].weight ) );
		}
		binding.start.push_back( std::uint32_t( binding.node.size() ) );
		binding.restPosition.push_back( ( meshVertex( mesh, i ) - lattice.massCentre ).cast<float>() );
		binding.restNormal.push_back( spot.outward.isZero( 0.0 ) ? Vec3( Vec3::UnitZ() ) : Vec3( spot.outward.cast<float>() ) );
	}
	return binding;
}

void SkinBinding::listBlended()
{
	blended.resize( placed.empty() ? 0 : restPosition.size() - placed.size() );
	auto to = blended.begin();
	std::uint32_t next = 0;
	for ( const Placed& of : placed )
	{
		std::iota( to, to + ( of.vertex - next ), next );
		to += of.vertex - next;
		next = of.vertex + 1;
	}
	std::iota( to, blended.end(), next );
}

} // namespace pliant
