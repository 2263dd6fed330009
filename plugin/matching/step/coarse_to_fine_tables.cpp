// Precomputation of the far levels: blocks, their regions, and the regions' weights.

#include "matching/step/coarse_to_fine.h"

#include "lattice/table.h"
#include "matching/constants.h"
#include "matching/regions/region_moments.h"

#include <algorithm>
#include <utility>

namespace pliant {

namespace {

/// Linked pairs, in both directions, ascending, without duplicates.
using Links = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

void makeUnique( Links& links )
{
	std::sort( links.begin(), links.end() );
	links.erase( std::unique( links.begin(), links.end() ), links.end() );
}

Links cellLinks( const Lattice& lattice )
{
	Links links;
	links.reserve( lattice.linkTo.size() );
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			links.emplace_back( i, lattice.linkTo[k] );
		}
	}
	return links;
}

/// The links between the parents of linked nodes, and from each parent to itself.
Links parentLinks( const Links& links, const std::vector<std::uint32_t>& parent, int parents )
{
	Links above;
	above.reserve( links.size() + std::size_t( parents ) );
	for ( int i = 0; i < parents; ++i )
	{
		above.emplace_back( std::uint32_t( i ), std::uint32_t( i ) );
	}
	for ( const auto& link : links )
	{
		above.emplace_back( parent[link.first], parent[link.second] );
	}
	makeUnique( above );
	return above;
}

} // namespace

int usefulFarLevels( const Lattice& lattice, int wanted )
{
	Eigen::Matrix<std::int16_t, 3, 1> low = lattice.coordinate[0], high = low; // the extent may be much larger than a piece that came off
	for ( const auto& c : lattice.coordinate )
	{
		low = low.cwiseMin( c );
		high = high.cwiseMax( c );
	}
	const int longest = ( high - low ).maxCoeff() + 1;
	int levels = 0;
	while ( levels < std::min( wanted, kMostFarLevels ) && longest >= kLeastBlocks << ( levels + 1 ) )
	{
		++levels;
	}
	return levels;
}

void CoarseToFine::collectCells( int level, std::uint32_t block, const std::function<void( std::uint32_t )>& visit ) const
{
	for ( std::uint32_t k = m_levels[level].childStart[block]; k < m_levels[level].childStart[block + 1]; ++k )
	{
		if ( level == 0 )
		{
			visit( m_levels[0].child[k] );
		}
		else
		{
			collectCells( level - 1, m_levels[level].child[k], visit );
		}
	}
}

double CoarseToFine::pinnedEta( int number, int r, const FarRegion& region, const FarMoments& plain ) const
{
	const Level& level = m_levels[number - 1];
	RegionCells cells;
	for ( std::uint32_t k = level.regionStart[r]; k < level.regionStart[r + 1]; ++k )
	{
		const std::uint32_t b = level.region[k];
		collectCells( number - 1, b, [&]( std::uint32_t c ) {
			cells.position.push_back( m_lattice.restCentre[c].cast<double>() / double( m_lattice.cellSize ) );
			cells.weight.push_back( double( m_lattice.fill[c] ) * ( m_freedom[c] == 0.0f ? kPinnedWeight : 1.0f ) * level.inverseCover[b] );
		} );
	}
	return etaOfPinned( cells, region, plain, farSecondMoment( number ) );
}

