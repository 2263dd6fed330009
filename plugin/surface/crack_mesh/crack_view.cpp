#include "surface/crack_mesh/crack_view.h"

#include "surface/crack_mesh/resize_for_overwrite.h"
#include "threads/parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>

namespace pliant {

void CrackGatherer::gather(
	const CrackSides& sides, const std::vector<std::uint32_t>& cells, const Vec3& shift, CrackView& view, TaskRunner* runner )
{
	m_sides = &sides;
	reserveScratch( cells, view );
	if ( runner && runner->threadCount() > 1 )
	{
		numberTogether( view, runner );
	}
	else
	{
		view.triangles.resize( std::size_t( number( 0, m_patch.size(), view.triangles.data() ) - view.triangles.data() ) );
	}
	write( cells, shift, view, runner );
}

// The outer surface comes first, so that its triangles and vertices are contiguous.
void CrackGatherer::reserveScratch( const std::vector<std::uint32_t>& cells, CrackView& view )
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
	begin( vertices );
	m_cells = cells.size();
	resizeForOverwrite( view.triangles, triangles );
	if ( m_sides->panels().arePlaced() && ( m_outerCapacity < vertices || m_shadingCapacity < triangles ) )
	{
		m_outerCapacity = vertices;
		m_shadingCapacity = triangles;
		m_placed = std::make_unique_for_overwrite<std::uint32_t[]>( vertices + 1 );
		m_shading = std::make_unique_for_overwrite<std::array<std::uint32_t, 3>[]>( triangles + 1 );
	}
}

void CrackGatherer::begin( std::size_t vertices )
{
	const CrackPatches& patches = m_sides->patches();
	// All numbers of the previous body are below the new m_first; there are at least as many vertices as groups of normals.
	const std::size_t used = std::size_t( m_first ) + m_made.size();
	m_first = std::uint32_t( used );
	if ( m_number.size() < patches.numbersOfSlot.back() || used + vertices > std::numeric_limits<std::uint32_t>::max() )
	{
		m_number.assign( patches.numbersOfSlot.back(), 0 );
		m_first = 1;
	}
	if ( m_made.size() < vertices )
	{
		resizeForOverwrite( m_made, vertices );
	}
	m_count = 0;
	m_outerCount = 0;
	m_outerTriangles = 0;
	m_normalGroups = 0;
	m_row.clear();
	m_sharedRow.clear();
	m_area.clear();
	m_placedCount = m_shadingCount = 0;
	m_panelTriangle.clear();
	m_panelSource.clear();
}

/// Numbers the patches first to last - 1 of m_patch. Returns the end of their triangles.
std::array<std::uint32_t, 3>* CrackGatherer::number( std::size_t first, std::size_t last, std::array<std::uint32_t, 3>* triangles )
{
	for ( std::size_t k = first; k < last; ++k )
	{
		const std::uint32_t firstNew = m_count;
		lookUpSides( k );
		triangles = takePatch( m_patch[k], m_local.data(), triangles );
		if ( isOuter( k ) )
		{
			addAreas( m_patch[k], m_local.data() );
			if ( m_sides->panels().arePlaced() )
			{
				takeOuter( m_patch[k], m_local.data(), firstNew );
			}
		}
		if ( k + 1 == m_cells )
		{
			m_outerCount = m_count;
			triangles = takePanels( triangles );
		}
	}
	return triangles;
}

/// Numbers the outer surface in one task and the inside in another, each with its own numbers.
void CrackGatherer::numberTogether( CrackView& view, TaskRunner* runner )
{
	const CrackPatches& patches = m_sides->patches();
	m_inner = m_inner ? std::move( m_inner ) : std::make_unique<CrackGatherer>();
	CrackGatherer& inner = *m_inner;
	inner.m_sides = m_sides;
	inner.m_patch.assign( m_patch.begin() + std::ptrdiff_t( m_cells ), m_patch.end() );
	std::size_t vertices = 0, outer = 0;
	for ( std::size_t k = 0; k < m_patch.size(); ++k )
	{
		vertices += isOuter( k ) ? 0 : verticesOf( m_patch[k] );
		outer += isOuter( k ) ? patches.patch[m_patch[k] + 1].firstTriangle - patches.patch[m_patch[k]].firstTriangle : 0;
	}
	inner.begin( vertices );
	// The end of the outer triangles is only known once they are numbered: until then the inside is written behind their largest possible
	// count.
	std::array<std::uint32_t, 3>* end = nullptr;
	const auto begin = view.triangles.begin();
	auto task = [&]( int k ) {
		if ( k == 0 )
		{
			end = number( 0, m_cells, view.triangles.data() );
		}
		else
		{
			inner.number( 0, inner.m_patch.size(), view.triangles.data() + outer );
		}
	};
	runTasks( runner, 2, task );
	const std::ptrdiff_t drawn = end - view.triangles.data();
	view.triangles.erase( begin + drawn, begin + std::ptrdiff_t( outer ) );
	append( end, view.triangles.size() - std::size_t( drawn ), runner );
}

