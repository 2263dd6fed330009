#include "world/query/triangle_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace pliant {

namespace {

/// Orders triangles along an axis, or else along the next ones: by their numbers only where all agree.
bool isBefore( const std::vector<Vec3>& centres, int axis, std::uint32_t a, std::uint32_t b )
{
	for ( int k = axis; k < axis + 3; ++k )
	{
		const float first = centres[a][k % 3], second = centres[b][k % 3];
		if ( first != second )
		{
			return first < second;
		}
	}
	return a < b;
}

} // namespace

void TriangleTree::sort( const TriangleView& atRest )
{
	std::vector<Vec3> centres( std::size_t( atRest.triangles ) );
	for ( int t = 0; t < atRest.triangles; ++t )
	{
		centres[std::size_t( t )] = ( ( atRest.corner( t, 0 ) + atRest.corner( t, 1 ) + atRest.corner( t, 2 ) ) / 3.0 ).cast<float>();
	}
	m_order.resize( centres.size() );
	std::iota( m_order.begin(), m_order.end(), 0U );
	m_boxes.clear();
	if ( atRest.triangles > 0 )
	{
		split( centres, 0, atRest.triangles );
	}
}

void TriangleTree::split( const std::vector<Vec3>& centres, int first, int last ) // NOLINT(misc-no-recursion): as deep as the logarithm
{
	const std::size_t own = m_boxes.size();
	m_boxes.emplace_back();
	if ( last - first <= kLeaf )
	{
		m_boxes[own].first = first;
		m_boxes[own].count = last - first;
		std::sort( m_order.begin() + first, m_order.begin() + last,
			[&centres]( std::uint32_t a, std::uint32_t b ) { return isBefore( centres, 0, a, b ); } );
	}
	else
	{
		const float most = std::numeric_limits<float>::max();
		Vec3 low( most, most, most ), high( -low );
		for ( int k = first; k < last; ++k )
		{
			low = low.cwiseMin( centres[m_order[std::size_t( k )]] );
			high = high.cwiseMax( centres[m_order[std::size_t( k )]] );
		}
		int axis = 0;
		( high - low ).maxCoeff( &axis );
		const int middle = ( first + last ) / 2;
		std::nth_element( m_order.begin() + first, m_order.begin() + middle, m_order.begin() + last,
			[&centres, axis]( std::uint32_t a, std::uint32_t b ) { return isBefore( centres, axis, a, b ); } );
		split( centres, first, middle );
		split( centres, middle, last );
	}
	m_boxes[own].after = int( m_boxes.size() );
}

void TriangleTree::refit( const TriangleView& surface )
{
	for ( std::size_t at = m_boxes.size(); at-- > 0; )
	{
		Box& box = m_boxes[at];
		if ( box.count == 0 )
		{
			const Box &lower = m_boxes[at + 1], &upper = m_boxes[std::size_t( lower.after )];
			box.low = lower.low.cwiseMin( upper.low );
			box.high = lower.high.cwiseMax( upper.high );
			continue;
		}
		const float most = std::numeric_limits<float>::max();
		Eigen::Array3f low( most, most, most ), high( -low );
		for ( int k = 0; k < box.count; ++k )
		{
			const std::uint32_t* const index = surface.indices + 3 * std::size_t( m_order[std::size_t( box.first + k )] );
			for ( int corner = 0; corner < 3; ++corner )
			{
				const Eigen::Map<const Eigen::Array3f> vertex( surface.positions + 3 * std::size_t( index[corner] ) );
				low = low.min( vertex );
				high = high.max( vertex );
			}
		}
		box.low = low;
		box.high = high;
	}
}

} // namespace pliant
