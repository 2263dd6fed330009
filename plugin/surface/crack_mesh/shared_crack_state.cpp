#include "surface/crack_mesh/shared_crack_state.h"

#include "lattice/assert_valid.h"

#include <algorithm>
#include <numeric>

namespace pliant {

// The view of the whole body is made and dropped: its gatherer keeps the memory for all views.
void SharedCrackState::prepare()
{
	const std::lock_guard<std::mutex> lock( m_mutex );
	if ( m_gatherer.empty() )
	{
		m_path = std::make_unique<BladePath>( m_sides.patches().complex );
		std::vector<std::uint32_t> all( m_sides.complex().cellCount() );
		std::iota( all.begin(), all.end(), 0u );
		CrackView view;
		m_gatherer.push_back( std::make_unique<CrackGatherer>() );
		m_gatherer.back()->gather( m_sides, all, Vec3::Zero(), view );
	}
}

void SharedCrackState::breakLinks( const std::vector<CellLink>& links )
{
	m_pending.insert( m_pending.end(), links.begin(), links.end() );
}

void SharedCrackState::follow( const std::vector<CutTrace>& traces )
{
	m_newTraces.insert( m_newTraces.end(), traces.begin(), traces.end() );
}

void SharedCrackState::processBreaks( TaskRunner* runner )
{
	if ( !m_newTraces.empty() )
	{
		m_path = m_path ? std::move( m_path ) : std::make_unique<BladePath>( m_sides.patches().complex );
		m_sides.follow( *m_path, m_path->add( m_newTraces ) );
		m_newTraces.clear();
	}
	if ( !m_pending.empty() )
	{
		std::vector<std::uint32_t> faces;
		for ( const CellLink& link : m_pending )
		{
			if ( const std::uint32_t face = m_sides.complex().faceBetween( link.a, link.b ); face != CellComplex::kNone )
			{
				faces.push_back( face );
			}
		}
		m_sides.breakFaces( faces, runner );
		m_pending.clear();
	}
	assertValid( m_sides );
}

void SharedCrackState::show( const std::vector<std::uint32_t>& cells, const Vec3& shift, CrackView& view, TaskRunner* runner )
{
	std::unique_ptr<CrackGatherer> gatherer;
	{
		const std::lock_guard<std::mutex> lock( m_mutex );
		processBreaks( runner );
		if ( m_gatherer.empty() )
		{
			m_gatherer.push_back( std::make_unique<CrackGatherer>() );
		}
		gatherer = std::move( m_gatherer.back() );
		m_gatherer.pop_back();
	}
	gatherer->gather( m_sides, cells, shift, view, runner );
	const std::lock_guard<std::mutex> lock( m_mutex );
	m_gatherer.push_back( std::move( gatherer ) );
}

void SharedCrackState::catchUp( TaskRunner* runner )
{
	const std::lock_guard<std::mutex> lock( m_mutex );
	processBreaks( runner );
}

} // namespace pliant
