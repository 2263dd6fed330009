// Fracture of a body: links are tested and removed, and each connected part becomes a body. Ohta et al. 2009, "Fracturing".

#include "body/body.h"
#include "body/breaking.h"
#include "body/levels/levels.h"

#include "fracture/constants.h"
#include "fracture/shards/shard_cracks.h"
#include "lattice/attempt.h"
#include "lattice/axis_neighbours.h"
#include "matching/step/lattice_matcher.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace pliant {

namespace {

Result<std::vector<float>> sampleToughness( const Lattice& lattice, const ToughnessField& field )
{
	using Answer = Result<std::vector<float>>;
	std::vector<float> toughness;
	if ( !field.fraction )
	{
		return Answer::success( std::move( toughness ) );
	}
	const Vec3 shift = lattice.massCentre.cast<float>();
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			const std::uint32_t j = lattice.linkTo[k];
			if ( j < i )
			{
				continue;
			}
			const Vec3 point = 0.5f * ( lattice.restCentre[i] + lattice.restCentre[j] ) + shift;
			const Vec3 direction = ( lattice.restCentre[j] - lattice.restCentre[i] ).normalized();
			const float fraction = field.fraction( point.data(), direction.data(), field.context );
			if ( !( fraction > 0.0f ) )
			{
				return Answer::failure( ResultCode::BadArgument, "ToughnessField: a fraction is not above 0." );
			}
			toughness.push_back( fraction );
		}
	}
	return Answer::success( std::move( toughness ) );
}

Result<GivenCentres> readCentres( const Fracture& fracture, const ShardCentres& centres )
{
	using Answer = Result<GivenCentres>;
	GivenCentres given;
	if ( fracture.rule != BreakRule::Shards || ( !centres.points && centres.count == 0 ) )
	{
		return Answer::success( std::move( given ) );
	}
	if ( !centres.points || centres.count < 2 || centres.count > kMostShardCentres )
	{
		return Answer::failure( ResultCode::BadArgument, "ShardCentres: there must be 2 to 100 000 centres." );
	}
	for ( int k = 0; k < centres.count; ++k )
	{
		const Vec3 position = Eigen::Map<const Vec3>( centres.points + 3 * std::size_t( k ) );
		if ( !position.allFinite() || position.cwiseAbs().maxCoeff() > kFarthestCentre )
		{
			return Answer::failure( ResultCode::BadArgument, "ShardCentres: a coordinate is not finite, or beyond 1e6 m." );
		}
		const int shard = centres.shards ? centres.shards[k] : k;
		if ( shard < 0 )
		{
			return Answer::failure( ResultCode::BadArgument, "ShardCentres: the number of a shard is below 0." );
		}
		given.position.push_back( position.cast<double>() );
		given.shard.push_back( std::uint32_t( shard ) );
	}
	return Answer::success( std::move( given ) );
}

} // namespace

Breaking::Breaking() = default;

Breaking::~Breaking() = default;

void Breaking::prepare( const Lattice& lattice, const Material& material, std::vector<float> toughness )
{
	const float strain = breakStrain( settings, material );
	if ( shards )
	{
		shards->setLaw( strain, double( material.youngsModulus ) );
	}
	if ( settings.rule == BreakRule::Plane )
	{
		planes = std::make_unique<PlaneCracks>( strain, settings.growthFraction );
	}
	std::vector<ThinCell> thin = std::move( limits.thin );
	limits = limitLinks( lattice, candidateStrain( strain ), std::move( toughness ) );
	limits.thin = std::move( thin );
}

float Breaking::candidateStrain( float strain ) const
{
	return planes ? planes->candidateStrain() : shards ? shards->candidateStrain() : strain;
}

Status Body::setFracture( const Fracture& fracture, const ToughnessField& field, const ShardCentres& centres )
{
	return withinMemory( "Not enough memory for what a body of this many links needs to break.", [&]() {
		insist( check( fracture ) );
		if ( fracture.rule == BreakRule::Never )
		{
			m_fracture = fracture;
			m_breaking.reset();
			return;
		}
		rejectIf( m_material.method != Method::Lattice, ResultCode::BadSettings, "Fracture needs Method::Lattice." );
		std::vector<float> toughness = insist( sampleToughness( *m_lattice, field ) );
		const GivenCentres given = insist( readCentres( fracture, centres ) );
		auto breaking = std::make_unique<Breaking>();
		breaking->settings = fracture;
		// A piece keeps what its cells were parts of.
		breaking->limits.thin = m_breaking ? m_breaking->limits.thin : findThinCells( *m_lattice );
		if ( fracture.rule == BreakRule::Shards )
		{
			breaking->shards = std::make_unique<ShardCracks>( *m_lattice, fracture, given );
		}
		breaking->prepare( *m_lattice, m_material, std::move( toughness ) );
		m_breaking = std::move( breaking );
		m_fracture = fracture;
		refineBeforeBreaking();
	} );
}

// Coarse nodes are split while the cells under them are still connected: a crack then never runs through one.
void Body::refineBeforeBreaking()
{
	if ( m_levels )
	{
		const float strain = std::min(
			kRefineBeforeBreak * m_breaking->limits.weakest * breakStrain( m_breaking->settings, m_material ), kLargestBreakStrain );
		m_levels->setRefineStretch( strain, kRefineTogether );
	}
}