CoarseToFine::CoarseToFine( const Lattice& lattice, int levels, const RegionTables& tables, const std::vector<float>& stiffness ) :
	m_lattice( lattice ), m_stiffness( stiffness ), m_slot( tables.slot ), m_nodeWeight( tables.moments.nodeWeight )
{
	const Octree octree = buildOctree( lattice, levels );
	m_levels.resize( octree.levels - 1 );
	Links links = cellLinks( lattice );
	for ( int l = 0; l < this->levels(); ++l )
	{
		const std::uint32_t below = octree.levelStart[l], first = octree.levelStart[l + 1], last = octree.levelStart[l + 2];
		std::vector<std::uint32_t> parent( octree.parent.begin() + below, octree.parent.begin() + first );
		for ( std::uint32_t& p : parent )
		{
			p -= first;
		}
		links = parentLinks( links, parent, int( last - first ) );
		buildLevel( m_levels[l], parent, int( last - first ), links );
		( l == 0 ? m_block : m_levels[l - 1].parent ) = std::move( parent );
	}
	m_nodePull.assign( m_nodeWeight.size(), 0.0f );
	m_perRecord.assign( std::max( m_nodeWeight.size(), std::size_t( tables.usesGrid ? tables.grid.prod() : 0 ) ), 0.0f );
	if ( !m_slot.empty() && !m_levels.empty() ) // on a grid with holes, records are at grid positions
	{
		for ( const std::uint32_t cell : m_levels[0].child )
		{
			m_record.push_back( m_slot[cell] );
		}
	}
	const AlignedArray<float> free( m_nodeWeight.size(), 1.0f );
	weighCells( free.data() );
	reset();
}

void CoarseToFine::buildLevel( Level& level, const std::vector<std::uint32_t>& parentOfChild, int count,
	const std::vector<std::pair<std::uint32_t, std::uint32_t>>& links )
{
	level.count = count;
	level.padded = ( count + kLanes - 1 ) / kLanes * kLanes;
	const auto forChildren = [&parentOfChild]( auto&& visit ) {
		for ( std::uint32_t c = 0; c < std::uint32_t( parentOfChild.size() ); ++c )
		{
			visit( parentOfChild[c], c );
		}
	};
	const auto forLinks = [&links]( auto&& visit ) {
		for ( const auto& [block, member] : links )
		{
			visit( block, member );
		}
	};
	sortIntoRows( std::size_t( count ), forChildren, level.childStart, level.child );
	sortIntoRows( std::size_t( count ), forLinks, level.regionStart, level.region );
	level.inverseCover.assign( level.padded, 0.0f );
	for ( int i = 0; i < count; ++i )
	{
		level.inverseCover[i] = 1.0f / float( level.regionStart[i + 1] - level.regionStart[i] );
	}
	for ( AlignedArray<float>* array : { &level.inverseMass, &level.weight, &level.eta, &level.pull } )
	{
		array->assign( level.padded, 0.0f );
	}
	for ( auto& array : level.centre )
	{
		array.assign( level.padded, 0.0f );
	}
	for ( int k = 0; k < 6; ++k )
	{
		level.moment[k].assign( level.padded, k < 3 ? 1.0f : 0.0f );
		level.inverseMoment[k].assign( level.padded, 0.0f );
	}
	for ( auto& array : level.quaternion )
	{
		array.assign( level.padded, 0.0f );
	}
	for ( AlignedArray<float>* array : { &level.sums, &level.blockRecord, &level.regionRecord, &level.goal } )
	{
		array->assign( std::size_t( level.padded ) * kRecordFloats, 0.0f );
	}
	level.open.resize( level.padded );
	level.openCount.assign( ( level.padded + kLanes - 1 ) / kLanes, 0 );
}

void CoarseToFine::weighCells( const float* freedom )
{
	const int cells = m_lattice.cellCount();
	m_freedom.assign( freedom, freedom + m_nodeWeight.size() );
	BlockMoments moments;
	moments.plain.resize( cells );
	moments.weighted.resize( cells );
	moments.stiffness.assign( m_stiffness.begin(), m_stiffness.end() );
	for ( int i = 0; i < cells; ++i )
	{
		const Vec3d q = m_lattice.restCentre[i].cast<double>() / double( m_lattice.cellSize );
		const float factor = freedom[i] == 0.0f ? kPinnedWeight : 1.0f;
		const double m = m_lattice.fill[i];
		moments.plain[i] = FarMoments{ m, m * q, m * q * q.transpose() };
		moments.weighted[i].add( moments.plain[i], factor );
		m_perRecord[m_slot.empty() ? std::size_t( i ) : m_slot[i]] = factor * m_lattice.fill[i] / m_nodeWeight[i];
	}
	for ( int l = 0; l < levels(); ++l )
	{
		moments = momentsAbove( moments, m_levels[l] );
		weighRegions( l + 1, moments );
	}
}

