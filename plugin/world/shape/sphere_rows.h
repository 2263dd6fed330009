#pragma once

// The spheres of a soft body's nodes for a substep's searches: rows of eight neighbouring spheres, boxes around rows, eight side by side,
// boxes around those, and so on. There are no pointers and eight are tested at once: a body of some hundred nodes takes 5 kB, which stay in
// the cache. Bullet's tree over the same spheres takes 40 kB and serves Bullet's own queries (node_shape.h).

#include "lattice/lattice.h"
#include "matching/node_state.h"

#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>

#include <array>
#include <cstdint>
#include <vector>

namespace pliant {

class TaskRunner;

class SphereRows
{
public:
	static constexpr int kWide = 8;

	struct Box
	{
		float low[3], high[3];

		static Box of( const btVector3& low, const btVector3& high )
		{
			return Box{
				{ float( low.x() ), float( low.y() ), float( low.z() ) }, { float( high.x() ), float( high.y() ), float( high.z() ) } };
		}
		btVector3 mins() const { return btVector3( low[0], low[1], low[2] ); }
		btVector3 maxs() const { return btVector3( high[0], high[1], high[2] ); }
		Box moved( const Box& by ) const
		{
			return Box{ { low[0] + by.low[0], low[1] + by.low[1], low[2] + by.low[2] },
				{ high[0] + by.high[0], high[1] + by.high[1], high[2] + by.high[2] } };
		}
	};
	/// Shift from one body's coordinates to the other's, and the range of displacement of the one relative to the other in this step, m.
	/// `low` has no positive and `high` no negative component.
	struct Approach
	{
		btVector3 shift, low, high;
	};

	/// Two spheres that may touch by the sweeps of both bodies; the caller tests the nodes' own velocities.
	struct NearSpheres
	{
		int nodeA, nodeB;
		float squaredDistance, reach; ///< squared distance of the centres, m^2; sum of the reaches, m
	};

	/// Takes the spheres of a tree's leaves in order; leaves hold indices of children. Positions are set by place().
	void arrange( const btDbvtNode* root, const std::vector<int>& nodeOfChild, const std::vector<btSphereShape*>& sphereOfNode );
	/// Moves spheres and boxes to the nodes. `shift`: the rows' own origin in the nodes' coordinates. `runner` may be null.
	void place( const NodeState& nodes, const Vec3& shift, TaskRunner* runner );
	/// The box around all spheres.
	const Box& whole() const { return m_whole; }
	int count() const { return m_count; }

	/// Calls visit( node ) for every sphere whose box overlaps the box.
	template <class Visit>
	void visitOverlaps( const Box& box, Visit&& visit ) const
	{
		visitRows( box, [&]( int at ) {
			const Row& row = m_rows[std::size_t( at )];
			forEach( overlapping( row, box ), [&]( int k ) { visit( row.node[k] ); } );
		} );
	}
	/// Result and scratch of a search for pairs; owned by the caller.
	struct Pairs
	{
		/// Selected lanes of rows, each with the index of its source: all eight are written and the count advances by the selected ones. A
		/// loop over the selected lanes would be mispredicted almost every time.
		struct LaneList
		{
			std::vector<std::uint8_t> lane;
			std::vector<std::uint32_t> from;
			std::size_t count = 0;

			void add( std::uint32_t source, unsigned lanes );
		};

		std::vector<NearSpheres> found; ///< all pairs of spheres that may touch, and some that nearly do
		std::vector<int> rows;
		std::vector<std::array<int, 2>> rowPairs;
		LaneList candidates, near;
	};
	/// Fills `pairs.found` in an order that follows from the rows: from rows whose boxes overlap to spheres within reach of each other.
	static void findPairs( const SphereRows& a, const SphereRows& b, const Approach& approach, Pairs& pairs );
	/// Calls visit( node, position ) for the spheres from `first` to `last` - 1.
	template <class Visit>
	void visitPositions( int first, int last, Visit&& visit ) const
	{
		for ( int i = first; i < last; ++i )
		{
			const Row& row = m_rows[std::size_t( i / kWide )];
			const int k = i % kWide;
			visit( row.node[k], btVector3( row.x[0][k], row.x[1][k], row.x[2][k] ) );
		}
	}

private:
	/// `reach`: half width of a sphere's box. Unused slots have boxes that overlap nothing.
	struct alignas( 32 ) Row
	{
		float x[3][kWide], reach[kWide];
		int node[kWide];
	};
	struct alignas( 32 ) Boxes
	{
		float low[3][kWide], high[3][kWide];

