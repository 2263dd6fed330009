#include "world/shape/sphere_rows.h"

#include "threads/parallel.h"
#include "world/constants.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace pliant {

namespace {

/// A box that overlaps nothing, however large a box that is searched may be, and adds nothing to a union.
constexpr float kFarAway = std::numeric_limits<float>::max();
constexpr SphereRows::Box kEmpty{ { kFarAway, kFarAway, kFarAway }, { -kFarAway, -kFarAway, -kFarAway } };

std::size_t groupsOfEight( std::size_t count )
{
	return ( count + SphereRows::kWide - 1 ) / SphereRows::kWide;
}

/// For every set of eight lanes: its lanes in order, and their number; entries beyond it are unspecified.
struct SetLanes
{
	static constexpr int kSets = 1 << SphereRows::kWide;

	std::uint8_t lane[kSets][SphereRows::kWide] = {};
	std::uint8_t count[kSets] = {};

	constexpr SetLanes()
	{
		for ( int set = 0; set < kSets; ++set )
		{
			for ( int k = 0; k < SphereRows::kWide; ++k )
			{
				if ( ( set >> k & 1 ) != 0 )
				{
					lane[set][count[set]++] = std::uint8_t( k );
				}
			}
		}
	}
};
constexpr SetLanes kSetLanes;

} // namespace

void SphereRows::Pairs::LaneList::add( std::uint32_t source, unsigned lanes )
{
	if ( count + kWide > lane.size() )
	{
		lane.resize( 2 * lane.size() + kWide );
		from.resize( lane.size() );
	}
	std::memcpy( lane.data() + count, kSetLanes.lane[lanes], kWide );
	std::fill_n( from.data() + count, kWide, source );
	count += kSetLanes.count[lanes];
}

void SphereRows::Boxes::set( int k, const Box& box )
{
	for ( int axis = 0; axis < 3; ++axis )
	{
		low[axis][k] = box.low[axis];
		high[axis][k] = box.high[axis];
	}
}

SphereRows::Box SphereRows::Boxes::around() const
{
	Box box;
	for ( int axis = 0; axis < 3; ++axis )
	{
		box.low[axis] = Eigen::Map<const Eigen::Array<float, kWide, 1>>( low[axis] ).minCoeff();
		box.high[axis] = Eigen::Map<const Eigen::Array<float, kWide, 1>>( high[axis] ).maxCoeff();
	}
	return box;
}

void SphereRows::arrange( const btDbvtNode* root, const std::vector<int>& nodeOfChild, const std::vector<btSphereShape*>& sphereOfNode )
{
	m_rows.clear();
	m_rows.reserve( groupsOfEight( nodeOfChild.size() ) );
	m_count = 0;
	Row none{};
	std::fill( std::begin( none.reach ), std::end( none.reach ), -kFarAway );
	std::vector<const btDbvtNode*> waiting( root ? 1 : 0, root );
	while ( !waiting.empty() )
	{
		const btDbvtNode* const at = waiting.back();
		waiting.pop_back();
		if ( at->isinternal() )
		{
			waiting.push_back( at->childs[1] );
			waiting.push_back( at->childs[0] );
			continue;
		}
		const int k = m_count++ % kWide;
		if ( k == 0 )
		{
			m_rows.push_back( none );
		}
		const int node = nodeOfChild[std::size_t( at->dataAsInt )];
		m_rows.back().node[k] = node;
		m_rows.back().reach[k] = float( sphereOfNode[std::size_t( node )]->getRadius() * ( 1 + kContactSlop ) );
	}
	m_rank.clear();
	std::size_t boxes = 0;
	for ( std::size_t wide = m_rows.size(); wide > 1 || m_rank.empty(); )
	{
		m_rank.push_back( int( boxes ) );
		wide = groupsOfEight( wide );
		boxes += wide;
	}
	Boxes empty;
	for ( int k = 0; k < kWide; ++k )
	{
		empty.set( k, kEmpty );
	}
	m_boxes.assign( boxes, empty );
}

