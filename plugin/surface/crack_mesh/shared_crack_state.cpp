#include "surface/crack_mesh/shared_crack_state.h"

#include "lattice/assert_valid.h"
#include "surface/constants.h"

#include <algorithm>
#include <numeric>

namespace pliant {

SharedCrackState::SharedCrackState(
	const CrackSurface& whole, std::shared_ptr<const CrackPatches> patches, const float* texture, bool shatters ) :
	m_patches( std::move( patches ) ),
	m_unbroken( &whole ), m_input( texture ), m_shatters( shatters )
{}

// The view of the whole body is made and dropped: its gatherer keeps the memory for all views.
void SharedCrackState::prepare()
{
	const std::lock_guard<std::mutex> lock( m_mutex );
	if ( m_sides )
	{
		return;
	}
	if ( !m_shatters )
	{
		startGrowing();
		return;
	}
	m_path = std::make_unique<BladePath>( m_patches->complex );
	startSides( nullptr );
	std::vector<std::uint32_t> all( std::size_t( m_patches->complex->cellCount() ) );
	std::iota( all.begin(), all.end(), 0u );
	CrackView view;
	m_gatherer.push_back( std::make_unique<CrackGatherer>() );
	m_gatherer.back()->gather( *m_sides, all, Vec3::Zero(), view );
}

/// Passes from the growing surface, if there is one, to patches.
void SharedCrackState::startSides( TaskRunner* runner )
{
	m_sides = std::make_unique<CrackSides>( m_patches, m_whole ? *m_whole : *m_unbroken, runner );
	m_whole.reset();
	std::vector<float>().swap( m_texture );
}

/// Creates the growing surface, unless there is one or patches are used.
void SharedCrackState::startGrowing()
{
	if ( !m_whole && !m_sides )
	{
		m_whole = std::make_unique<CrackSurface>( *m_unbroken );
		m_whole->reserveScratch();
		updateTexture();
	}
}

void SharedCrackState::updateTexture()
{
	const std::size_t known = m_texture.size();
	m_texture.resize( 2 * std::size_t( m_whole->vertexCount() ) );
	m_whole->textureCoordinates( m_input, std::uint32_t( known / 2 ), m_texture.data() + known );
}

void SharedCrackState::breakLinks( const std::vector<CellLink>& links )
{
	m_pending.insert( m_pending.end(), links.begin(), links.end() );
}

void SharedCrackState::follow( const std::vector<CutTrace>& traces )
{
	m_newTraces.insert( m_newTraces.end(), traces.begin(), traces.end() );
}

std::vector<std::uint32_t> SharedCrackState::pendingFaces() const
{
	std::vector<std::uint32_t> faces;
	for ( const CellLink& link : m_pending )
	{
		if ( const std::uint32_t face = m_patches->complex->faceBetween( link.a, link.b ); face != CrackSurface::kNone )
		{
			faces.push_back( face );
		}
	}
	return faces;
}

/// `isWhole`: requested for all cells.
void SharedCrackState::processBreaks( bool isWhole, TaskRunner* runner )
{
	const std::vector<std::uint32_t> faces = pendingFaces();
	if ( !m_sides && ( m_shatters || !isWhole || faces.size() * kFewFaces > m_patches->complex->face.size() ) )
	{
		startSides( runner );
	}
	startGrowing();
	if ( !m_newTraces.empty() )
	{
		m_path = m_path ? std::move( m_path ) : std::make_unique<BladePath>( m_patches->complex );
		const std::vector<std::uint32_t> points = m_path->add( m_newTraces );
		m_whole ? m_whole->follow( *m_path, points ) : m_sides->follow( *m_path, points );
		m_newTraces.clear();
	}
	if ( !m_pending.empty() )
	{
		m_whole ? m_whole->breakFaces( faces ) : m_sides->breakFaces( faces, runner );
		m_pending.clear();
	}
	if ( m_whole )
	{
		m_whole->updateBinding();
		updateTexture();
		assertValid( *m_whole );
	}
	else
	{
		assertValid( *m_sides );
	}
}

void SharedCrackState::show( const std::vector<std::uint32_t>& cells, const Vec3& shift, CrackView& view, TaskRunner* runner )
{
	std::unique_ptr<CrackGatherer> gatherer;
	{
		const std::lock_guard<std::mutex> lock( m_mutex );
		processBreaks( cells.size() == m_patches->complex->cellCount(), runner );
		if ( m_whole )
		{
			showWhole( view );
			return;
		}
		if ( m_gatherer.empty() )
		{
			m_gatherer.push_back( std::make_unique<CrackGatherer>() );
		}
		gatherer = std::move( m_gatherer.back() );
		m_gatherer.pop_back();
	}
	gatherer->gather( *m_sides, cells, shift, view, runner );
	const std::lock_guard<std::mutex> lock( m_mutex );
	m_gatherer.push_back( std::move( gatherer ) );
}

void SharedCrackState::catchUp( std::size_t cells, TaskRunner* runner )
{
	const std::lock_guard<std::mutex> lock( m_mutex );
	processBreaks( cells == m_patches->complex->cellCount(), runner );
}

void SharedCrackState::showWhole( CrackView& view ) const
{
	const bool isSame = view.binding == &m_whole->binding();
	view.change = isSame ? m_whole->latestChange() : CrackSurface::Change{};
	view.binding = &m_whole->binding();
	view.triangles = m_whole->triangles().data();
	view.sources = m_whole->sources().data();
	view.texture = m_texture.data();
	view.triangleCount = int( m_whole->triangles().size() );
	view.growing = m_whole.get();
}

} // namespace pliant
