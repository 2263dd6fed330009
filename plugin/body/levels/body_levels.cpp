// Construction of a body's nodes, uniform or on several levels, and of their matcher; and changes of its levels.

#include "body/body.h"
#include "body/breaking.h"
#include "body/levels/levels.h"
#include "lattice/assert_valid.h"

#include "matching/clusters/cluster_matcher.h"
#include "matching/step/lattice_matcher.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace pliant {

namespace {

void fillNodes( const Lattice& lattice, const Material& material, NodeState& nodes )
{
	nodes.count = lattice.cellCount();
	nodes.padded = ( nodes.count + kLanes - 1 ) / kLanes * kLanes;
	nodes.x.resize( nodes.padded );
	nodes.v.resize( nodes.padded );
	nodes.x0.resize( nodes.padded );
	nodes.mass.assign( nodes.padded, 0.0f );
	nodes.freedom.assign( nodes.padded, 0.0f );
	const float fullCell = material.density * lattice.cellSize * lattice.cellSize * lattice.cellSize;
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x0.set( i, lattice.restCentre[i] );
		nodes.mass[i] = fullCell * lattice.fill[i];
		nodes.freedom[i] = 1.0f;
	}
}

} // namespace

Status Body::sampleStiffness( const StiffnessField& field )
{
	if ( !field.fraction )
	{
		return {};
	}
	if ( m_material.method != Method::Lattice )
	{
		return Status{ ResultCode::BadArgument, "StiffnessField: stiffness that varies in space needs Method::Lattice." };
	}
	m_stiffness.reserve( m_lattice->fill.size() );
	for ( const Vec3& rest : m_lattice->restCentre )
	{
		const Vec3 point = ( rest.cast<double>() + m_lattice->massCentre ).cast<float>();
		const float fraction = field.fraction( point.data(), field.context );
		if ( !( fraction > 0.0f && fraction <= 1.0f ) )
		{
			return Status{ ResultCode::BadArgument, "StiffnessField: a fraction is not above 0 and at most 1." };
		}
		m_stiffness.push_back( fraction );
	}
	return {};
}

void Body::makeNodes( const Adaptivity& adaptivity )
{
	if ( adaptivity.coarseLevels == 0 )
	{
		fillNodes( *m_lattice, m_material, m_nodes );
		return;
	}
	std::shared_ptr<const LevelBase> base = m_cache ? m_cache->levels.find( *m_lattice, m_material, adaptivity )
													: buildLevelBase( *m_lattice, m_material, adaptivity );
	Cut cut = firstCut( base->octree, adaptivity );
	m_levels = std::make_unique<Levels>( std::move( base ), *m_lattice, m_material, adaptivity, m_stiffness, std::move( cut ) );
	m_levels->fillNodes( m_nodes, m_material.density );
}

std::unique_ptr<Matcher> Body::makeMatcher( const Material& material )
{
	m_levelMatcher = nullptr;
	if ( m_levels )
	{
		auto matcher = std::make_unique<LatticeMatcher>( *m_lattice, material, m_levels->tables() );
		if ( m_levels->hasScratch() )
		{
			matcher->reserveNodes( m_levels->scratchNodes() );
		}
		m_levelMatcher = matcher.get();
		return matcher;
	}
	if ( material.method == Method::Lattice )
	{
		std::shared_ptr<const RegionTables> tables;
		if ( m_stiffness.empty() && m_cache )
		{
			tables = m_cache->regions.find( *m_lattice, material );
		}
		else
		{
			tables = buildRegionTables( *m_lattice, material, Summation::Automatic, m_stiffness );
		}
		auto matcher = std::make_unique<LatticeMatcher>( *m_lattice, material, std::move( tables ) );
		matcher->setFarLevels( material.farLevels, m_stiffness );
		return matcher;
	}
	return makeClusterMatcher( *m_lattice, material, m_nodes );
}

