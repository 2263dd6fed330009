#include "matching/regions/region_tables.h"

#include "matching/constants.h"
#include "matching/regions/link_moments.h"

namespace pliant {

bool needsInverse( const Material& material )
{
	return material.beta > 0.0f || material.volumeKeeping > 0.0f || material.yieldStrain > 0.0f ||
		material.rotationFrom == RotationFrom::F || usesLinkMoments( material );
}

namespace {

/// Multiplies each region's weight by its stiffness; the pull of node i is then the sum of b_r / C_i.
void applyStiffness( const std::vector<float>& stiffness, RegionTables& tables )
{
	RegionMoments& moments = tables.moments;
	if ( moments.regionWeight.empty() )
	{
		moments.regionWeight.assign( moments.padded, 1.0f );
	}
	for ( int r = 0; r < moments.count; ++r )
	{
		moments.regionWeight[r] *= stiffness[std::size_t( r )];
	}
	tables.pull.assign( moments.padded, 0.0f );
	for ( int i = 0; i < moments.count; ++i )
	{
		double sum = 0.0;
		for ( std::uint32_t k = tables.regions.start[i]; k < tables.regions.start[i + 1]; ++k )
		{
			sum += moments.regionWeight[tables.regions.member[k]];
		}
		tables.pull[i] = float( sum * moments.inverseCover[i] );
	}
}

} // namespace

std::shared_ptr<const RegionTables> buildRegionTables( const Lattice& lattice, const Material& material, Summation summation,
	const std::vector<float>& stiffness, const MomentsBefore* before )
{
	auto tables = std::make_shared<RegionTables>();
	tables->regions = buildRegions( lattice, material.regionHalfWidth );
	tables->moments = computeRegionMoments( lattice, tables->regions, material.weights, needsInverse( material ), before );
	if ( needsInverse( material ) )
	{
		markFlatRegions( tables->moments, tables->outOfPlane );
	}
	tables->grid = lattice.extent;
	if ( !stiffness.empty() )
	{
		applyStiffness( stiffness, *tables );
	}
	if ( usesLinkMoments( material ) )
	{
		applyLinkMoments( lattice, material, *tables );
	}

	const int nodes = lattice.cellCount();
	const double positions = double( lattice.extent.x() ) * lattice.extent.y() * lattice.extent.z();
	const bool isFaster = positions / nodes <= kLargestGridRatio[material.regionHalfWidth];
	tables->usesGrid = tables->regions.isFullCubes &&
		( summation == Summation::BoxSums || ( summation == Summation::Automatic && isFaster ) );
	tables->usesLinks = !tables->usesGrid && material.regionHalfWidth == 1;
	if ( tables->usesGrid || tables->usesLinks )
	{
		std::vector<std::uint32_t>().swap( tables->regions.start ); // an assignment of {} would keep their memory
		std::vector<std::uint32_t>().swap( tables->regions.member );
	}
	if ( !tables->usesGrid )
	{
		return tables;
	}
	tables->gridHasHoles = positions != nodes;
	if ( tables->gridHasHoles )
	{
		tables->slot.reserve( nodes );
		for ( const auto& c : lattice.coordinate )
		{
			tables->slot.push_back( std::uint32_t( ( c.z() * lattice.extent.y() + c.y() ) * lattice.extent.x() + c.x() ) );
		}
	}
	return tables;
}

std::shared_ptr<const RegionTables> RegionCache::find( const Lattice& lattice, const Material& material )
{
	const std::lock_guard<std::mutex> lock( m_mutex );
	const float linkBeta = usesLinkMoments( material ) ? material.beta : -1.0f;
	for ( Entry& entry : m_entries )
	{
		if ( entry.halfWidth == material.regionHalfWidth && entry.weights == material.weights &&
			entry.withInverse == needsInverse( material ) && entry.linkBeta == linkBeta )
		{
			std::shared_ptr<const RegionTables> tables = entry.tables.lock();
			if ( !tables )
			{
				tables = buildRegionTables( lattice, material, Summation::Automatic );
				entry.tables = tables;
			}
			return tables;
		}
	}
	std::shared_ptr<const RegionTables> tables = buildRegionTables( lattice, material, Summation::Automatic );
	m_entries.push_back( Entry{ material.regionHalfWidth, material.weights, needsInverse( material ), linkBeta, tables } );
	return tables;
}

} // namespace pliant