		Box at( int k ) const { return Box{ { low[0][k], low[1][k], low[2][k] }, { high[0][k], high[1][k], high[2][k] } }; }
		void set( int k, const Box& box );
		Box around() const;
	};
	/// Half a row of values, and of comparison results (-1 where true).
	using F4 = float __attribute__( ( vector_size( 16 ), may_alias ) );
	using I4 = int __attribute__( ( vector_size( 16 ), may_alias ) );
	/// Bit k: true for the k-th lane.
	using Lanes = unsigned;

	static F4 load( const float* four ) { return *reinterpret_cast<const F4*>( four ); }
	static unsigned bitsOf( I4 is )
	{
#if defined( __SSE__ )
		return unsigned( __builtin_ia32_movmskps( (F4)is ) );
#else
		return unsigned( is[0] & 1 ) | unsigned( is[1] & 2 ) | unsigned( is[2] & 4 ) | unsigned( is[3] & 8 );
#endif
	}
	/// is( k ): results for the four lanes from the k-th on.
	template <class Is>
	static Lanes eachHalf( Is&& is )
	{
		static_assert( kWide == 8 );
		return bitsOf( is( 0 ) ) | bitsOf( is( 4 ) ) << 4;
	}

	static Boxes boxesOf( const Row& row )
	{
		Boxes boxes;
		for ( int axis = 0; axis < 3; ++axis )
		{
			for ( int k = 0; k < kWide; ++k )
			{
				boxes.low[axis][k] = row.x[axis][k] - row.reach[k];
				boxes.high[axis][k] = row.x[axis][k] + row.reach[k];
			}
		}
		return boxes;
	}
	static Lanes overlapping( const Boxes& boxes, const Box& box )
	{
		return eachHalf( [&]( int k ) {
			const I4 alongX = ( load( boxes.low[0] + k ) <= F4{} + box.high[0] ) & ( load( boxes.high[0] + k ) >= F4{} + box.low[0] );
			const I4 alongY = ( load( boxes.low[1] + k ) <= F4{} + box.high[1] ) & ( load( boxes.high[1] + k ) >= F4{} + box.low[1] );
			const I4 alongZ = ( load( boxes.low[2] + k ) <= F4{} + box.high[2] ) & ( load( boxes.high[2] + k ) >= F4{} + box.low[2] );
			return alongX & alongY & alongZ;
		} );
	}
	static Lanes overlapping( const Row& row, const Box& box )
	{
		return overlapping( boxesOf( row ), box );
	}
	/// Lanes whose centres are nearer to `x` than the sum of both reaches.
	static Lanes near( const Row& row, const float ( &x )[3], float reach )
	{
		return eachHalf( [&]( int k ) {
			const F4 dx = load( row.x[0] + k ) - x[0], dy = load( row.x[1] + k ) - x[1], dz = load( row.x[2] + k ) - x[2],
					 both = load( row.reach + k ) + reach;
			return ( dx * dx + dy * dy + dz * dz <= both * both ) & ( both >= F4{} );
		} );
	}
	template <class Visit>
	static void forEach( Lanes is, Visit&& visit )
	{
		for ( ; is != 0; is &= is - 1 )
		{
			visit( __builtin_ctz( is ) );
		}
	}
	/// Calls visit( row ) for every row whose box overlaps the box.
	template <class Visit>
	void visitRows( const Box& box, Visit&& visit ) const
	{
		if ( m_count > 0 )
		{
			descend( int( m_rank.size() ) - 1, 0, box, visit );
		}
	}
	template <class Visit>
	void descend( int rank, int at, const Box& box, Visit& visit ) const // NOLINT(misc-no-recursion): as deep as the logarithm of the count
	{
		forEach( overlapping( m_boxes[std::size_t( m_rank[std::size_t( rank )] + at )], box ), [&]( int k ) {
			if ( rank == 0 )
			{
				visit( at * kWide + k );
				return;
			}
			descend( rank - 1, at * kWide + k, box, visit );
		} );
	}
	Box boxOfRow( int row ) const
	{
		return m_boxes[std::size_t( row / kWide )].at( row % kWide );
	}
	void placeRows( int first, int last, const NodeState& nodes, const Vec3& shift );

	std::vector<Row> m_rows;
	std::vector<Boxes> m_boxes; // of the rows, then of those boxes, up to a single one
	std::vector<int> m_rank;    // first box of each rank
	Box m_whole{};
	int m_count = 0;
};

} // namespace pliant