bool Body::reviewLevels( float h )
{
	if ( !m_levels )
	{
		return false;
	}
	m_sinceReview += h;
	if ( m_reviewIn > 0 )
	{
		--m_reviewIn;
		return false;
	}
	m_reviewIn = m_wasImplicit ? 0 : kSubstepsBetweenReviews - 1; // an implicit substep is as long as several explicit ones
	static const std::vector<ThinCell> kNone;
	const bool hasChange = m_levels->review(
		m_nodes, m_levelMatcher->strain(), m_levelMatcher->stretch(), m_breaking ? m_breaking->limits.thin : kNone, m_sinceReview );
	m_sinceReview = 0.0f;
	m_reviewIn = m_levels->isRefining() ? 0 : m_reviewIn;
	return hasChange;
}

void Body::openLevelBudget()
{
	if ( m_levels )
	{
		m_levels->openBudget();
		m_reviewIn = m_levels->hasBacklog() ? 0 : m_reviewIn;
	}
}

void Body::applyLevels( TaskRunner* tasks )
{
	const unsigned before = m_levels->version();
	m_levels->apply( m_nodes, *m_levelMatcher, m_material, tasks, !m_wasImplicit );
	if ( m_levels->version() != before )
	{
		addEnergyDebt( m_levels->lastChange().energy );
	}
	keepFiniteState();
	assertValid( *this );
}

bool Body::adaptLevels( float h )
{
	const bool hasChange = reviewLevels( h );
	if ( hasChange )
	{
		applyLevels();
	}
	return hasChange;
}

void Body::changeLevels( const std::vector<std::uint32_t>& split, const std::vector<std::uint32_t>& merge )
{
	m_levels->change( m_nodes, *m_levelMatcher, m_material, split, merge );
	keepFiniteState();
	assertValid( *this );
}

void Body::requestSplit( int node )
{
	if ( m_levels )
	{
		m_levels->requestSplit( node );
	}
}

void Body::keepNode( int node )
{
	if ( m_levels )
	{
		m_levels->keep( node );
	}
}

void Body::refineAround( int node, double mass )
{
	if ( !m_levels )
	{
		return;
	}
	const auto refine = [this]( int near ) {
		const bool isCoarse = m_levels->levelOf( near ) > 0;
		isCoarse ? m_levels->requestFinest( near ) : m_levels->keep( near );
		m_reviewIn = isCoarse ? 0 : m_reviewIn;
	};
	if ( mass >= m_motion.mass )
	{
		for ( int i = 0; i < m_nodes.count; ++i )
		{
			refine( i );
		}
		return;
	}
	const Vec3 middle = m_nodes.x.get( node );
	std::vector<std::pair<float, int>> byDistance; // squared
	for ( int i = 0; i < m_nodes.count; ++i )
	{
		byDistance.emplace_back( ( m_nodes.x.get( i ) - middle ).squaredNorm(), i );
	}
	std::sort( byDistance.begin(), byDistance.end() );
	double sum = 0.0;
	for ( std::size_t k = 0; k < byDistance.size() && sum < mass; ++k )
	{
		sum += double( m_nodes.mass[byDistance[k].second] );
		refine( byDistance[k].second );
	}
}

void Body::setFinestLevel( int level )
{
	if ( m_levels )
	{
		m_levels->setFinestLevel( level );
	}
}

void Body::nodeDeformations( float* gradients ) const
{
	// The matcher's view has one form, for reading and writing.
	m_levelMatcher->deformations( const_cast<NodeState&>( m_nodes ), gradients );
}

void Body::nodeDeformationsOf( const std::vector<std::uint32_t>& nodes, float* gradients ) const
{
	m_levelMatcher->deformationsOf( const_cast<NodeState&>( m_nodes ), nodes, gradients );
}

Eigen::Quaternionf Body::levelFrame() const
{
	return m_levelMatcher->frame().cast<float>();
}

} // namespace pliant
