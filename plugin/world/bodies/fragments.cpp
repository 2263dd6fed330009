// Breaks bodies apart at the start of a substep: the heaviest part remains the original object, the others become bodies owned by the
// world. Ohta et al. 2009, "Fracturing".

#include "body/breaking.h"
#include "body/levels/levels.h"
#include "threads/parallel.h"
#include "world/bodies/soft_body_impl.h"
#include "world/step/soft_body_system.h"
#include "world/stopwatch.h"

#include <LinearMath/btQuickprof.h>

#include <algorithm>
#include <limits>

namespace pliant {

namespace {

/// Copies the settings of a collision object that a fragment inherits.
void copySettings( const SoftBody& from, SoftBody& to )
{
	to.setCollisionFlags( from.getCollisionFlags() );
	to.setFriction( from.getFriction() );
	to.setRestitution( from.getRestitution() );
	to.setRollingFriction( from.getRollingFriction() );
	to.setSpinningFriction( from.getSpinningFriction() );
	to.setContactStiffnessAndDamping( from.getContactStiffness(), from.getContactDamping() );
	to.setCollisionFlags( from.getCollisionFlags() ); // the line above sets one of them
	to.setContactProcessingThreshold( from.getContactProcessingThreshold() );
	to.setHitFraction( from.getHitFraction() );
	to.setCcdMotionThreshold( from.getCcdMotionThreshold() );
	to.setCcdSweptSphereRadius( from.getCcdSweptSphereRadius() );
	if ( from.hasAnisotropicFriction( btCollisionObject::CF_ANISOTROPIC_FRICTION ) )
	{
		to.setAnisotropicFriction( from.getAnisotropicFriction() );
	}
	if ( from.hasAnisotropicFriction( btCollisionObject::CF_ANISOTROPIC_ROLLING_FRICTION ) )
	{
		to.setAnisotropicFriction( from.getAnisotropicFriction(), btCollisionObject::CF_ANISOTROPIC_ROLLING_FRICTION );
	}
	to.setUserPointer( from.getUserPointer() );
	to.setUserIndex( from.getUserIndex() );
	to.setUserIndex2( from.getUserIndex2() );
	to.setUserIndex3( from.getUserIndex3() );
	const int state = from.getActivationState();
	to.forceActivationState( state == WANTS_DEACTIVATION ? ACTIVE_TAG : state ); // it has not been at rest itself
}

/// Returns the new index of each old node in the piece; kNoNode for nodes of other pieces.
std::vector<std::uint32_t> numbersNow( const BodyPiece& piece, int nodesBefore )
{
	std::vector<std::uint32_t> now( std::size_t( nodesBefore ), kNoNode );
	for ( std::size_t i = 0; i < piece.nodeBefore.size(); ++i )
	{
		now[piece.nodeBefore[i]] = std::uint32_t( i );
	}
	return now;
}

/// Returns the pins of the piece's nodes.
std::vector<Pin> pinsOf( const std::vector<Pin>& before, const std::vector<std::uint32_t>& nodeNow )
{
	std::vector<Pin> pins;
	for ( Pin pin : before )
	{
		if ( const std::uint32_t now = nodeNow[std::size_t( pin.node )]; now != kNoNode )
		{
			pin.node = int( now );
			pins.push_back( pin );
		}
	}
	std::sort( pins.begin(), pins.end(), []( const Pin& a, const Pin& b ) { return a.node < b.node; } );
	return pins;
}

} // namespace

SoftBody::Impl::Remains SoftBody::Impl::remainsOf( const BodyPiece& piece )
{
	Remains remains;
	remains.nodeNow = numbersNow( piece, body->nodeCount() );
	remains.keepsShape = shape->followCracks(
		*piece.body, remains.nodeNow, piece.nodeBefore, CollidersChange{ piece.treeBefore, piece.cellBefore, piece.touched } );
	remains.shape = remains.keepsShape ? nullptr : std::make_unique<NodeShape>( *piece.body );
	return remains;
}

// Contacts of lost nodes are removed in the next collision phase, before anything else reads them; until then their contact proxies need
// the spheres they were created with.
void SoftBody::Impl::adopt( SoftBody& owner, BodyPiece& piece, Remains remains )
{
	const std::vector<std::uint32_t>& nodeNow = remains.nodeNow;
	const bool keepsNodes = nodeNow.size() == piece.nodeBefore.size() &&
		std::find( nodeNow.begin(), nodeNow.end(), kNoNode ) == nodeNow.end();
	pins = pinsOf( pins, nodeNow );
	allowance = PenetrationAllowance::of( allowance, piece.nodeBefore );
	nearNodes.clear();
	if ( skin.blend )
	{
		skin.blend->kept.renumber( piece.nodeBefore, piece.body->lattice().massCentre - body->lattice().massCentre );
	}
	body = std::move( piece.body );
	const bool keepsNumbers = keepsNodes && std::is_sorted( nodeNow.begin(), nodeNow.end() );
	if ( !remains.keepsShape || !keepsNumbers )
	{
		ContactProxyPool::renumber( owner, nodeNow, body->nodeCount() );
	}
	if ( !remains.keepsShape )
	{
		previousShape = std::move( shape );
		shape = std::move( remains.shape );
		for ( ContactProxy* proxy : touched )
		{
			proxy->setCollisionShape( shape->sphereOfNode( proxy->node ) );
		}
	}
	remains.keepsShape ? placeSpheres( owner, body->measureMotion() ) : placeShape( owner );
	skin.fade.clear();
	skin.nodesChanged();
	if ( self )
	{
		self->search.relink( SelfSearch::CellsNow{ body->lattice(), piece.cellBefore, piece.touched } );
	}
	++fractureVersion;
}

std::unique_ptr<SoftBody> SoftBody::Impl::makeFragment( const SoftBody& parent, BodyPiece& piece )
{
	std::unique_ptr<SoftBody> soft( new SoftBody );
	soft->m_impl = std::make_unique<Impl>();
	Impl& impl = *soft->m_impl;
	const Impl& from = parent.impl();
	impl.bodyTemplate = from.bodyTemplate;
	impl.plan = from.plan;
	impl.elasticity = from.elasticity;
	impl.hasOwnGravity = from.hasOwnGravity;
	impl.allowance = PenetrationAllowance::of( from.allowance, piece.nodeBefore );
	impl.gravity = from.gravity;
	impl.hasNodeForces = from.hasNodeForces;
	impl.pins = pinsOf( from.pins, numbersNow( piece, from.body->nodeCount() ) );
	if ( from.skin.blend )
	{
		const Vec3d shift = piece.body->lattice().massCentre - from.body->lattice().massCentre;
		impl.skin.blend = std::make_unique<StepBlend>();
		impl.skin.blend->kept = from.skin.blend->kept.ofPiece( piece.nodeBefore, shift );
	}
	impl.body = std::move( piece.body );
	impl.fractureVersion = from.fractureVersion + 1;
	impl.crackFamily = from.crackFamily;
	impl.wasDrawn = from.isDrawn();
	impl.cuts = from.cuts;
	impl.skin.tolerance = from.skin.tolerance;
	impl.fading = from.fading;
	impl.isKept = from.isKept;
	impl.scale = from.scale;
	impl.forces = SurfaceForces::ofPiece( from.forces.get(), from.fractureVersion );
	impl.contactRecords = from.contactRecords ? std::make_unique<ContactRecords>() : nullptr;
	impl.follower = from.follower ? std::make_unique<PoseFollower>( *from.follower ) : nullptr;
	impl.self = from.self ? std::make_unique<SelfCollision>() : nullptr;
	const Fracture& settings = impl.body->fracture();
	if ( piece.isSmall && settings.smallPieces == SmallPieces::Fade && impl.fading.time == 0.0f )
	{
		impl.fading = Fading{ settings.fadeTime, double( settings.fadeTime ), false };
	}
	impl.finish( *soft );
	impl.centralForce = from.centralForce * btScalar( impl.mass / from.mass ); // distributed by mass
	copySettings( parent, *soft );
	return soft;
}

/// The result of breaking one body.
struct SoftBodySystem::Broken
{
	SoftBody* body;
	BreakReport report;
	std::vector<BodyPiece> pieces;
	std::vector<std::unique_ptr<SoftBody>> fragments; ///< by piece; null for the first, which is the body itself
	SoftBody::Impl::Remains remains;
};

bool SoftBodySystem::breakBodies()
{
	std::vector<Broken> broken;
	for ( SoftBody* body : m_awake )
	{
		const SoftBody::Impl& impl = body->impl();
		if ( impl.body->hasBrokenLinks() || ( impl.partsWait && partsNow( 0, 1 ) > 1 ) )
		{
			broken.push_back( {} );
			broken.back().body = body;
		}
	}
	if ( broken.empty() )
	{
		return false;
	}
	BT_PROFILE( "pliant: fracture" );
	Stopwatch watch( report.fracture );
	auto breakOne = [&]( int k ) {
		Broken& each = broken[std::size_t( k )];
		SoftBody::Impl& impl = each.body->impl();
		while ( impl.body->mustRefineToBreak() )
		{
			impl.changeNodes(
				*each.body, [&impl] { impl.body->refineToBreak(); }, false ); // no fade: adopt() would discard it
		}
		const int most = std::max( 1, impl.body->fracture().maxPieces - ( impl.family ? *impl.family - 1 : 0 ) );
		const int now = partsNow( k, int( broken.size() ) );
		attachments.noteChange( *each.body ); // breakApart leaves no positions
		each.pieces = impl.body->breakApart( each.report, std::min( most, now ) );
		impl.partsWait = !each.pieces.front().isOnePart && now < most;
	};
	runTasks( tasks(), int( broken.size() ), breakOne );
	for ( const Broken& each : broken )
	{
		each.body->impl().noteCracks( each.report );
	}
	makeFragments( broken );
	const std::size_t bodiesBefore = m_bodies.size(); // pieces come after them
	for ( Broken& each : broken )
	{
		settlePieces( each );
	}
	for ( std::size_t k = bodiesBefore; k < m_bodies.size(); ++k )
	{
		stiffen( *m_bodies[k] );
	}
	for ( const Broken& each : broken )
	{
		stiffen( *each.body );
	}
	return true;
}

// One task per piece, because building the spheres is expensive.
void SoftBodySystem::makeFragments( std::vector<Broken>& broken )
{
	struct Task
	{
		Broken* of;
		std::size_t piece;
	};
	std::vector<Task> pending;
	for ( Broken& each : broken )
	{
		each.fragments.resize( each.pieces.size() );
		for ( std::size_t k = 0; k < each.pieces.size(); ++k )
		{
			pending.push_back( { &each, k } );
		}
	}
	std::stable_sort( pending.begin(), pending.end(), []( const Task& a, const Task& b ) {
		return a.of->pieces[a.piece].cellBefore.size() > b.of->pieces[b.piece].cellBefore.size(); // longest tasks first
	} );
	auto make = [&pending]( int k ) {
		Broken& of = *pending[std::size_t( k )].of;
		const std::size_t piece = pending[std::size_t( k )].piece;
		if ( piece == 0 )
		{
			of.remains = of.body->impl().remainsOf( of.pieces[0] );
		}
		else
		{
			of.fragments[piece] = SoftBody::Impl::makeFragment( *of.body, of.pieces[piece] );
		}
	};
	runTasks( tasks(), int( pending.size() ), make );
}

void SoftBodySystem::claimFrames( Broken& broken )
{
	if ( frames.isEmpty() )
	{
		return;
	}
	frames.claim( *broken.body, *broken.body, broken.remains.nodeNow );
	for ( std::size_t k = 1; k < broken.fragments.size(); ++k )
	{
		frames.claim( *broken.body, *broken.fragments[k], numbersNow( broken.pieces[k], broken.body->nodeCount() ) );
	}
}

void SoftBodySystem::settlePieces( Broken& broken )
{
	SoftBody& body = *broken.body;
	SoftBody::Impl& impl = body.impl();
	FractureEvent event;
	event.parent = &body;
	event.links = broken.report.links;
	event.area = broken.report.area;
	event.energy = broken.report.energy;
	Eigen::Map<Vec3d>( event.point ) = impl.body->nodes().origin + broken.report.point;
	Eigen::Map<Vec3d>( event.normal ) = broken.report.normal;
	event.partingVelocity = broken.report.partingVelocity;
	event.removedPieces = broken.report.removedPieces;
	event.removedMass = broken.report.removedMass;
	if ( broken.pieces.size() > 1 && !impl.family )
	{
		impl.family = std::make_shared<int>( 1 );
	}
	const double massBefore = impl.mass;
	for ( std::size_t k = 1; k < broken.fragments.size() && !attachments.isEmpty(); ++k )
	{
		attachments.moveToPiece( body, *broken.fragments[k], numbersNow( broken.pieces[k], impl.body->nodeCount() ) );
	}
	claimFrames( broken );
	const std::vector<std::uint32_t> nodeNow = attachments.isEmpty() ? std::vector<std::uint32_t>() : broken.remains.nodeNow;
	impl.adopt( body, broken.pieces[0], std::move( broken.remains ) );
	attachments.followRemains( body, nodeNow );
	frames.settle( body, m_world );
	impl.centralForce *= btScalar( impl.mass / massBefore );
	for ( std::size_t k = 1; k < broken.fragments.size(); ++k )
	{
		event.fragments.push_back( broken.fragments[k].get() );
		addFragment( body, std::move( broken.fragments[k] ) );
	}
	report.brokenLinks += event.links;
	report.fragments += int( event.fragments.size() );
	report.removedPieces += event.removedPieces;
	if ( event.links > 0 || !event.fragments.empty() ) // otherwise links were only restored
	{
		events.push_back( std::move( event ) );
	}
}

void SoftBodySystem::addFragment( SoftBody& parent, std::unique_ptr<SoftBody> fragment )
{
	SoftBody* const piece = fragment.release();
	SoftBody::Impl& impl = piece->impl();
	impl.family = parent.impl().family;
	++*impl.family;
	ignoreAs( parent, *piece );
	const btBroadphaseProxy* const proxy = parent.getBroadphaseHandle();
	m_world.addCollisionObject( piece, proxy->m_collisionFilterGroup, proxy->m_collisionFilterMask );
	impl.isWorldOwned = true;
	impl.plan = planOf( *piece, m_gameStep, substepsOf( parent ) ); // a rigid piece of an implicit body steps explicitly
	impl.separatedAt = m_clock;
	owned.push_back( piece );
	m_piecesLeft = std::max( 0, m_piecesLeft - 1 );

	// The fragment inherits the parent's separated pairs with their slack, and is paired with the parent.
	impl.separatedPairs = parent.impl().separatedPairs;
	const SeparatedPair own{ parent.impl().serial, std::numeric_limits<double>::infinity() };
	impl.separatedPairs.insert( std::lower_bound( impl.separatedPairs.begin(), impl.separatedPairs.end(), own ), own );
	for ( const SeparatedPair& pair : impl.separatedPairs )
	{
		// m_bodies is sorted by serial, and this body's is the highest.
		const auto other = std::lower_bound( m_bodies.begin(), m_bodies.end(), pair.other,
			[]( const SoftBody* body, unsigned serial ) { return body->impl().serial < serial; } );
		if ( other != m_bodies.end() && ( *other )->impl().serial == pair.other )
		{
			( *other )->impl().separatedPairs.push_back( SeparatedPair{ impl.serial, pair.slack } );
		}
	}
	if ( group.contains( parent ) )
	{
		group.add( *piece );
	}
}

bool SoftBodySystem::release( SoftBody& fragment )
{
	const auto found = std::find( owned.begin(), owned.end(), &fragment );
	if ( found == owned.end() )
	{
		return false;
	}
	owned.erase( found );
	fragment.impl().isWorldOwned = false;
	return true;
}

void SoftBodySystem::advanceFading( btScalar gameStep )
{
	for ( SoftBody* body : m_bodies )
	{
		body->impl().fading.left -= double( gameStep );
	}
}

// Called between steps, when the pointers in the last step's events have expired.
void SoftBodySystem::removeFaded()
{
	removedSinceStep = 0;
	unsigned serial = 0;
	while ( SoftBody* const body = bodyAfter( serial ) )
	{
		SoftBody::Impl& impl = body->impl();
		serial = impl.serial;
		if ( impl.fading.time > 0.0f && impl.fading.left <= 0.0 && !impl.fading.isOver )
		{
			impl.fading.isOver = true;
			const bool isOurs = impl.isWorldOwned;
			m_world.removeCollisionObject( body );
			++removedSinceStep;
			if ( isOurs )
			{
				delete body;
			}
		}
	}
}

} // namespace pliant