/// Appends the numbered inside to the outer surface; sides that both have get their carriers from the outer one.
void CrackGatherer::append( std::array<std::uint32_t, 3>* triangles, std::size_t count, TaskRunner* runner )
{
	constexpr std::uint32_t kOuter = 1u << 31;
	CrackGatherer& inner = *m_inner;
	const std::vector<SharedRow>& shared = inner.m_sharedRow;
	runChunks( runner, ChunkedRange{ int( shared.size() ) }, [&]( int, int begin, int end ) {
		for ( int k = begin; k < end; ++k )
		{
			const SharedRow& at = shared[std::size_t( k )];
			if ( const std::uint32_t outer = m_number[at.number]; outer >= m_first )
			{
				Row& row = inner.m_row[at.row];
				inner.m_made[row.vertex].carrier = ( outer - m_first ) | kOuter;
				row.side = kNone;
			}
		}
	} );
	const std::uint32_t vertices = m_count, groups = m_normalGroups;
	for ( const Row& row : inner.m_row )
	{
		if ( row.side != kNone )
		{
			m_row.push_back( { row.vertex + vertices, row.side, 0 } );
		}
	}
	runChunks( runner, ChunkedRange{ int( inner.m_count ) }, [&]( int, int begin, int end ) {
		for ( int k = begin; k < end; ++k )
		{
			const Made& made = inner.m_made[std::size_t( k )];
			const std::uint32_t carrier = ( made.carrier & kOuter ) != 0 ? made.carrier : inner.m_made[made.carrier].carrier;
			m_made[std::size_t( k ) + vertices] = {
				made.vertex, ( carrier & kOuter ) != 0 ? carrier ^ kOuter : carrier + vertices, made.normalGroup + groups };
		}
	} );
	runChunks( runner, ChunkedRange{ int( count ) }, [&]( int, int begin, int end ) {
		for ( int t = begin; t < end; ++t )
		{
			std::array<std::uint32_t, 3>& corner = triangles[t];
			corner = { corner[0] + vertices, corner[1] + vertices, corner[2] + vertices };
		}
	} );
	m_count += inner.m_count;
	m_normalGroups += inner.m_normalGroups;
}

/// Looks up where the numbers of each vertex's side begin; kNone: spared. `patch`: index in m_patch.
void CrackGatherer::lookUpSides( std::size_t patch )
{
	const CrackPatches& patches = m_sides->patches();
	const bool mayBeSpared = isOuter( patch ) && m_sides->panels().arePlaced();
	m_local.clear();
	for ( std::uint32_t v = patches.patch[m_patch[patch]].firstVertex; v < patches.patch[m_patch[patch] + 1].firstVertex; ++v )
	{
		const bool isSpared = mayBeSpared && m_sides->panels().isSpared( patches.appearance[v].point );
		m_local.push_back( isSpared ? kNone : patches.numbersOfSlot[m_sides->sideOf( patches.vertex[v].slot )] );
	}
}

/// `local`: by vertex of the patch, start of its side's numbers on input, its index in the body on output; kNone: spared. Branch-free: each
/// triangle is written, and counted if it is drawn.
std::array<std::uint32_t, 3>* CrackGatherer::takePatch( std::uint32_t patch, std::uint32_t* local, std::array<std::uint32_t, 3>* triangles )
{
	const CrackPatches& patches = m_sides->patches();
	const std::uint32_t first = patches.patch[patch].firstVertex, count = verticesOf( patch );
	for ( std::uint32_t k = 0; k < count; ++k )
	{
		if ( local[k] == kNone )
		{
			continue;
		}
		const CrackPatches::Vertex& of = patches.vertex[first + k];
		if ( of.isUnshared != 0 )
		{
			m_row.push_back( { m_count, of.slot, 0 } );
			local[k] = addVertex( first + k, m_count, m_normalGroups++ );
		}
		else
		{
			local[k] = numberOf( first + k, m_number.data() + local[k] );
		}
	}
	const bool isOfOuter = patch < patches.complex->cellCount(); // its triangles then have the complex's indices
	for ( std::uint32_t t = patches.patch[patch].firstTriangle; t < patches.patch[patch + 1].firstTriangle; ++t )
	{
		const auto& corner = patches.triangle[t];
		*triangles = { local[corner[0]], local[corner[1]], local[corner[2]] };
		triangles += isOfOuter && m_sides->panels().isOfOne( t ) ? 0 : 1;
	}
	return triangles;
}

