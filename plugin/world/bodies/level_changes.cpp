// Levels of detail in a world: nodes are split and merged at the start of a substep, and everything that refers to them is updated.

#include "body/levels/levels.h"
#include "threads/parallel.h"
#include "world/bodies/soft_body_impl.h"
#include "world/step/soft_body_system.h"
#include "world/stopwatch.h"

#include <LinearMath/btQuickprof.h>

#include <algorithm>
#include <cassert>
#include <functional>

namespace pliant {

namespace {

using Near = SoftBody::Impl::Near;

/// Transfers pins: all children of a split node are pinned; a merged node takes the pin of the first of its children.
void movePins( SoftBody::Impl& impl, const LevelChange& change, const std::vector<btVector3>& positionBefore )
{
	if ( impl.pins.empty() )
	{
		return;
	}
	std::vector<Pin> moved;
	for ( int node = 0; node < impl.body->nodeCount(); ++node )
	{
		const int before = int( change.source[std::size_t( node )] );
		const Pin* pin = impl.findPin( before );
		if ( !pin || impl.body->nodes().freedom[node] != 0.0f )
		{
			continue;
		}
		Pin now = *pin;
		now.node = node;
		if ( change.keptAs[std::size_t( before )] == kNoNode )
		{
			const btVector3 arm = impl.position( node ) - positionBefore[std::size_t( pin - impl.pins.data() )];
			now.point += pin->kind == PinKind::FollowsBody ? pin->body->getWorldTransform().getBasis().transpose() * arm : arm;
		}
		moved.push_back( now );
	}
	impl.pins = std::move( moved );
}

/// Returns true if the body has been slow for a while, not just at the turning point of an impact.
bool isCalm( const SoftBody::Impl& impl )
{
	return impl.slowTime >= kAllowanceCalmFor;
}

/// Returns true if a node with deformation gradient F stores more than kSplitEnergy of the body's kinetic energy: V E e^2 > kSplitEnergy m
/// v^2, e = | F^T F - 1 | / 2. The children of a split node may store a different energy where the deformation is not quadratic: 13 % more
/// in a block split at the turning point of a fall onto its corner.
bool isLoaded( const SoftBody::Impl& impl, int node, const Eigen::Matrix3f& f )
{
	const Body& body = *impl.body;
	const double strain = 0.5 * double( ( f.transpose() * f - Eigen::Matrix3f::Identity() ).norm() );
	const double volume = double( body.nodes().mass[node] ) / double( body.material().density );
	return volume * double( body.material().youngsModulus ) * strain * strain > kSplitEnergy * impl.mass * impl.meanSquareSpeed;
}

} // namespace

void SoftBodySystem::requestContactSplits( SoftBody::Impl& impl )
{
	const Levels& levels = *impl.body->levels();
	// An implicit body's impact takes a single step, so its splits cannot wait.
	const bool waits = !impl.isImplicit && !isCalm( impl );
	m_contactNodes.clear();
	const auto request = [&]( int node, bool mayWait ) {
		if ( mayWait && waits && levels.levelOf( node ) > 0 )
		{
			m_contactNodes.push_back( std::uint32_t( node ) );
			return;
		}
		impl.body->requestSplit( node );
	};
	for ( const ContactProxy* proxy : impl.touched )
	{
		request( proxy->node, true );
	}
	for ( const Near& near : impl.nearNodes )
	{
		near.request == Near::Request::Keep ? impl.body->keepNode( near.node )
											: request( near.node, near.request == Near::Request::SplitLater );
	}
	impl.nearNodes.clear();
	if ( m_contactNodes.empty() )
	{
		return;
	}
	// All nodes in one call, because it computes sums over the whole body. Sorted, because contacts have no order.
	std::sort( m_contactNodes.begin(), m_contactNodes.end() );
	m_contactNodes.erase( std::unique( m_contactNodes.begin(), m_contactNodes.end() ), m_contactNodes.end() );
	m_stretches.resize( 9 * m_contactNodes.size() );
	impl.body->nodeDeformationsOf( m_contactNodes, m_stretches.data() );
	for ( std::size_t k = 0; k < m_contactNodes.size(); ++k )
	{
		const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> f( m_stretches.data() + 9 * k );
		const int node = int( m_contactNodes[k] );
		isLoaded( impl, node, f ) ? impl.body->keepNode( node ) : impl.body->requestSplit( node );
	}
}

void SoftBodySystem::adaptLevels( btScalar h )
{
	BT_PROFILE( "pliant: levels" );
	std::vector<SoftBody*> changing;
	for ( SoftBody* body : m_awake )
	{
		SoftBody::Impl& impl = body->impl();
		const Levels* levels = impl.body->levels();
		if ( !levels )
		{
			continue;
		}
		Stopwatch watch( report.levels );
		if ( levels->settings().refinesOnContact )
		{
			requestContactSplits( impl );
		}
		if ( impl.body->reviewLevels( float( h ) ) )
		{
			changing.push_back( body );
		}
	}
	if ( changing.empty() )
	{
		return;
	}
	// Changes of different bodies are independent. Many bodies: one task each; few: the threads share a body. Results are bit-identical.
	Stopwatch watch( report.levels );
	const bool oneTaskEach = int( changing.size() ) >= tasks()->threadCount();
	std::vector<std::vector<Vec3>> positionsBefore( changing.size() ); // of bodies with isGuarded
	auto change = [&]( int k ) {
		SoftBody::Impl& impl = changing[std::size_t( k )]->impl();
		TaskRunner* const within = oneTaskEach ? nullptr : tasks();
		for ( int i = 0; impl.isGuarded && i < impl.body->nodeCount(); ++i )
		{
			positionsBefore[std::size_t( k )].push_back( impl.body->nodes().x.get( i ) );
		}
		impl.changeNodes( *changing[std::size_t( k )], [&impl, within] { impl.body->applyLevels( within ); } );
	};
	runTasks( oneTaskEach ? tasks() : nullptr, int( changing.size() ), change );
	for ( std::size_t k = 0; k < changing.size(); ++k )
	{
		SoftBody* const body = changing[k];
		if ( body->impl().isGuarded )
		{
			keepNewNodesOut( *body, positionsBefore[k] );
		}
		const LevelChange& done = body->impl().body->levels()->lastChange();
		++report.levelChanges;
		report.splits += done.splits;
		report.merges += done.merges;
	}
}

// During an impact allowances do not decay: pushing the new nodes out would add energy.
void SoftBodySystem::endCollision( btScalar h )
{
	for ( SoftBody* body : m_bodies )
	{
		SoftBody::Impl& impl = body->impl();
		if ( impl.allowance.isAny() && moves( *body ) && isInPass( *body ) && !impl.rigidProxy )
		{
			impl.allowance.endPhase( isCalm( impl ) ? kAllowanceOut * double( impl.shape->smallestRadius() ) * double( h ) : 0.0 );
		}
	}
}

// Contacts of removed nodes are dropped in the next collision phase, before anything else reads them.
void SoftBody::Impl::changeNodes( SoftBody& owner, const std::function<void()>& change, bool fades )
{
	nearNodes.clear();
	std::vector<btVector3> positionBefore;
	for ( const Pin& pin : pins )
	{
		positionBefore.push_back( position( pin.node ) );
	}
	if ( fades )
	{
		keepSurface();
	}
	if ( system )
	{
		system->attachments.noteChange( owner );
	}
	change();
	const LevelChange& done = body->levels()->lastChange();
	movePins( *this, done, positionBefore );
	if ( system )
	{
		system->attachments.follow( owner, done.keptAs );
		system->frames.follow( owner, system->world() );
	}
	shape->followLevels( *body, shapeShift, !fades ); // before links break; adopt() moves the shape afterwards
	ContactProxyPool::renumber( owner, done.keptAs, body->nodeCount() );
	allowance.follow( done.keptAs, body->nodeCount() );
	if ( self )
	{
		self->search.renumber( done.keptAs );
	}
	if ( fades )
	{
		fadeFromKeptSurface();
	}
	else
	{
		skin.nodesChanged();
		skin.blend ? skin.blend->kept.renumber( done.source ) : void();
	}
}

int SoftBody::nodeLevel( int node ) const
{
	assert( m_impl->hasNode( node ) );
	const Levels* levels = m_impl->body->levels();
	return levels && m_impl->hasNode( node ) ? levels->levelOf( node ) : 0;
}

Adaptivity SoftBody::adaptivity() const
{
	const Levels* levels = m_impl->body->levels();
	return levels ? levels->settings() : Adaptivity{};
}

unsigned SoftBody::levelVersion() const
{
	const Levels* levels = m_impl->body->levels();
	return levels ? levels->version() + m_impl->versionShift : 0u;
}

void SoftBody::requestRefinement( const btVector3& low, const btVector3& high )
{
	if ( !m_impl->body->levels() || !isFinite( low ) || !isFinite( high ) || m_impl->isInField() )
	{
		return;
	}
	for ( int i = 0; i < nodeCount(); ++i )
	{
		const btVector3 p = nodePosition( i );
		const btScalar r = nodeRadius( i );
		const bool isOutside = p.x() + r < low.x() || p.y() + r < low.y() || p.z() + r < low.z() || p.x() - r > high.x() ||
			p.y() - r > high.y() || p.z() - r > high.z();
		if ( !isOutside )
		{
			m_impl->body->requestSplit( i );
		}
	}
}

void SoftBody::setFinestLevel( int level )
{
	if ( m_impl->isInField() )
	{
		return;
	}
	m_impl->body->setFinestLevel( std::clamp( level, 0, adaptivity().coarseLevels ) );
}

int SoftBody::finestLevel() const
{
	const Levels* levels = m_impl->body->levels();
	return levels ? levels->finestLevel() : 0;
}

} // namespace pliant
