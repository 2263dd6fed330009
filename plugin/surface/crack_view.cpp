#include "surface/crack_view.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <limits>

namespace pliant {

namespace {

/// How far ahead of its use memory is asked for that lies anywhere in the template's, vertices.
constexpr std::size_t kFar = 24, kNear = 8, kBlock = 512, kFewPatches = 4, kLine = 64;

} // namespace

void CrackGatherer::gather( const CrackSides& sides, const std::vector<std::uint32_t>& cells, const Vec3& shift, CrackView& view )
{
	m_sides = &sides;
	makeRoom( cells, view );
	for ( std::uint32_t k = 0; k < std::uint32_t( cells.size() ); ++k )
	{
		m_cellNow[cells[k]] = k;
	}
	std::array<std::uint32_t, 3>* triangles = view.ownTriangles.data();
	for ( std::size_t k = 0; k < m_patch.size(); )
	{
		const std::size_t end = lookAhead( k );
		for ( std::uint32_t first = 0; k < end; ++k )
		{
			triangles = takePatch( m_patch[k], m_local.data() + first, triangles );
			if ( k < cells.size() )
			{
				addAreas( m_patch[k], m_local.data() + first );
			}
			first += verticesOf( m_patch[k] );
		}
		m_outerCount = k <= cells.size() ? m_count : m_outerCount;
	}
	takeSources( cells, view );
	writeVertices( shift, view );
	writeStarts( view.ownBinding );
	writeRows( view.ownBinding );
	for ( const std::uint32_t cell : cells )
	{
		m_cellNow[cell] = kNone;
	}
	view.binding = &view.ownBinding;
	view.triangles = view.ownTriangles.data();
	view.sources = view.ownSources.data();
	view.texture = view.ownTexture.data();
	view.triangleCount = int( view.ownTriangles.size() );
	view.change = {};
}

// The outer surface first, so that its triangles and vertices are one run.
void CrackGatherer::makeRoom( const std::vector<std::uint32_t>& cells, CrackView& view )
{
	const CellComplex& complex = m_sides->complex();
	const CrackPatches& patches = m_sides->patches();
	m_patch.assign( cells.begin(), cells.end() );
	for ( const std::uint32_t cell : cells )
	{
		for ( std::uint32_t entry = complex.facesOfCell.start[cell]; entry < complex.facesOfCell.start[cell + 1]; ++entry )
		{
			if ( m_sides->isBroken( complex.facesOfCell.entry[entry] ) )
			{
				m_patch.push_back( patches.sideOfFace( entry ) );
			}
		}
	}
	std::size_t vertices = 0, triangles = 0;
	for ( const std::uint32_t patch : m_patch )
	{
		vertices += patches.patch[patch + 1].firstVertex - patches.patch[patch].firstVertex;
		triangles += patches.patch[patch + 1].firstTriangle - patches.patch[patch].firstTriangle;
	}
	m_cellNow.resize( complex.cellCount(), kNone );
	// All numbers of the body before are below its first of now, and vertices are at least as many as groups of normals.
	const std::size_t used = std::size_t( m_first ) + m_made.size();
	m_first = std::uint32_t( used );
	if ( m_number.size() < patches.numbersOfSlot.back() || used + vertices > std::numeric_limits<std::uint32_t>::max() )
	{
		m_number.assign( patches.numbersOfSlot.back(), 0 );
		m_first = 1;
	}
	m_made.resize( std::max( m_made.size(), vertices ) );
	m_cells = cells.size();
	m_count = 0;
	m_outerCount = 0;
	m_normalGroups = 0;
	m_row.clear();
	m_area.clear();
	view.ownTriangles.resize( triangles );
}

void CrackGatherer::takeSources( const std::vector<std::uint32_t>& cells, CrackView& view ) const
{
	const CellComplex& complex = m_sides->complex();
	view.ownSources.resize( view.ownTriangles.size() );
	auto to = view.ownSources.begin();
	for ( const std::uint32_t cell : cells )
	{
		to = std::copy( complex.triangleSource.begin() + complex.cellTriangleStart[cell], complex.triangleSource.begin() + complex.cellTriangleStart[cell + 1], to );
	}
	std::fill( to, view.ownSources.end(), kNone );
}

/// Looks up the sides of the next patches, some hundreds of vertices, in steps, so that what each leads to is on its way when it is asked for. Where
/// those patches end.
std::size_t CrackGatherer::lookAhead( std::size_t first )
{
	const CrackPatches& patches = m_sides->patches();
	m_vertex.clear();
	std::size_t end = first;
	for ( ; end < m_patch.size() && m_vertex.size() < kBlock && isOuter( end ) == isOuter( first ); ++end )
	{
		const CrackPatches::Patch& soon = patches.patch[m_patch[std::min( end + kFewPatches, m_patch.size() - 1 )]];
		__builtin_prefetch( &patches.vertex[soon.firstVertex] );
		__builtin_prefetch( &patches.vertex[soon.firstVertex] + kLine / sizeof( CrackPatches::Vertex ) );
		__builtin_prefetch( patches.triangle.data() + soon.firstTriangle );
		__builtin_prefetch( patches.triangle.data() + soon.firstTriangle + kLine / sizeof( patches.triangle[0] ) );
		for ( std::uint32_t v = patches.patch[m_patch[end]].firstVertex; v < patches.patch[m_patch[end] + 1].firstVertex; ++v )
		{
			m_vertex.push_back( v );
			m_sides->fetchSide( patches.vertex[v].slot );
		}
	}
	m_local.resize( m_vertex.size() );
	for ( std::size_t k = 0; k < m_vertex.size(); ++k )
	{
		m_local[k] = m_sides->sideOf( patches.vertex[m_vertex[k]].slot );
		__builtin_prefetch( &patches.numbersOfSlot[m_local[k]] );
	}
	for ( std::size_t k = 0; k < m_vertex.size(); ++k )
	{
		const CrackPatches::Vertex& of = patches.vertex[m_vertex[k]];
		m_local[k] = patches.numbersOfSlot[m_local[k]];
		if ( of.isAlone == 0 )
		{
			__builtin_prefetch( &m_number[m_local[k]], 1 );
			__builtin_prefetch( &m_number[m_local[k] + CrackPatches::kNumbersOfSide + of.kindAt], 1 );
		}
	}
	return end;
}

/// `local`: of each vertex of the patch where its side's numbers are, then its number in the body.
std::array<std::uint32_t, 3>* CrackGatherer::takePatch( std::uint32_t patch, std::uint32_t* local, std::array<std::uint32_t, 3>* triangles )
{
	const CrackPatches& patches = m_sides->patches();
	const std::uint32_t first = patches.patch[patch].firstVertex, count = verticesOf( patch );
	for ( std::uint32_t k = 0; k < count; ++k )
	{
		const CrackPatches::Vertex& of = patches.vertex[first + k];
		if ( of.isAlone != 0 )
		{
			m_row.push_back( { m_count, of.slot, 0 } );
			local[k] = addVertex( first + k, m_count, m_normalGroups++ );
		}
		else
		{
			local[k] = numberOf( first + k, m_number.data() + local[k] );
		}
	}
	for ( std::uint32_t t = patches.patch[patch].firstTriangle; t < patches.patch[patch + 1].firstTriangle; ++t, ++triangles )
	{
		const auto& corner = patches.triangle[t];
		*triangles = { local[corner[0]], local[corner[1]], local[corner[2]] };
	}
	return triangles;
}

std::uint32_t CrackGatherer::addVertex( std::uint32_t vertex, std::uint32_t carrier, std::uint32_t normalGroup )
{
	m_made[m_count] = { vertex, carrier, normalGroup };
	return m_count++;
}

/// `known`: the numbers of the vertex's side. Vertices of one side share a normal, outer ones one and inner ones another; without noise the inner ones
/// are sides of cubes, each with its own.
std::uint32_t CrackGatherer::numberOf( std::uint32_t vertex, std::uint32_t* known )
{
	const CrackPatches::Vertex& of = m_sides->patches().vertex[vertex];
	std::uint32_t& number = known[CrackPatches::kNumbersOfSide + of.kindAt];
	if ( number < m_first )
	{
		number = m_first + m_count;
		if ( known[Carrier] < m_first )
		{
			known[Carrier] = number;
			m_row.push_back( { m_count, m_sides->sideOf( of.slot ), 0 } );
		}
		const bool isInside = of.isInside != 0;
		std::uint32_t& normals = known[isInside ? InnerNormals : OuterNormals];
		if ( normals < m_first || ( isInside && !( m_sides->complex().settings.noiseAmplitude > 0.0f ) ) )
		{
			normals = m_first + m_normalGroups++;
		}
		addVertex( vertex, known[Carrier] - m_first, normals - m_first );
	}
	return number - m_first;
}

/// Of the patch just taken, an outer one.
void CrackGatherer::addAreas( std::uint32_t patch, const std::uint32_t* local )
{
	const CrackPatches& patches = m_sides->patches();
	const std::uint32_t first = patches.patch[patch].firstVertex;
	const auto pointOf = [&]( std::uint32_t k ) { return patches.look[first + k].point; };
	bool isAnew = false;
	for ( std::uint32_t k = 0; k < verticesOf( patch ) && !isAnew; ++k )
	{
		isAnew = m_sides->isShadedAnew( pointOf( k ) );
	}
	m_area.resize( m_normalGroups, Vec3::Zero() );
	for ( std::uint32_t t = patches.patch[patch].firstTriangle; isAnew && t < patches.patch[patch + 1].firstTriangle; ++t )
	{
		const auto& corner = patches.triangle[t];
		const Vec3& a = m_sides->placeOf( pointOf( corner[0] ) );
		const Vec3 area = ( m_sides->placeOf( pointOf( corner[1] ) ) - a ).cross( m_sides->placeOf( pointOf( corner[2] ) ) - a );
		for ( const std::uint32_t k : corner )
		{
			m_area[m_made[local[k]].normalGroup] += area;
		}
	}
}

/// Outside, a vertex is shaded as the whole mesh was, however few of the triangles around it are left on its side.
void CrackGatherer::writeVertices( const Vec3& shift, CrackView& view ) const
{
	const CrackPatches& patches = m_sides->patches();
	SkinBinding& to = view.ownBinding;
	to.kind = m_sides->complex().skinning;
	to.normalGroups = int( m_normalGroups );
	to.restPosition.resize( m_count );
	to.restNormal.resize( m_count );
	to.normalShift.resize( m_outerCount );
	to.normalGroup.resize( m_count );
	to.carrier.resize( m_count );
	view.ownTexture.resize( 2 * std::size_t( m_count ) );
	for ( std::size_t k = 0; k < m_count; ++k )
	{
		__builtin_prefetch( &patches.look[m_made[std::min<std::size_t>( k + kFar, m_count - 1 )].vertex] );
		m_sides->fetchPlace( patches.look[m_made[std::min<std::size_t>( k + kNear, m_count - 1 )].vertex].point );
		const Made& made = m_made[k];
		const CrackPatches::Look& look = patches.look[made.vertex];
		to.restPosition[k] = m_sides->placeOf( look.point ) - shift;
		to.normalGroup[k] = made.normalGroup;
		to.carrier[k] = made.carrier;
		view.ownTexture[2 * k] = look.u;
		view.ownTexture[2 * k + 1] = look.v;
	}
	writeNormals( to );
}

void CrackGatherer::writeNormals( SkinBinding& to ) const
{
	const CrackPatches& patches = m_sides->patches();
	for ( std::uint32_t k = 0; k < m_outerCount; ++k )
	{
		const CrackPatches::Look& look = patches.look[m_made[k].vertex];
		const Vec3& normal = m_sides->complex().vertexNormal[look.kind];
		to.restNormal[k] = normal;
		to.normalShift[k] = m_sides->isShadedAnew( look.point ) ? CrackSurface::normalShift( normal, m_area[m_made[k].normalGroup] ) : patches.normalShift[look.kind];
	}
	Vec3 inside[6];
	for ( std::uint32_t side = 0; side < 6; ++side )
	{
		inside[side] = CrackSurface::insideNormal( CrackSurface::kInside + side );
	}
	for ( std::uint32_t k = m_outerCount; k < m_count; ++k )
	{
		to.restNormal[k] = inside[patches.look[m_made[k].vertex].kind - CrackSurface::kInside];
	}
}

/// A row has a place for each cell that its side follows, and one where it follows none. Only vertices that carry others have one.
void CrackGatherer::writeStarts( SkinBinding& to )
{
	to.start.resize( std::size_t( m_count ) + 1 );
	std::uint32_t entries = 0, vertex = 0;
	for ( std::size_t k = 0; k < m_row.size(); ++k )
	{
		__builtin_prefetch( m_sides->carriersAt( m_row[std::min( k + kFar, m_row.size() - 1 )].side ) );
		Row& row = m_row[k];
		std::fill( to.start.begin() + vertex, to.start.begin() + row.vertex + 1, entries );
		vertex = row.vertex + 1;
		row.carriers = m_sides->carriersOf( row.side );
		entries += std::max( 1u, std::uint32_t( std::popcount( row.carriers ) ) );
	}
	std::fill( to.start.begin() + vertex, to.start.end(), entries );
	to.node.resize( entries );
	to.weight.resize( entries );
}

void CrackGatherer::writeRows( SkinBinding& to ) const
{
	const CellComplex& complex = m_sides->complex();
	const auto pointOf = [this]( std::size_t k ) { return m_sides->patches().pointOfSlot[m_row[std::min( k, m_row.size() - 1 )].side]; };
	for ( std::size_t k = 0; k < m_row.size(); ++k )
	{
		__builtin_prefetch( &complex.bindStart[pointOf( k + kFar )] );
		const std::uint32_t soon = complex.bindStart[pointOf( k + kNear )];
		__builtin_prefetch( complex.bindCell.data() + soon );
		__builtin_prefetch( complex.bindWeight.data() + soon );
		const std::uint32_t start = to.start[m_row[k].vertex];
		writeRow( m_row[k], to.node.data() + start, to.weight.data() + start );
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
	// A cell that hardly carries a point (weights to 6e-5 have been seen) may come off without its side being asked anew: the rest carry all.
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