std::uint32_t CrackGatherer::addVertex( std::uint32_t vertex, std::uint32_t carrier, std::uint32_t normalGroup )
{
	m_made[m_count] = { vertex, carrier, normalGroup };
	return m_count++;
}

/// `known`: the numbers of the vertex's side. Vertices of one side share a normal: one for the outer, one for the inner ones. Without noise
/// the inner ones are faces of cubes, and each has its own normal.
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
			if ( m_cells == 0 )
			{
				m_sharedRow.push_back( { std::uint32_t( m_row.size() ), std::uint32_t( &known[Carrier] - m_number.data() ) } );
			}
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

/// Adds the areas of an outer patch; intact panels are added after all patches.
void CrackGatherer::addAreas( std::uint32_t patch, const std::uint32_t* local )
{
	const CrackPatches& patches = m_sides->patches();
	const std::uint32_t first = patches.patch[patch].firstVertex;
	const auto pointOf = [&]( std::uint32_t k ) { return patches.appearance[first + k].point; };
	const auto groupOf = [&]( std::uint32_t k ) { return m_made[local[k]].normalGroup; };
	bool isReshaded = false;
	for ( std::uint32_t k = 0; k < verticesOf( patch ) && !isReshaded; ++k )
	{
		isReshaded = m_sides->isReshaded( pointOf( k ) );
	}
	m_area.resize( m_normalGroups, Vec3::Zero() );
	for ( std::uint32_t t = patches.patch[patch].firstTriangle; isReshaded && t < patches.patch[patch + 1].firstTriangle; ++t )
	{
		if ( !m_sides->panels().isOfOne( t ) ) // triangles of outer patches have the complex's indices
		{
			const auto& c = patches.triangle[t];
			addArea( { pointOf( c[0] ), pointOf( c[1] ), pointOf( c[2] ) }, { groupOf( c[0] ), groupOf( c[1] ), groupOf( c[2] ) } );
		}
	}
}

/// Lists the placed vertices of an outer patch (those from `firstNew` on) and its triangles that contribute to normals. Branch-free: each
/// is written, and counted if it qualifies.
void CrackGatherer::takeOuter( std::uint32_t patch, const std::uint32_t* local, std::uint32_t firstNew )
{
	const CrackPatches& patches = m_sides->patches();
	const IntactPanels& panels = m_sides->panels();
	const std::uint32_t first = patches.patch[patch].firstVertex, count = verticesOf( patch );
	std::uint32_t* placed = m_placed.get() + m_placedCount;
	for ( std::uint32_t k = 0; k < count; ++k )
	{
		const unsigned isNew = local[k] >= firstNew && local[k] != kNone ? 1u : 0u,
					   isPlaced = panels.isPlaced( patches.appearance[first + k].point ) ? 1u : 0u;
		*placed = local[k];
		placed += isNew & isPlaced;
	}
	m_placedCount = std::size_t( placed - m_placed.get() );
	std::array<std::uint32_t, 3>* shading = m_shading.get() + m_shadingCount;
	for ( std::uint32_t t = patches.patch[patch].firstTriangle; t < patches.patch[patch + 1].firstTriangle; ++t )
	{
		const auto& c = patches.triangle[t];
		*shading = { local[c[0]], local[c[1]], local[c[2]] };
		shading += panels.isOfOne( t ) ? 0 : 1;
	}
	m_shadingCount = std::size_t( shading - m_shading.get() );
	m_outerTriangles = std::uint32_t( m_shadingCount ); // equal so far
}

void CrackGatherer::addArea( const std::array<std::uint32_t, 3>& points, const std::array<std::uint32_t, 3>& normalGroups )
{
	const Vec3& a = m_sides->positionOf( points[0] );
	const Vec3 area = ( m_sides->positionOf( points[1] ) - a ).cross( m_sides->positionOf( points[2] ) - a );
	for ( const std::uint32_t group : normalGroups )
	{
		m_area[group] += area;
	}
}

} // namespace pliant
