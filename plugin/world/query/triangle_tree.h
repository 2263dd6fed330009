#pragma once

// A tree of boxes over the triangles of a surface whose vertices move: sorted once for each topology, refitted for queries.

#include "lattice/lattice.h"

#include <cstdint>
#include <vector>

namespace pliant {

/// A surface as arrays: three floats a vertex, m, and three indices a triangle.
struct TriangleView
{
	const float* positions = nullptr;
	const std::uint32_t* indices = nullptr;
	int triangles = 0;

	Vec3d corner( int triangle, int k ) const
	{
		const float* const at = positions + 3 * std::size_t( indices[3 * std::size_t( triangle ) + std::size_t( k )] );
		return Vec3d( double( at[0] ), double( at[1] ), double( at[2] ) );
	}
};

/// A point that moves from `from` by `along`, with a box of half widths `around`.
struct BoxPath
{
	Vec3d from, along, around;
};

class TriangleTree
{
public:
	/// Sorts the triangles by their positions in the surface at rest: the order of two that are met at the same time must not depend on the
	/// time of the first query. Call `refit` then.
	void sort( const TriangleView& atRest );
	/// Updates the boxes for moved vertices of the same triangles.
	void refit( const TriangleView& surface );

	/// Calls visit( triangle ) for those whose box may overlap a box.
	template <class Visit>
	void visitOverlaps( const Vec3& low, const Vec3& high, Visit&& visit ) const
	{
		for ( std::size_t at = 0; at < m_boxes.size(); )
		{
			const Box& box = m_boxes[at];
			const bool overlaps = ( box.low.array() <= high.array() ).all() && ( box.high.array() >= low.array() ).all();
			for ( int k = 0; overlaps && k < box.count; ++k )
			{
				visit( int( m_order[std::size_t( box.first + k )] ) );
			}
			at = overlaps ? at + 1 : std::size_t( box.after );
		}
	}

	/// Calls visit( triangle ) for those that a box on its path may meet at a fraction below `limit`, which the visitor may lower; roughly
	/// in the order in which they are met.
	template <class Visit>
	void visitPath( const BoxPath& path, const double& limit, Visit&& visit ) const
	{
		struct Waiting
		{
			int box;
			double entry;
		};
		Waiting stack[kDepth];
		int waiting = 0;
		const Slabs slabs( path );
		const double first = m_boxes.empty() ? kNever : slabs.entry( m_boxes.front(), limit );
		if ( first < kNever )
		{
			stack[waiting++] = Waiting{ 0, first };
		}
		while ( waiting > 0 )
		{
			const Waiting next = stack[--waiting];
			if ( next.entry > limit )
			{
				continue;
			}
			const Box& box = m_boxes[std::size_t( next.box )];
			for ( int k = 0; k < box.count; ++k )
			{
				visit( int( m_order[std::size_t( box.first + k )] ) );
			}
			if ( box.count > 0 )
			{
				continue;
			}
			const int low = next.box + 1, high = m_boxes[std::size_t( low )].after;
			const Waiting lower{ low, slabs.entry( m_boxes[std::size_t( low )], limit ) },
				upper{ high, slabs.entry( m_boxes[std::size_t( high )], limit ) };
			const bool isLowerFirst = lower.entry <= upper.entry;
			for ( const Waiting& child : { isLowerFirst ? upper : lower, isLowerFirst ? lower : upper } )
			{
				if ( child.entry < kNever )
				{
					stack[waiting++] = child;
				}
			}
		}
	}

private:
	static constexpr int kLeaf = 4;   // triangles of a leaf
	static constexpr int kDepth = 64; // of halves of at most 2^31 triangles, two boxes waiting at each
	static constexpr double kNever = 1e300;

	/// Boxes are in depth-first order: the lower child follows its parent, the upper one the lower child's whole branch.
	struct Box
	{
		Vec3 low, high;
		int first = 0, count = 0; // triangles of a leaf; none of an inner box
		int after = 0;            // the first box behind this one's branch
	};

	/// When a path enters a box.
	class Slabs
	{
	public:
		explicit Slabs( const BoxPath& path ) :
			m_path( path ), m_inverse( path.along.unaryExpr( []( double v ) { return v == 0.0 ? 0.0 : 1.0 / v; } ) )
		{}
		double entry( const Box& box, double limit ) const
		{
			double in = 0.0, out = limit;
			for ( int axis = 0; axis < 3; ++axis )
			{
				const double low = double( box.low[axis] ) - m_path.around[axis] - m_path.from[axis],
							 high = double( box.high[axis] ) + m_path.around[axis] - m_path.from[axis];
				if ( m_path.along[axis] == 0.0 )
				{
					if ( low > 0.0 || high < 0.0 )
					{
						return kNever;
					}
					continue;
				}
				const double a = low * m_inverse[axis], b = high * m_inverse[axis];
				in = std::max( in, std::min( a, b ) );
				out = std::min( out, std::max( a, b ) );
			}
			return in <= out ? in : kNever;
		}

	private:
		const BoxPath& m_path;
		Vec3d m_inverse;
	};

	void split( const std::vector<Vec3>& centres, int first, int last );

	std::vector<Box> m_boxes;
	std::vector<std::uint32_t> m_order; // triangles, leaf by leaf
};

} // namespace pliant
