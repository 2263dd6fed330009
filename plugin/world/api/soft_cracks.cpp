// Cracks in the skin: the crack faces that are drawn, and the state kept for them.

#include "lattice/assert_valid.h"
#include "lattice/attempt.h"
#include "lattice/guarded_tasks.h"
#include "surface/crack_shapes/cell_owners.h"
#include "world/api/drawn_mesh.h"
#include "world/step/soft_body_system.h"

#include <algorithm>
#include <iterator>

namespace pliant {

namespace {

/// `first`, `second`: cells of the template.
bool isOpen( const Body& body, std::uint32_t first, std::uint32_t second )
{
	const std::uint32_t a = body.ownCell( first ), b = body.ownCell( second );
	return a == kNoNode || b == kNoNode || !areLinked( body.lattice(), a, b );
}

/// Returns the cuts whose links are still broken; healed ones do not shape crack faces.
std::vector<CutTrace> openCuts( const std::vector<CutTrace>& cuts, const Body& body )
{
	std::vector<CutTrace> open;
	std::copy_if( cuts.begin(), cuts.end(), std::back_inserter( open ),
		[&body]( const CutTrace& cut ) { return isOpen( body, cut.link.a, cut.link.b ); } );
	return open;
}

/// Returns the faces of a body's cells that have lost their link.
std::vector<std::uint32_t> openFaces( const CellComplex& complex, const Body& body )
{
	std::vector<std::uint32_t> open;
	for ( const std::uint32_t cell : body.firstCells() )
	{
		std::copy_if( complex.facesOfCell.begin( cell ), complex.facesOfCell.end( cell ), std::back_inserter( open ),
			[&]( std::uint32_t f ) { return complex.face[f].isLinked && isOpen( body, complex.face[f].cellA, complex.face[f].cellB ); } );
	}
	return open;
}

/// The body's mass centre relative to the template's, m.
Vec3 shiftOf( const SoftBody::Impl& impl )
{
	return ( impl.body->lattice().massCentre - impl.bodyTemplate->lattice().massCentre ).cast<float>();
}

} // namespace

bool SoftBody::Impl::hasNewCracks() const
{
	const bool isKnown = body->firstCells().empty() || ( crackView && crackVersion == fractureVersion );
	return !isKnown && bodyTemplate->crackPatches();
}

// Pieces of one body share their crack state if its skin was read before it broke. Otherwise cracks are drawn from each body's own links.
const SkinBinding& SoftBody::Impl::binding() const
{
	hasNewCracks() ? drawCracks() : void();
	static const SkinBinding none; // for a broken body whose cracks there is no memory to draw: the template's skin follows other nodes
	return crackView ? crackView->binding : body->firstCells().empty() ? bodyTemplate->skin() : none;
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
	crackFamily->catchUp( runner );
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
	if ( crackFamily )
	{
		crackFamily->show( body->firstCells(), shiftOf( *this ), *crackView, runner );
	}
	else
	{
		showOwnCracks( *this, bodyTemplate->crackPatches(), *crackView );
	}
	crackVersion = fractureVersion;
	skin.rigid.forget();
}

void showOwnCracks( const SoftBody::Impl& impl, const std::shared_ptr<const CrackPatches>& patches, CrackView& view )
{
	const Body& body = *impl.body;
	CrackSides sides( patches );
	if ( impl.cuts )
	{
		BladePath path( patches->complex );
		sides.follow( path, path.add( openCuts( *impl.cuts, body ) ) );
	}
	sides.breakFaces( openFaces( *patches->complex, body ) );
	assertValid( sides );
	CrackGatherer().gather( sides, body.firstCells(), shiftOf( impl ), view );
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
		crackFamily = std::make_shared<SharedCrackState>( bodyTemplate->crackPatches() );
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