void SphereRows::placeRows( int first, int last, const NodeState& nodes, const Vec3& shift )
{
	for ( int r = first; r < last; ++r )
	{
		Row& row = m_rows[std::size_t( r )];
		for ( int k = 0; k < kWide; ++k )
		{
			const int node = row.node[k]; // any node in an unused slot
			row.x[0][k] = nodes.x.x[node] - shift.x();
			row.x[1][k] = nodes.x.y[node] - shift.y();
			row.x[2][k] = nodes.x.z[node] - shift.z();
		}
		m_boxes[std::size_t( r / kWide )].set( r % kWide, boxesOf( row ).around() );
	}
}

void SphereRows::place( const NodeState& nodes, const Vec3& shift, TaskRunner* runner )
{
	// Ranges are whole rows: multiples of 16 spheres.
	runChunks( runner, ChunkedRange{ int( m_rows.size() ) * kWide },
		[&]( int, int begin, int end ) { placeRows( begin / kWide, end / kWide, nodes, shift ); } );
	for ( std::size_t rank = 1; rank < m_rank.size(); ++rank )
	{
		const int from = m_rank[rank - 1], to = m_rank[rank];
		for ( int i = from; i < to; ++i )
		{
			m_boxes[std::size_t( to + ( i - from ) / kWide )].set( ( i - from ) % kWide, m_boxes[std::size_t( i )].around() );
		}
	}
	m_whole = m_boxes.back().around();
}

void SphereRows::findPairs( const SphereRows& a, const SphereRows& b, const Approach& approach, Pairs& pairs )
{
	// Offsets of a box from a's coordinates to b's, and back.
	const Box there = Box::of( approach.shift + approach.low, approach.shift + approach.high );
	const Box back = Box::of( -approach.shift - approach.high, -approach.shift - approach.low );
	btVector3 farthest = -approach.low;
	farthest.setMax( approach.high );
	const float sweepLength = float( farthest.length() );
	const float shift[3] = { float( approach.shift.x() ), float( approach.shift.y() ), float( approach.shift.z() ) };
	pairs.rows.clear();
	pairs.rowPairs.clear();
	pairs.candidates.count = pairs.near.count = 0;
	a.visitRows( b.m_whole.moved( back ), [&pairs]( int row ) { pairs.rows.push_back( row ); } );
	for ( const int rowA : pairs.rows )
	{
		b.visitRows( a.boxOfRow( rowA ).moved( there ), [&pairs, rowA]( int rowB ) { pairs.rowPairs.push_back( { rowA, rowB } ); } );
	}
	for ( std::size_t p = 0; p < pairs.rowPairs.size(); ++p )
	{
		const auto [rowA, rowB] = pairs.rowPairs[p];
		pairs.candidates.add( std::uint32_t( p ), overlapping( a.m_rows[std::size_t( rowA )], b.boxOfRow( rowB ).moved( back ) ) );
	}
	for ( std::size_t i = 0; i < pairs.candidates.count; ++i )
	{
		const auto [rowA, rowB] = pairs.rowPairs[pairs.candidates.from[i]];
		const Row& row = a.m_rows[std::size_t( rowA )];
		const std::size_t k = pairs.candidates.lane[i];
		const float x[3] = { row.x[0][k] + shift[0], row.x[1][k] + shift[1], row.x[2][k] + shift[2] };
		pairs.near.add( std::uint32_t( i ), near( b.m_rows[std::size_t( rowB )], x, row.reach[k] + sweepLength ) );
	}
	pairs.found.resize( pairs.near.count );
	for ( std::size_t c = 0; c < pairs.near.count; ++c )
	{
		const std::size_t i = pairs.near.from[c], k = pairs.candidates.lane[i], l = pairs.near.lane[c];
		const auto [rowA, rowB] = pairs.rowPairs[pairs.candidates.from[i]];
		const Row &row = a.m_rows[std::size_t( rowA )], &other = b.m_rows[std::size_t( rowB )];
		const float dx = other.x[0][l] - ( row.x[0][k] + shift[0] ), dy = other.x[1][l] - ( row.x[1][k] + shift[1] ),
					dz = other.x[2][l] - ( row.x[2][k] + shift[2] );
		pairs.found[c] = NearSpheres{ row.node[k], other.node[l], dx * dx + dy * dy + dz * dz, row.reach[k] + other.reach[l] };
	}
}

} // namespace pliant
