#include "surface/crack_family.h"

#include <algorithm>

namespace pliant {

CrackFamily::CrackFamily( const CrackSurface& whole, const float* texture ) : m_whole( whole ), m_input( texture )
{
	m_whole.makeRoom();
	m_cellNow.resize( m_whole.cells().size(), CrackSurface::kNone );
	catchUp();
}

void CrackFamily::breakLinks( const std::vector<CellLink>& links )
{
	m_pending.insert( m_pending.end(), links.begin(), links.end() );
}

void CrackFamily::follow( const std::vector<CutTrace>& traces )
{
	m_newTraces.insert( m_newTraces.end(), traces.begin(), traces.end() );
}

void CrackFamily::catchUp()
{
	if ( !m_newTraces.empty() )
	{
		m_path = m_path ? std::move( m_path ) : std::make_unique<BladePath>( m_whole.m_complex );
		m_whole.follow( *m_path, m_path->add( m_newTraces ) );
		m_newTraces.clear();
	}
	if ( !m_pending.empty() )
	{
		m_whole.breakLinks( m_pending );
		m_whole.settle();
		m_pending.clear();
	}
	const std::uint32_t known = std::uint32_t( m_texture.size() / 2 );
	if ( known < m_whole.vertexCount() )
	{
		m_texture.resize( 2 * std::size_t( m_whole.vertexCount() ) );
		m_whole.textureCoordinates( m_input, m_whole.complex().settings.textureTile, known, m_texture.data() + 2 * std::size_t( known ) );
		m_vertexMark.resize( m_whole.vertexCount(), 0 );
		m_vertexNow.resize( m_whole.vertexCount() );
		m_carrierMark.resize( m_whole.vertexCount(), 0 );
		m_carrierNow.resize( m_whole.vertexCount() );
		m_groupMark.resize( std::size_t( m_whole.binding().normalGroups ), 0 );
		m_groupNow.resize( std::size_t( m_whole.binding().normalGroups ) );
	}
}

void CrackFamily::show( const std::vector<std::uint32_t>& cells, const Vec3& shift, CrackView& view )
{
	const std::lock_guard<std::mutex> lock( m_mutex );
	catchUp();
	if ( cells.size() == m_whole.cells().size() )
	{
		showWhole( view );
		return;
	}
	for ( std::uint32_t k = 0; k < std::uint32_t( cells.size() ); ++k )
	{
		m_cellNow[cells[k]] = k;
	}
	gatherTriangles( cells, view );
	gatherVertices( shift, view );
	for ( const std::uint32_t cell : cells )
	{
		m_cellNow[cell] = CrackSurface::kNone;
	}
	view.binding = &view.ownBinding;
	view.triangles = view.ownTriangles.data();
	view.sources = view.ownSources.data();
	view.texture = view.ownTexture.data();
	view.triangleCount = int( view.ownTriangles.size() );
	view.change = {};
}

void CrackFamily::showWhole( CrackView& view ) const
{
	const bool isSame = view.binding == &m_whole.binding();
	view.change = isSame ? m_whole.latestChange() : CrackSurface::Change{};
	view.binding = &m_whole.binding();
	view.triangles = m_whole.triangles().data();
	view.sources = m_whole.sources().data();
	view.texture = m_texture.data();
	view.triangleCount = int( m_whole.triangles().size() );
}

void CrackFamily::gatherTriangle( std::uint32_t triangle, CrackView& view )
{
	std::array<std::uint32_t, 3> corner = m_whole.m_triangle[triangle];
	for ( std::uint32_t& v : corner )
	{
		if ( m_vertexMark[v] != m_round )
		{
			m_vertexMark[v] = m_round;
			m_vertexNow[v] = std::uint32_t( m_vertex.size() );
			m_vertex.push_back( v );
		}
		v = m_vertexNow[v];
	}
	view.ownTriangles.push_back( corner );
	view.ownSources.push_back( m_whole.m_source[triangle] );
}

void CrackFamily::gatherSides( std::uint32_t cell, CrackView& view )
{
	for ( std::uint32_t k = m_whole.m_cellFaceStart[cell]; k < m_whole.m_cellFaceStart[cell + 1]; ++k )
	{
		const CrackSurface::Face& face = m_whole.m_face[m_whole.m_cellFace[k]];
		const std::uint32_t first = face.cellA == cell ? face.firstA : face.firstB;
		if ( first != CrackSurface::kNone )
		{
			const CrackFace& known = m_whole.complex().face[face.number];
			for ( std::uint32_t t = first; t < first + known.lastTriangle - known.firstTriangle; ++t )
			{
				gatherTriangle( t, view );
			}
		}
	}
}

/// How many the cell draws.
std::size_t CrackFamily::trianglesOf( std::uint32_t cell ) const
{
	std::size_t count = m_whole.m_cellTriangle[cell + 1] - m_whole.m_cellTriangle[cell];
	for ( std::uint32_t k = m_whole.m_cellFaceStart[cell]; k < m_whole.m_cellFaceStart[cell + 1]; ++k )
	{
		const CrackSurface::Face& face = m_whole.m_face[m_whole.m_cellFace[k]];
		const CrackFace& known = m_whole.complex().face[face.number];
		count += face.isBroken ? known.lastTriangle - known.firstTriangle : 0;
	}
	return count;
}

void CrackFamily::gatherTriangles( const std::vector<std::uint32_t>& cells, CrackView& view )
{
	++m_round;
	m_vertex.clear();
	view.ownTriangles.clear();
	view.ownSources.clear();
	std::size_t triangles = 0;
	for ( const std::uint32_t cell : cells )
	{
		triangles += trianglesOf( cell );
	}
	view.ownTriangles.reserve( triangles );
	view.ownSources.reserve( triangles );
	for ( const std::uint32_t cell : cells )
	{
		for ( std::uint32_t t = m_whole.m_cellTriangle[cell]; t < m_whole.m_cellTriangle[cell + 1]; ++t )
		{
			gatherTriangle( t, view );
		}
	}
	for ( const std::uint32_t cell : cells )
	{
		gatherSides( cell, view );
	}
}

// Rows lose what weighs nothing: it is at their ends.
void CrackFamily::gatherVertices( const Vec3& shift, CrackView& view )
{
	const SkinBinding& from = m_whole.binding();
	SkinBinding& to = view.ownBinding;
	const std::size_t count = m_vertex.size();
	to.kind = from.kind;
	to.normalGroups = 0;
	to.start.resize( count + 1 );
	to.restPosition.resize( count );
	to.restNormal.resize( count );
	to.normalShift.resize( count );
	to.normalGroup.resize( count );
	to.carrier.resize( count );
	view.ownTexture.resize( 2 * count );
	to.node.clear();
	to.weight.clear();
	const std::size_t likely = from.node.size() / ( from.restPosition.size() + 1 ) * count;
	to.node.reserve( likely );
	to.weight.reserve( likely );
	for ( std::size_t k = 0; k < count; ++k )
	{
		const std::uint32_t v = m_vertex[k], group = from.normalGroup[v];
		if ( m_groupMark[group] != m_round )
		{
			m_groupMark[group] = m_round;
			m_groupNow[group] = std::uint32_t( to.normalGroups++ );
		}
		to.normalGroup[k] = m_groupNow[group];
		to.restPosition[k] = from.restPosition[v] - shift;
		to.restNormal[k] = from.restNormal[v];
		to.normalShift[k] = from.normalShift[v];
		view.ownTexture[2 * k] = m_texture[2 * std::size_t( v )];
		view.ownTexture[2 * k + 1] = m_texture[2 * std::size_t( v ) + 1];
		to.start[k] = std::uint32_t( to.node.size() );
		const std::uint32_t carrier = from.carrier[v]; // of this side, whether the body draws it or not
		if ( m_carrierMark[carrier] == m_round )
		{
			to.carrier[k] = m_carrierNow[carrier];
			continue;
		}
		m_carrierMark[carrier] = m_round;
		m_carrierNow[carrier] = to.carrier[k] = std::uint32_t( k );
		float others = 0.0f; // weight of cells that other bodies have
		for ( std::uint32_t e = from.start[carrier]; e < from.start[carrier + 1] && from.weight[e] != 0.0f; ++e )
		{
			const std::uint32_t cell = m_cellNow[from.node[e]];
			if ( cell != CrackSurface::kNone )
			{
				to.node.push_back( cell );
				to.weight.push_back( from.weight[e] );
			}
			others += cell != CrackSurface::kNone ? 0.0f : from.weight[e];
		}
		// A cell that hardly carries a point (weights to 6e-5 have been seen) may come off without its side being asked anew: the rest carry all.
		for ( std::size_t e = to.start[k]; others > 0.0f && e < to.weight.size(); ++e )
		{
			to.weight[e] /= 1.0f - others;
		}
	}
	to.start[count] = std::uint32_t( to.node.size() );
}

} // namespace pliant
