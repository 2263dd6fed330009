#include "matching/implicit/flat_boxes.h"

#include <algorithm>

namespace pliant {

void FlatBoxes::layOut( int gridX, int gridY, int gridZ, int halfWidth, int padded )
{
	// Rows are read beyond their ends by the neighbours' offsets: one plane at a time along z, up to the number of planes.
	const int reach = std::max( halfWidth * gridX, std::min( halfWidth, gridZ - 1 ) * gridX * gridY );
	m_margin = std::size_t( ( reach + kLanes - 1 ) / kLanes * kLanes );
	m_stride = std::size_t( padded ) + m_margin;
	m_rows.assign( 2 * kRateSums * m_stride + m_margin, 0.0f );
	m_x.assign( std::size_t( padded ), 0 );
	m_y.assign( std::size_t( padded ), 0 );
	for ( int i = 0; i < gridX * gridY * gridZ; ++i )
	{
		m_x[std::size_t( i )] = i % gridX;
		m_y[std::size_t( i )] = i / gridX % gridY;
	}
}

FlatRows FlatBoxes::view()
{
	FlatRows rows;
	for ( std::size_t k = 0; k < kRateSums; ++k )
	{
		rows.node[k] = m_rows.data() + m_margin + k * m_stride;
		rows.region[k] = rows.node[k] + kRateSums * m_stride;
	}
	rows.x = m_x.data();
	rows.y = m_y.data();
	return rows;
}

} // namespace pliant
