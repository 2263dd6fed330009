// Inputs of the step's tables: the octree and its finest regions, and the regions of a cut.

#include "matching/regions/level_tables.h"

#include <algorithm>

namespace pliant {

namespace {

bool usesEnergies( const Adaptivity& settings )
{
	return settings.softening == Softening::Energy || settings.softening == Softening::EnergyTensor ||
		settings.residual == ResidualRule::Quadratic || settings.residual == ResidualRule::Larger;
}

} // namespace

std::shared_ptr<const LevelBase> buildLevelBase( const Lattice& lattice, const Material& material, const Adaptivity& settings )
{
	auto base = std::make_shared<LevelBase>();
	base->octree = buildOctree( lattice, settings.coarseLevels );
	base->fine = buildFineRegions( lattice, material.regionHalfWidth );
	if ( usesEnergies( settings ) )
	{
		base->moments = buildFineMoments( base->octree, lattice, base->fine );
	}
	return base;
}

std::shared_ptr<const LevelBase> LevelCache::find( const Lattice& lattice, const Material& material, const Adaptivity& settings )
{
	const std::lock_guard<std::mutex> lock( m_mutex );
	const bool withMoments = usesEnergies( settings );
	const auto found = std::find_if( m_entries.begin(), m_entries.end(), [&]( const Entry& e ) {
		return e.coarseLevels == settings.coarseLevels && e.halfWidth == material.regionHalfWidth && e.withMoments == withMoments;
	} );
	if ( found != m_entries.end() )
	{
		if ( std::shared_ptr<const LevelBase> base = found->base.lock() )
		{
			return base;
		}
	}
	std::shared_ptr<const LevelBase> base = buildLevelBase( lattice, material, settings );
	if ( found != m_entries.end() )
	{
		found->base = base;
	}
	else
	{
		m_entries.push_back( Entry{ settings.coarseLevels, material.regionHalfWidth, withMoments, base } );
	}
	return base;
}

Cut firstCut( const Octree& octree, const Adaptivity& settings )
{
	const auto byMass = keepsByMass( octree, settings.keepMass );
	return selectCut(
		octree, [&]( std::uint32_t node ) { return !( settings.isSurfaceFine && octree.isSurface[node] != 0 ) && byMass( node ); } );
}

namespace {

/// Matrix and sum plan of Steinemann's regions, stored with their graph for the next change.
LevelRegions fromIntervals( const RegionInput& input, const Cut& cut, VisibilityGraph graph, IntervalRegions intervals )
{
	LevelRegions regions;
	const IntervalWeights weights = input.material.weights == Weights::Conserving ? IntervalWeights::Conserving : IntervalWeights::Literal;
	regions.matrix = std::make_shared<RegionMatrix>( buildIntervalRegions( input.base.octree, cut, intervals, weights ) );
	if ( input.settings.hierarchicalSums )
	{
		regions.plan = std::make_shared<const SumPlan>( planSums( input.base.octree, cut, intervals ) );
	}
	regions.graph = std::make_shared<const VisibilityGraph>( std::move( graph ) );
	regions.intervals = std::make_shared<const IntervalRegions>( std::move( intervals ) );
	return regions;
}

} // namespace

LevelRegions buildLevelRegions(
	const LevelBase& base, const Lattice& lattice, const Cut& cut, const Material& material, const Adaptivity& settings )
{
	if ( settings.regions == RegionRule::Interval )
	{
		VisibilityGraph graph = buildVisibilityGraph( lattice, base.octree, cut );
		IntervalRegions intervals = findIntervalRegions( IntervalInput{ base.octree, cut, graph },
			intervalWidths( base.octree, cut, float( material.regionHalfWidth ) ), settings.intervalSlack );
		return fromIntervals( RegionInput{ base, lattice, material, settings }, cut, std::move( graph ), std::move( intervals ) );
	}
	const UnionWeights weights = material.weights == Weights::Conserving ? UnionWeights::Conserving : UnionWeights::Literal;
	RegionMatrix matrix = settings.regions == RegionRule::Union ? buildUnionRegions( base.octree, cut, base.fine, weights )
																: buildMultiplicityRegions( base.octree, cut, base.fine );
	return LevelRegions{ std::make_shared<RegionMatrix>( std::move( matrix ) ), nullptr };
}

LevelRegions updateLevelRegions( const RegionInput& input, const Cut& from, const LevelRegions& regions, const Cut& to )
{
	const Octree& octree = input.base.octree;
	switch ( input.settings.regions )
	{
		case RegionRule::Multiplicity:
			return LevelRegions{ std::make_shared<RegionMatrix>(
									 updateMultiplicityRegions( octree, from, *regions.matrix, to, input.base.fine, input.scratch ) ),
				nullptr };
		case RegionRule::Interval: {
			VisibilityUpdate sight = updateVisibilityGraph( input.lattice, octree, from, *regions.graph, to );
			const IntervalInput before{ octree, from, *regions.graph }, after{ octree, to, sight.graph };
			IntervalUpdate update = updateIntervalRegions( before, after, sight.change, *regions.intervals,
				intervalWidths( octree, to, float( input.material.regionHalfWidth ) ), input.tasks );
			return fromIntervals( input, to, std::move( sight.graph ), std::move( update.regions ) );
		}
		default: return buildLevelRegions( input.base, input.lattice, to, input.material, input.settings );
	}
}

} // namespace pliant
