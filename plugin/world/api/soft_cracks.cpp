// Cracks in the skin: the crack faces that are drawn, and the state kept for them.

#include "lattice/attempt.h"
#include "lattice/guarded_tasks.h"
#include "surface/crack_shapes/cell_owners.h"
#include "world/api/drawn_mesh.h"
#include "world/step/soft_body_system.h"

#include <algorithm>

namespace pliant {

namespace {

/// Returns the cuts whose links are still broken; healed ones do not shape crack faces.
std::vector<CutTrace> openCuts( const std::vector<CutTrace>& cuts, const Body& body )
{
	std::vector<CutTrace> open;
	for ( const CutTrace& cut : cuts )
	{
		const std::uint32_t a = body.ownCell( cut.link.a ), b = body.ownCell( cut.link.b );
		if ( a == kNoNode || b == kNoNode || !areLinked( body.lattice(), a, b ) )
		{
			open.push_back( cut );
		}
	}
	return open;
}

} // namespace

bool SoftBody::Impl::hasNewCracks() const
{
	const bool isKnown = body->firstCells().empty() || ( crackView && crackVersion == fractureVersion );
	return !isKnown && bodyTemplate->crackComplex();
}

// Pieces of one body share their crack state if its skin was read before it broke. Otherwise cracks are drawn from each body's own links.
const SkinBinding& SoftBody::Impl::binding() const
{
	if ( !hasNewCracks() )
	{
		return crackView ? *crackView->binding : bodyTemplate->skin();
	}
	drawCracks();
	return *crackView->binding;
}

// The skins of pieces of the same body are usually read next, so with several threads the cracks of all are drawn at once.
void SoftBody::Impl::drawFamilyCracks() const
{
	TaskRunner* const runner = system ? system->tasks() : nullptr;
	if ( !crackFamily || !runner || runner->threadCount() < 2 )
	{
		return;
	}
	std::vector<const Impl*> siblings;
	std::size_t cells = 0;
	for ( const SoftBody* soft : system->bodies() )
	{
		const Impl& other = soft->impl();
		if ( other.crackFamily == crackFamily && ( &other == this || other.isDrawn() ) && other.hasNewCracks() )
		{
			siblings.push_back( &other );
			cells += other.body->firstCells().size();
		}
	}
	std::stable_sort( siblings.begin(), siblings.end(),
		[]( const Impl* a, const Impl* b ) { return a->body->firstCells().size() > b->body->firstCells().size(); } );
	crackFamily->catchUp( siblings.front()->body->firstCells().size(), runner );
	// Bodies with more cells than the mean per thread are drawn one after another by all threads together.
	auto next = siblings.begin();
	for ( ; next != siblings.end() && ( *next )->body->firstCells().size() * std::size_t( runner->threadCount() ) > cells; ++next )
	{
		( *next )->drawCracks( runner );
	}
	auto draw = [&next]( int k ) { next[k]->drawCracks(); };
	runGuarded( runner, int( siblings.end() - next ), draw );
}

void SoftBody::Impl::drawCracks( TaskRunner* runner ) const
{
	crackView = crackView ? std::move( crackView ) : std::make_unique<CrackView>();
	crackView->wantsKinds = skin.vertexData != nullptr;
	if ( crackFamily )
	{
		const Vec3 shift = ( body->lattice().massCentre - bodyTemplate->lattice().massCentre ).cast<float>();
		crackFamily->show( body->firstCells(), shift, *crackView, runner );
	}
	else
	{
		showOwnCracks();
	}
	crackVersionBefore = crackVersion;
	crackVersion = fractureVersion;
	skin.rigid.forget();
}

void SoftBody::Impl::wantKinds() const
{
	skin.vertexData = skin.vertexData ? std::move( skin.vertexData ) : std::make_unique<VertexData>();
	if ( shownCracks() && !crackView->hasKinds() )
	{
		const unsigned before = crackVersionBefore;
		drawCracks(); // again: the same
		crackVersionBefore = before;
	}
}

void SoftBody::Impl::showOwnCracks() const
{
	pliant::showOwnCracks( *this, bodyTemplate->crackComplex(), bodyTemplate->textureCoordinates(), *crackView );
}

void showOwnCracks( const SoftBody::Impl& impl, const std::shared_ptr<const CellComplex>& complex, const float* texture, CrackView& view )
{
	const Body& body = *impl.body;
	const Vec3 shift = ( body.lattice().massCentre - impl.bodyTemplate->lattice().massCentre ).cast<float>();
	CrackSurface cracks( complex, body.firstCells(), body.lattice(), shift );
	if ( impl.cuts )
	{
		BladePath path( complex );
		cracks.follow( path, path.add( openCuts( *impl.cuts, body ) ) );
	}
	std::vector<float> coordinates( 2 * std::size_t( cracks.vertexCount() ) );
	cracks.textureCoordinates( texture, 0, coordinates.data() );
	cracks.showPanelsAsOne( coordinates.data(), view );
}

/// All pieces of one body share the cuts, so that both sides of a crack draw a point at the same position.
void SoftBody::Impl::noteCuts()
{
	if ( !newCuts.empty() )
	{
		cuts = cuts ? std::move( cuts ) : std::make_shared<std::vector<CutTrace>>();
		cuts->insert( cuts->end(), newCuts.begin(), newCuts.end() );
		if ( crackFamily )
		{
			crackFamily->follow( newCuts );
		}
		newCuts.clear();
	}
}

void SoftBody::Impl::noteTraces( std::vector<CutTrace> traces, const Vec3& shift )
{
	const std::vector<std::uint32_t>& first = body->firstCells();
	for ( CutTrace& trace : traces )
	{
		trace.link = first.empty() ? trace.link : CellLink{ first[trace.link.a], first[trace.link.b] };
		trace.point += shift;
		newCuts.push_back( trace );
	}
}

void SoftBody::Impl::makeSharedCrackState()
{
	if ( !crackFamily && body->firstCells().empty() && bodyTemplate->crackPatches() )
	{
		crackFamily = std::make_shared<SharedCrackState>( *bodyTemplate->crackSurface(), bodyTemplate->crackPatches(),
			bodyTemplate->textureCoordinates(), body->fracture().rule == BreakRule::Shards );
	}
}

Status SoftBody::prepareCracks()
{
	return withinMemory( "Not enough memory for the body's crack surfaces.", [&]() {
		insist( m_impl->checkTime( "prepareCracks" ) );
		m_impl->makeSharedCrackState();
		if ( m_impl->crackFamily )
		{
			m_impl->crackFamily->prepare();
		}
		m_impl->body->prepareToBreak();
	} );
}

void SoftBody::Impl::noteCracks( const BreakReport& report )
{
	const std::vector<std::uint32_t>& first = body->firstCells();
	if ( skin.isRead() )
	{
		makeSharedCrackState();
	}
	if ( bodyTemplate->skin().kind != Skinning::None )
	{
		noteTraces( report.traces, -bodyTemplate->lattice().massCentre.cast<float>() );
	}
	noteCuts();
	if ( report.hasHealed )
	{
		crackFamily.reset(); // its cracks do not close
	}
	if ( crackFamily )
	{
		std::vector<CellLink> links = report.broken;
		for ( CellLink& link : links )
		{
			link = first.empty() ? link : CellLink{ first[link.a], first[link.b] };
		}
		crackFamily->breakLinks( links );
	}
}

} // namespace pliant