CoarseToFine::BlockMoments CoarseToFine::momentsAbove( const BlockMoments& below, const Level& level )
{
	BlockMoments above;
	above.plain.resize( level.count );
	above.weighted.resize( level.count );
	above.stiffness.assign( below.stiffness.empty() ? 0 : level.count, 0.0 );
	for ( int b = 0; b < level.count; ++b )
	{
		for ( std::uint32_t k = level.childStart[b]; k < level.childStart[b + 1]; ++k )
		{
			const std::uint32_t c = level.child[k];
			above.plain[b].add( below.plain[c], 1.0 );
			above.weighted[b].add( below.weighted[c], 1.0 );
			if ( !below.stiffness.empty() )
			{
				above.stiffness[b] += below.stiffness[c] * below.plain[c].mass;
			}
		}
		if ( !below.stiffness.empty() )
		{
			above.stiffness[b] /= above.plain[b].mass;
		}
	}
	return above;
}

void CoarseToFine::weighRegions( int number, const BlockMoments& blocks )
{
	Level& level = m_levels[number - 1];
	for ( auto& array : level.outOfPlane )
	{
		array.clear();
	}
	for ( int r = 0; r < level.count; ++r )
	{
		FarMoments plain, weighted;
		for ( std::uint32_t k = level.regionStart[r]; k < level.regionStart[r + 1]; ++k )
		{
			const std::uint32_t b = level.region[k];
			plain.add( blocks.plain[b], level.inverseCover[b] );
			weighted.add( blocks.weighted[b], level.inverseCover[b] );
		}
		FarRegion region = weighFarRegion( weighted, plain, number );
		if ( weighted.mass > plain.mass )
		{
			region.eta = pinnedEta( number, r, region, plain );
		}
		region.pull *= blocks.stiffness.empty() ? 1.0 : blocks.stiffness[r];
		storeRegion( level, r, region );
	}
	for ( int b = 0; b < level.count; ++b )
	{
		double sum = 0.0;
		for ( std::uint32_t k = level.regionStart[b]; k < level.regionStart[b + 1]; ++k )
		{
			const std::uint32_t r = level.region[k];
			sum += double( level.weight[r] ) * ( 1.0 - level.eta[r] );
		}
		level.pull[b] = float( sum * level.inverseCover[b] );
	}
}

void CoarseToFine::storeRegion( Level& level, int r, const FarRegion& region )
{
	level.inverseMass[r] = float( 1.0 / region.mass );
	for ( int k = 0; k < 3; ++k )
	{
		level.centre[k][r] = float( region.centre[k] );
	}
	level.weight[r] = float( region.pull );
	level.eta[r] = float( region.eta );
	storeSymmetric( level.moment, r, region.moment );
	Eigen::Matrix3d outside;
	storeSymmetric( level.inverseMoment, r, inverseInPlane( region.moment, kMomentFloor, outside ) );
	if ( !outside.isZero( 0.0 ) )
	{
		for ( int k = 0; k < 6 && level.outOfPlane[k].empty(); ++k )
		{
			level.outOfPlane[k].assign( level.padded, 0.0f );
		}
		storeSymmetric( level.outOfPlane, r, outside );
	}
}

void CoarseToFine::weighPulls( const FarFractions& fractions )
{
	m_fractions = fractions;
	for ( std::size_t i = 0; i < m_block.size(); ++i )
	{
		double pull = 0.0;
		std::uint32_t block = m_block[i];
		for ( int l = 0; l < levels(); ++l )
		{
			pull += double( fractions[l] ) * m_levels[l].pull[block];
			block = l + 1 < levels() ? m_levels[l].parent[block] : 0;
		}
		m_nodePull[i] = float( pull );
	}
}

} // namespace pliant
