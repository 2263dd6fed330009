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

LevelRegions buildLevelRegions( const RegionInput& input, const Cut& cut )
{
	const Octree& octree = input.base.octree;
	const bool conserves = input.material.weights == Weights::Conserving;
	LevelRegions regions;
	switch ( input.settings.regions )
	{
		case RegionRule::Multiplicity:
			regions.matrix = std::make_shared<RegionMatrix>( buildMultiplicityRegions( octree, cut, input.base.fine ) );
			break;
		case RegionRule::Union:
			regions.matrix = std::make_shared<RegionMatrix>(
				buildUnionRegions( octree, cut, input.base.fine, conserves ? UnionWeights::Conserving : UnionWeights::Literal ) );
			break;
		case RegionRule::Interval: {
			const VisibilityGraph graph = buildVisibilityGraph( input.lattice, octree, cut );
			const IntervalRegions intervals = findIntervalRegions( IntervalInput{ octree, cut, graph },
				intervalWidths( octree, cut, float( input.material.regionHalfWidth ) ), input.settings.intervalSlack, input.tasks );
			regions.matrix = std::make_shared<RegionMatrix>(
				buildIntervalRegions( octree, cut, intervals, conserves ? IntervalWeights::Conserving : IntervalWeights::Literal ) );
			if ( input.settings.hierarchicalSums )
			{
				regions.plan = std::make_shared<const SumPlan>( planSums( octree, cut, intervals ) );
			}
			break;
		}
	}
	return regions;
}

LevelRegions updateLevelRegions( const RegionInput& input, const Cut& from, const LevelRegions& regions, const Cut& to )
{
	if ( input.settings.regions != RegionRule::Multiplicity )
	{
		return buildLevelRegions( input, to );
	}
	return LevelRegions{ std::make_shared<RegionMatrix>(
							 updateMultiplicityRegions( input.base.octree, from, *regions.matrix, to, input.base.fine, input.scratch ) ),
		nullptr };
}

} // namespace pliant
