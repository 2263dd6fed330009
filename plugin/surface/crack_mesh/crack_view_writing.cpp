// Writes the numbered vertices, normals and rows of weights, divided among threads.

#include "surface/crack_mesh/crack_view.h"

#include "surface/crack_mesh/resize_for_overwrite.h"
#include "threads/parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>

namespace pliant {

void CrackGatherer::write( const std::vector<std::uint32_t>& cells, const Vec3& shift, CrackView& view, TaskRunner* runner )
{
	SkinBinding& to = view.binding;
	m_cellInBody.resize( m_sides->complex().cellCount(), kNone );
	for ( std::uint32_t k = 0; k < std::uint32_t( cells.size() ); ++k )
	{
		m_cellInBody[cells[k]] = k;
	}
	const ChunkedRange rows{ int( m_row.size() ) }, vertices{ int( m_count ) };
	PerChunk<std::uint32_t> entries{};
	runChunks( runner, rows, [&]( int fraction, int begin, int end ) {
		entries[std::size_t( fraction )] = takeCarriers( std::size_t( begin ), std::size_t( end ) );
	} );
	std::uint32_t sum = 0;
	for ( std::uint32_t& each : entries )
	{
		sum += each;
		each = sum - each;
	}
	makeArrays( view );
	resizeForOverwrite( to.node, sum );
	resizeForOverwrite( to.weight, sum );
	auto task = [&]( int k ) {
		const int fraction = k < rows.chunks() ? k : k - rows.chunks();
		if ( k < rows.chunks() )
		{
			writeRows( to, std::size_t( rows.begin( fraction ) ), std::size_t( rows.end( fraction ) ), entries[std::size_t( fraction )] );
		}
		else if ( fraction < vertices.chunks() )
		{
			writeVertices( shift, view, std::size_t( vertices.begin( fraction ) ), std::size_t( vertices.end( fraction ) ) );
		}
		else
		{
			takeSources( cells, view );
		}
	};
	runTasks( runner, rows.chunks() + vertices.chunks() + 1, task );
	view.sources.pop_back();
	listPlaced( to, runner );
	const std::uint32_t last = m_row.empty() ? 0 : m_row.back().vertex + 1;
	std::fill( to.start.begin() + last, to.start.end(), sum );
	for ( const std::uint32_t cell : cells )
	{
		m_cellInBody[cell] = kNone;
	}
}

void CrackGatherer::makeArrays( CrackView& view ) const
{
	SkinBinding& to = view.binding;
	to.kind = m_sides->complex().skinning;
	to.normalGroups = int( m_normalGroups );
	resizeForOverwrite( to.restPosition, m_count );
	resizeForOverwrite( to.restNormal, m_count );
	resizeForOverwrite( to.normalShift, m_outerCount );
	resizeForOverwrite( to.normalGroup, m_count );
	resizeForOverwrite( to.carrier, m_count );
	resizeForOverwrite( to.point, m_count );
	resizeForOverwrite( to.start, std::size_t( m_count ) + 1 );
	resizeForOverwrite( view.texture, 2 * std::size_t( m_count ) );
	resizeForOverwrite( view.kinds, m_count );
	resizeForOverwrite( view.sources, view.triangles.size() + 1 ); // one more: see takeSources
}

/// Branch-free: each is written, and counted if it is drawn, so the array has one more entry.
void CrackGatherer::takeSources( const std::vector<std::uint32_t>& cells, CrackView& view ) const
{
	const CellComplex& complex = m_sides->complex();
	std::uint32_t* to = view.sources.data();
	for ( const std::uint32_t cell : cells )
	{
		for ( std::uint32_t t = complex.cellTriangleStart[cell]; t < complex.cellTriangleStart[cell + 1]; ++t )
		{
			*to = complex.triangleSource[t];
			to += m_sides->panels().isOfOne( t ) ? 0 : 1;
		}
	}
	to = std::copy( m_panelSource.begin(), m_panelSource.end(), to );
	std::fill( to, view.sources.data() + view.sources.size(), kNone );
}

void CrackGatherer::writeVertices( const Vec3& shift, CrackView& view, std::size_t first, std::size_t last ) const
{
	const CrackPatches& patches = m_sides->patches();
	SkinBinding& to = view.binding;
	for ( std::size_t k = first; k < last; ++k )
	{
		const Made& made = m_made[k];
		const CrackPatches::Appearance& appearance = patches.appearance[made.vertex];
		to.restPosition[k] = m_sides->positionOf( appearance.point ) - shift;
		to.normalGroup[k] = made.normalGroup;
		to.carrier[k] = made.carrier;
		to.point[k] = appearance.point;
		view.texture[2 * k] = appearance.u;
		view.texture[2 * k + 1] = appearance.v;
		view.kinds[k] = appearance.kind;
	}
	writeNormals( to, first, last );
}

/// Outer vertices are shaded as on the whole mesh, however few of the adjacent triangles are on their side.
void CrackGatherer::writeNormals( SkinBinding& to, std::size_t first, std::size_t last ) const
{
	const CrackPatches& patches = m_sides->patches();
	for ( std::size_t k = first; k < std::min<std::size_t>( last, m_outerCount ); ++k )
	{
		const CrackPatches::Appearance& appearance = patches.appearance[m_made[k].vertex];
		const Vec3& normal = m_sides->complex().vertexNormal[appearance.kind];
		to.restNormal[k] = normal;
		const bool isReshaded = m_sides->isReshaded( appearance.point ) && !m_sides->panels().isPlaced( appearance.point );
		to.normalShift[k] = isReshaded ? CrackPatches::shiftOf( normal, m_area[m_made[k].normalGroup] )
									   : patches.normalShift[appearance.kind];
	}
	Vec3 inside[6];
	for ( std::uint32_t side = 0; side < 6; ++side )
	{
		inside[side] = ( side % 2 != 0 ? -1.0f : 1.0f ) * Vec3::Unit( int( side / 2 ) );
	}
	for ( std::size_t k = std::max<std::size_t>( first, m_outerCount ); k < last; ++k )
	{
		to.restNormal[k] = inside[patches.appearance[m_made[k].vertex].kind - CrackPatches::kInside];
	}
}

namespace {

/// Entries in the row of a side: one for each cell that it follows, at least one.
std::uint32_t entriesOf( std::uint64_t carriers )
{
	return std::max( 1u, std::uint32_t( std::popcount( carriers ) ) );
}

} // namespace

/// Returns the number of their entries.
std::uint32_t CrackGatherer::takeCarriers( std::size_t first, std::size_t last )
{
	std::uint32_t entries = 0;
	for ( std::size_t k = first; k < last; ++k )
	{
		m_row[k].carriers = m_sides->carriersOf( m_row[k].side );
		entries += entriesOf( m_row[k].carriers );
	}
	return entries;
}

/// Only carriers have a row. `entries`: of the rows before these.
void CrackGatherer::writeRows( SkinBinding& to, std::size_t first, std::size_t last, std::uint32_t entries ) const
{
	std::uint32_t vertex = first == 0 ? 0 : m_row[first - 1].vertex + 1;
	for ( std::size_t k = first; k < last; ++k )
	{
		const Row& row = m_row[k];
		std::fill( to.start.begin() + vertex, to.start.begin() + row.vertex + 1, entries );
		vertex = row.vertex + 1;
		writeRow( row, to.node.data() + entries, to.weight.data() + entries );
		entries += entriesOf( row.carriers );
	}
}

void CrackGatherer::writeRow( const Row& row, std::uint32_t* node, float* weight ) const
{
	const CellComplex& complex = m_sides->complex();
	const std::uint32_t point = m_sides->patches().pointOfSlot[row.side], first = complex.bindStart[point];
	const std::uint64_t carriers = row.carriers;
	int count = 0, known = 0;
	double sum = 0.0;
	for ( std::uint64_t remaining = carriers; remaining != 0; remaining &= remaining - 1, ++count )
	{
		const std::uint32_t k = first + std::uint32_t( std::countr_zero( remaining ) );
		node[count] = m_cellInBody[complex.bindCell[k]];
		weight[count] = complex.bindWeight[k];
		known += node[count] != kNone ? 1 : 0;
		sum += double( weight[count] );
	}
	if ( known == 0 ) // it follows the first of its own cells
	{
		std::fill( node, node + std::max( 1, count ), m_cellInBody[complex.cellsOfPoint.entry[row.side]] );
		std::fill( weight, weight + std::max( 1, count ), 0.0f );
		weight[0] = 1.0f;
		return;
	}
	const bool isWhole = first + std::uint32_t( count ) == complex.bindStart[point + 1];
	for ( int k = 0; k < count && !isWhole; ++k )
	{
		weight[k] = float( double( weight[k] ) / sum );
	}
	if ( known == count )
	{
		return;
	}
	// A cell that hardly carries a point (weights up to 6e-5 occur) may separate without an update of its side: the other cells take its
	// weight.
	float others = 0.0f;
	int kept = 0;
	for ( int k = 0; k < count; ++k )
	{
		if ( node[k] == kNone )
		{
			others += weight[k];
			continue;
		}
		node[kept] = node[k];
		weight[kept++] = weight[k];
	}
	std::for_each( weight, weight + kept, [others]( float& w ) { w /= 1.0f - others; } );
	std::fill( node + kept, node + count, node[0] );
	std::fill( weight + kept, weight + count, 0.0f );
}

} // namespace pliant
