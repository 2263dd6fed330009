#include "surface/crack_view.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>

namespace pliant {

void CrackGatherer::gather( const CrackSides& sides, const std::vector<std::uint32_t>& cells, const Vec3& shift, CrackView& view )
{
	m_sides = &sides;
	m_cellNow.resize( sides.complex().cellCount(), kNone );
	m_side.resize( sides.patches().pointOfSlot.size() );
	++m_round;
	m_made.clear();
	m_triangle.clear();
	m_node.clear();
	m_weight.clear();
	m_area.clear();
	m_normalGroups = 0;
	for ( std::uint32_t k = 0; k < std::uint32_t( cells.size() ); ++k )
	{
		m_cellNow[cells[k]] = k;
	}
	takeCells( cells, view );
	fill( shift, view );
	fillNormals( view );
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
void CrackGatherer::takeCells( const std::vector<std::uint32_t>& cells, CrackView& view )
{
	const CellComplex& complex = m_sides->complex();
	for ( const std::uint32_t cell : cells )
	{
		takePatch( cell );
		addAreas( cell );
	}
	for ( const std::uint32_t cell : cells )
	{
		for ( std::uint32_t entry = complex.facesOfCell.start[cell]; entry < complex.facesOfCell.start[cell + 1]; ++entry )
		{
			if ( m_sides->isBroken( complex.facesOfCell.entry[entry] ) )
			{
				takePatch( m_sides->patches().sideOfFace( entry ) );
			}
		}
	}
	view.ownTriangles.assign( m_triangle.begin(), m_triangle.end() );
	view.ownSources.clear();
	view.ownSources.reserve( m_triangle.size() );
	for ( const std::uint32_t cell : cells )
	{
		view.ownSources.insert( view.ownSources.end(), complex.triangleSource.begin() + complex.cellTriangleStart[cell],
			complex.triangleSource.begin() + complex.cellTriangleStart[cell + 1] );
	}
	view.ownSources.resize( view.ownTriangles.size(), kNone );
}

// First all sides are looked up, so that what they lead to is on its way when it is asked for.
void CrackGatherer::takePatch( std::uint32_t patch )
{
	const CrackPatches& patches = m_sides->patches();
	const CrackPatches::Patch &known = patches.patch[patch], &next = patches.patch[patch + 1];
	m_local.resize( next.firstVertex - known.firstVertex );
	const CrackPatches::Vertex* const vertex = patches.vertex.data() + known.firstVertex;
	for ( std::size_t k = 0; k < m_local.size(); ++k )
	{
		m_local[k] = m_sides->sideOf( vertex[k].slot );
		__builtin_prefetch( &m_side[m_local[k]], 1 );
	}
	for ( std::size_t k = 0; k < m_local.size(); ++k )
	{
		m_local[k] = numberOf( vertex[k], m_local[k] );
	}
	const std::size_t before = m_triangle.size();
	m_triangle.resize( before + next.firstTriangle - known.firstTriangle );
	for ( std::size_t t = before; t < m_triangle.size(); ++t )
	{
		const auto& corner = patches.triangle[known.firstTriangle + t - before];
		m_triangle[t] = { m_local[corner[0]], m_local[corner[1]], m_local[corner[2]] };
	}
}

std::uint32_t CrackGatherer::numberOf( const CrackPatches::Vertex& vertex, std::uint32_t at )
{
	SideNow& side = m_side[at];
	if ( side.round != m_round )
	{
		side = SideNow{};
		side.round = m_round;
		side.carrier = std::uint32_t( m_made.size() );
	}
	std::uint32_t number = side.newest;
	while ( number != kNone && m_made[number].kind != vertex.kind )
	{
		number = m_made[number].next;
	}
	if ( number == kNone )
	{
		number = std::uint32_t( m_made.size() );
		m_made.push_back( { at, vertex.point, vertex.kind, side.newest, side.carrier, normalsOf( side, vertex.kind >= CrackSurface::kInside ), vertex.u, vertex.v } );
		side.newest = number;
	}
	return number;
}

/// Vertices of one side share a normal, outer ones one and inner ones another; without noise the inner ones are sides of cubes, each with its own.
std::uint32_t CrackGatherer::normalsOf( SideNow& side, bool isInside )
{
	std::uint32_t& known = isInside ? side.innerNormals : side.outerNormals;
	if ( known == kNone || ( isInside && !( m_sides->complex().settings.noiseAmplitude > 0.0f ) ) )
	{
		known = m_normalGroups++;
	}
	return known;
}

/// Of the patch just taken, an outer one.
void CrackGatherer::addAreas( std::uint32_t patch )
{
	const CrackPatches& patches = m_sides->patches();
	const std::uint32_t first = patches.patch[patch].firstVertex;
	const auto pointOf = [&]( std::uint32_t local ) { return patches.vertex[first + local].point; };
	bool isAnew = false;
	for ( std::uint32_t k = 0; k < std::uint32_t( m_local.size() ) && !isAnew; ++k )
	{
		isAnew = m_sides->isShadedAnew( pointOf( k ) );
	}
	m_area.resize( m_normalGroups, Vec3::Zero() );
	for ( std::uint32_t t = patches.patch[patch].firstTriangle; isAnew && t < patches.patch[patch + 1].firstTriangle; ++t )
	{
		const auto& corner = patches.triangle[t];
		const Vec3& a = m_sides->placeOf( pointOf( corner[0] ) );
		const Vec3 area = ( m_sides->placeOf( pointOf( corner[1] ) ) - a ).cross( m_sides->placeOf( pointOf( corner[2] ) ) - a );
		for ( const std::uint32_t local : corner )
		{
			m_area[m_made[m_local[local]].normalGroup] += area;
		}
	}
}

void CrackGatherer::fill( const Vec3& shift, CrackView& view )
{
	SkinBinding& to = view.ownBinding;
	const std::size_t count = m_made.size();
	to.kind = m_sides->complex().skinning;
	to.normalGroups = int( m_normalGroups );
	to.start.resize( count + 1 );
	to.restPosition.resize( count );
	to.normalGroup.resize( count );
	to.carrier.resize( count );
	view.ownTexture.resize( 2 * count );
	for ( std::size_t k = 0; k < count; ++k )
	{
		fetchAhead( k );
		const Made& made = m_made[k];
		to.start[k] = std::uint32_t( m_node.size() );
		to.restPosition[k] = m_sides->placeOf( made.point ) - shift;
		to.normalGroup[k] = made.normalGroup;
		to.carrier[k] = made.carrier;
		view.ownTexture[2 * k] = made.u;
		view.ownTexture[2 * k + 1] = made.v;
		if ( made.carrier == k )
		{
			addRow( made );
		}
	}
	to.start[count] = std::uint32_t( m_node.size() );
	to.node.assign( m_node.begin(), m_node.end() );
	to.weight.assign( m_weight.begin(), m_weight.end() );
}

/// What comes to a few vertices later lies anywhere in the template's memory.
void CrackGatherer::fetchAhead( std::size_t k ) const
{
	constexpr std::size_t kPoints = 24, kRows = 12;
	const CellComplex& complex = m_sides->complex();
	if ( k + kPoints < m_made.size() )
	{
		__builtin_prefetch( &complex.bindStart[m_made[k + kPoints].point] );
		__builtin_prefetch( &m_sides->placeOf( m_made[k + kPoints].point ) );
	}
	if ( k + kRows < m_made.size() )
	{
		const std::uint32_t row = complex.bindStart[m_made[k + kRows].point];
		__builtin_prefetch( complex.bindCell.data() + row );
		__builtin_prefetch( complex.bindWeight.data() + row );
	}
}

void CrackGatherer::addRow( const Made& made )
{
	const CellComplex& complex = m_sides->complex();
	const std::uint32_t first = complex.bindStart[made.point], all = complex.bindStart[made.point + 1] - first;
	const std::uint64_t carriers = m_sides->carriersOf( made.side );
	const std::size_t begin = m_node.size();
	if ( carriers == 0 ) // it goes with the first of its own cells
	{
		m_node.push_back( m_cellNow[complex.cellsOfPoint.entry[made.side]] );
		m_weight.push_back( 1.0f );
		return;
	}
	const bool isWhole = std::uint32_t( std::popcount( carriers ) ) == all;
	double sum = 0.0;
	for ( std::uint64_t open = carriers; open != 0 && !isWhole; open &= open - 1 )
	{
		sum += double( complex.bindWeight[first + std::uint32_t( std::countr_zero( open ) )] );
	}
	float others = 0.0f; // weight of cells that other bodies have
	for ( std::uint64_t open = carriers; open != 0; open &= open - 1 )
	{
		const std::uint32_t k = first + std::uint32_t( std::countr_zero( open ) );
		const float weight = isWhole ? complex.bindWeight[k] : float( double( complex.bindWeight[k] ) / sum );
		const std::uint32_t cell = m_cellNow[complex.bindCell[k]];
		if ( cell == kNone )
		{
			others += weight;
			continue;
		}
		m_node.push_back( cell );
		m_weight.push_back( weight );
	}
	// A cell that hardly carries a point (weights to 6e-5 have been seen) may come off without its side being asked anew: the rest carry all.
	for ( std::size_t e = begin; others > 0.0f && e < m_weight.size(); ++e )
	{
		m_weight[e] /= 1.0f - others;
	}
}

/// Outside, a vertex is shaded as the whole mesh was, however few of the triangles around it are left on its side.
void CrackGatherer::fillNormals( CrackView& view ) const
{
	SkinBinding& to = view.ownBinding;
	to.restNormal.resize( m_made.size() );
	to.normalShift.resize( m_made.size() );
	for ( std::size_t k = 0; k < m_made.size(); ++k )
	{
		const Made& made = m_made[k];
		if ( made.kind >= CrackSurface::kInside )
		{
			to.restNormal[k] = CrackSurface::insideNormal( made.kind );
			to.normalShift[k].setZero();
			continue;
		}
		const Vec3& normal = m_sides->complex().vertexNormal[made.kind];
		to.restNormal[k] = normal;
		to.normalShift[k] = m_sides->isShadedAnew( made.point ) ? CrackSurface::normalShift( normal, m_area[made.normalGroup] ) : m_sides->patches().normalShift[made.kind];
	}
}

} // namespace pliant