namespace {

/// Centre and normal of a set of points: the mean, and the direction in which they spread least.
void fitPlane( const std::vector<Vec3d>& points, Vec3d& middle, Vec3d& normal )
{
	Vec3d sum = Vec3d::Zero();
	for ( const Vec3d& point : points )
	{
		sum += point;
	}
	middle = sum / double( points.size() );
	Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
	for ( const Vec3d& point : points )
	{
		spread += ( point - middle ) * ( point - middle ).transpose();
	}
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver( spread );
	normal = solver.eigenvectors().col( 0 );
}

} // namespace

namespace {

/// Merges `more` into `some`; returns how many links were new.
int join( std::vector<CellLink>& some, const std::vector<CellLink>& more )
{
	std::vector<CellLink> all;
	std::set_union( some.begin(), some.end(), more.begin(), more.end(), std::back_inserter( all ) );
	const int added = int( all.size() - some.size() );
	some = std::move( all );
	return added;
}

} // namespace

int Body::breakLinks( const std::vector<CellLink>& links )
{
	return join( m_cutLinks, links );
}

int Body::healLinks( const std::vector<CellLink>& links )
{
	return join( m_healedLinks, links );
}

bool Body::hasBrokenLinks() const
{
	return !m_cutLinks.empty() || !m_healedLinks.empty() || ( m_breaking && !m_breaking->broken.empty() );
}

std::vector<CellLink> Body::brokenLinks() const
{
	std::vector<CellLink> all = m_cutLinks;
	if ( m_breaking )
	{
		all.clear();
		std::set_union(
			m_cutLinks.begin(), m_cutLinks.end(), m_breaking->broken.begin(), m_breaking->broken.end(), std::back_inserter( all ) );
	}
	return all;
}

std::vector<std::uint32_t> Body::nodesAboveBroken() const
{
	std::vector<std::uint32_t> above;
	std::vector<CellLink> links = brokenLinks();
	links.insert( links.end(), m_healedLinks.begin(), m_healedLinks.end() );
	for ( const CellLink& link : links )
	{
		for ( const std::uint32_t cell : { link.a, link.b } )
		{
			const std::uint32_t node = m_levels->cut().node[m_levels->cut().slotOfCell[cell]];
			if ( node != cell )
			{
				above.push_back( node );
			}
		}
	}
	addNodesOfRigidPieces( above );
	std::sort( above.begin(), above.end() );
	above.erase( std::unique( above.begin(), above.end() ), above.end() );
	return above;
}

bool Body::mustRefineToBreak() const
{
	return m_levels && hasBrokenLinks() && !nodesAboveBroken().empty();
}

// Once all of them are finest ones, breakApart follows and measures the surroundings of the links again.
void Body::refineToBreak()
{
	const std::vector<std::uint32_t> nodes = nodesAboveBroken();
	const bool isLast = std::all_of(
		nodes.begin(), nodes.end(), [this]( std::uint32_t node ) { return m_levels->octree().levelOf( node ) == 1; } );
	if ( isLast && !m_matcher->hasFlowed() ) // plastic flow is measured immediately, using the tables
	{
		m_levels->skipRows();
	}
	changeLevels( nodes, {} );
}

// A link represents a thirteenth of a cell: 26 links per cell, each shared by two.
double Body::energyOf( const std::vector<CellLink>& links ) const
{
	const double d = m_lattice->cellSize, energyPerLink = 0.5 * m_material.youngsModulus * d * d * d / 13.0;
	double sum = 0.0;
	for ( const CellLink& link : links )
	{
		const int a = nodeOfCell( link.a ), b = nodeOfCell( link.b );
		const double rest = ( m_nodes.x0.get( a ) - m_nodes.x0.get( b ) ).norm();
		const double strain = a != b ? std::max( 0.0, double( ( m_nodes.x.get( b ) - m_nodes.x.get( a ) ).norm() ) / rest - 1.0 ) : 0.0;
		sum += energyPerLink * strain * strain;
	}
	return sum;
}

BreakReport Body::reportOn( const std::vector<CellLink>& broken ) const
{
	BreakReport report;
	report.links = int( broken.size() );
	// Those that broke by themselves did so in another shape.
	report.energy = energyOf( m_cutLinks ) + ( m_breaking && !m_breaking->broken.empty() ? m_breaking->energy : 0.0 );
	const double d = m_lattice->cellSize;
	std::vector<Vec3d> middles;
	for ( const CellLink& link : broken )
	{
		report.area += shareFace( *m_lattice, link.a, link.b ) ? d * d : 0.0;
		const int a = nodeOfCell( link.a ), b = nodeOfCell( link.b );
		if ( a != b )
		{
			const Vec3 apart = m_nodes.x.get( b ) - m_nodes.x.get( a );
			report.partingVelocity += double( ( m_nodes.v.get( b ) - m_nodes.v.get( a ) ).dot( apart.stableNormalized() ) );
			middles.push_back( ( m_nodes.x.get( a ) + 0.5f * apart ).cast<double>() );
		}
	}
	if ( !middles.empty() )
	{
		report.partingVelocity /= double( middles.size() );
		fitPlane( middles, report.point, report.normal );
	}
	if ( m_breaking && m_breaking->shards )
	{
		report.traces = m_breaking->shards->tracesOf( *m_lattice, broken );
		for ( const CutTrace& trace : report.traces ) // the border's own area: the lattice's steps have more
		{
			const Vec3 axis = ( m_lattice->coordinate[trace.link.b] - m_lattice->coordinate[trace.link.a] ).cast<float>();
			report.area -= d * d * ( 1.0 - double( std::fabs( trace.normal.dot( axis ) ) ) );
		}
	}
	return report;
}

} // namespace pliant
