// Writes down what has been numbered: vertices, normals and rows of weights, in shares.

#include "surface/crack_mesh/crack_view.h"

#include "surface/crack_mesh/resize_for_overwrite.h"
#include "threads/parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>

namespace pliant {

namespace {

/// How far ahead of its use memory is asked for that lies anywhere in the template's.
constexpr std::size_t kFar = 24, kNear = 8;

} // namespace

void CrackGatherer::write( const std::vector<std::uint32_t>& cells, const Vec3& shift, CrackView& view, TaskRunner* runner )
{
	SkinBinding& to = view.ownBinding;
	m_cellNow.resize( m_sides->complex().cellCount(), kNone );
	for ( std::uint32_t k = 0; k < std::uint32_t( cells.size() ); ++k )
	{
		m_cellNow[cells[k]] = k;
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
	view.ownSources.pop_back();
	listPlaced( to, runner );
	const std::uint32_t last = m_row.empty() ? 0 : m_row.back().vertex + 1;
	std::fill( to.start.begin() + last, to.start.end(), sum );
	for ( const std::uint32_t cell : cells )
	{
		m_cellNow[cell] = kNone;
	}
}

void CrackGatherer::makeArrays( CrackView& view ) const
{
	SkinBinding& to = view.ownBinding;
	to.kind = m_sides->complex().skinning;
	to.normalGroups = int( m_normalGroups );
	resizeForOverwrite( to.restPosition, m_count );
	resizeForOverwrite( to.restNormal, m_count );
	resizeForOverwrite( to.normalShift, m_outerCount );
	resizeForOverwrite( to.normalGroup, m_count );
	resizeForOverwrite( to.carrier, m_count );
	resizeForOverwrite( to.point, m_count );
	resizeForOverwrite( to.start, std::size_t( m_count ) + 1 );
	resizeForOverwrite( view.ownTexture, 2 * std::size_t( m_count ) );
	resizeForOverwrite( view.ownSources, view.ownTriangles.size() + 1 ); // takeSources
}

/// Each is written, and counted if it is drawn: one too many has its place.
void CrackGatherer::takeSources( const std::vector<std::uint32_t>& cells, CrackView& view ) const
{
	const CellComplex& complex = m_sides->complex();
	std::uint32_t* to = view.ownSources.data();
	for ( const std::uint32_t cell : cells )
	{
		for ( std::uint32_t t = complex.cellTriangleStart[cell]; t < complex.cellTriangleStart[cell + 1]; ++t )
		{
			*to = complex.triangleSource[t];
			to += m_sides->panels().isOfOne( t ) ? 0 : 1;
		}
	}
	to = std::copy( m_panelSource.begin(), m_panelSource.end(), to );
	std::fill( to, view.ownSources.data() + view.ownSources.size(), kNone );
}

/// Of vertices first to last - 1.
void CrackGatherer::writeVertices( const Vec3& shift, CrackView& view, std::size_t first, std::size_t last ) const
{
	const CrackPatches& patches = m_sides->patches();
	SkinBinding& to = view.ownBinding;
	for ( std::size_t k = first; k < last; ++k )
	{
		__builtin_prefetch( &patches.look[m_made[std::min<std::size_t>( k + kFar, m_count - 1 )].vertex] );
		m_sides->fetchPosition( patches.look[m_made[std::min<std::size_t>( k + kNear, m_count - 1 )].vertex].point );
		const Made& made = m_made[k];
		const CrackPatches::Look& look = patches.look[made.vertex];
		to.restPosition[k] = m_sides->placeOf( look.point ) - shift;
		to.normalGroup[k] = made.normalGroup;
		to.carrier[k] = made.carrier;
		to.point[k] = look.point;
		view.ownTexture[2 * k] = look.u;
		view.ownTexture[2 * k + 1] = look.v;
	}
	writeNormals( to, first, last );
}

/// Outside, a vertex is shaded as the whole mesh was, however few of the triangles around it are left on its side.
void CrackGatherer::writeNormals( SkinBinding& to, std::size_t first, std::size_t last ) const
{
	const CrackPatches& patches = m_sides->patches();
	for ( std::size_t k = first; k < std::min<std::size_t>( last, m_outerCount ); ++k )
	{
		const CrackPatches::Look& look = patches.look[m_made[k].vertex];
		const Vec3& normal = m_sides->complex().vertexNormal[look.kind];
		to.restNormal[k] = normal;
		const bool isAnew = m_sides->isShadedAnew( look.point ) && !m_sides->panels().isPlaced( look.point );
		to.normalShift[k] = isAnew ? CrackSurface::normalShift( normal, m_area[m_made[k].normalGroup] ) : patches.normalShift[look.kind];
	}
	Vec3 inside[6];
	for ( std::uint32_t side = 0; side < 6; ++side )
	{
		inside[side] = CrackSurface::insideNormal( CrackSurface::kInside + side );
	}
	for ( std::size_t k = std::max<std::size_t>( first, m_outerCount ); k < last; ++k )
	{
		to.restNormal[k] = inside[patches.look[m_made[k].vertex].kind - CrackSurface::kInside];
	}
}

namespace {

/// A row has a place for each cell that its side follows, and one where it follows none.
std::uint32_t placesOf( std::uint64_t carriers )
{
	return std::max( 1u, std::uint32_t( std::popcount( carriers ) ) );
}

} // namespace

/// How many places they have in all.
std::uint32_t CrackGatherer::takeCarriers( std::size_t first, std::size_t last )
{
	std::uint32_t entries = 0;
	for ( std::size_t k = first; k < last; ++k )
	{
		__builtin_prefetch( m_sides->carriersAt( m_row[std::min( k + kFar, m_row.size() - 1 )].side ) );
		m_row[k].carriers = m_sides->carriersOf( m_row[k].side );
		entries += placesOf( m_row[k].carriers );
	}
	return entries;
}

/// Only vertices that carry others have a row. `entries`: of the rows before these.
void CrackGatherer::writeRows( SkinBinding& to, std::size_t first, std::size_t last, std::uint32_t entries ) const
{
	const CellComplex& complex = m_sides->complex();
	const auto pointOf = [this]( std::size_t k ) { return m_sides->patches().pointOfSlot[m_row[std::min( k, m_row.size() - 1 )].side]; };
	std::uint32_t vertex = first == 0 ? 0 : m_row[first - 1].vertex + 1;
	for ( std::size_t k = first; k < last; ++k )
	{
		__builtin_prefetch( &complex.bindStart[pointOf( k + kFar )] );
		const std::uint32_t soon = complex.bindStart[pointOf( k + kNear )];
		__builtin_prefetch( complex.bindCell.data() + soon );
		__builtin_prefetch( complex.bindWeight.data() + soon );
		const Row& row = m_row[k];
		std::fill( to.start.begin() + vertex, to.start.begin() + row.vertex + 1, entries );
		vertex = row.vertex + 1;
		writeRow( row, to.node.data() + entries, to.weight.data() + entries );
		entries += placesOf( row.carriers );
	}
}

void CrackGatherer::writeRow( const Row& row, std::uint32_t* node, float* weight ) const
{
	const CellComplex& complex = m_sides->complex();
	const std::uint32_t point = m_sides->patches().pointOfSlot[row.side], first = complex.bindStart[point];
	const std::uint64_t carriers = row.carriers;
	int count = 0, known = 0;
	double sum = 0.0;
	for ( std::uint64_t open = carriers; open != 0; open &= open - 1, ++count )
	{
		const std::uint32_t k = first + std::uint32_t( std::countr_zero( open ) );
		node[count] = m_cellNow[complex.bindCell[k]];
		weight[count] = complex.bindWeight[k];
		known += node[count] != kNone ? 1 : 0;
		sum += double( weight[count] );
	}
	if ( known == 0 ) // it goes with the first of its own cells
	{
		std::fill( node, node + std::max( 1, count ), m_cellNow[complex.cellsOfPoint.entry[row.side]] );
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
	// A cell that hardly carries a point (weights to 6e-5 have been seen) may come off without its side being asked anew: the rest carry
	// all.
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
