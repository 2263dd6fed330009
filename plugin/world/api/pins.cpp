// Nodes that forces do not move: fixed, following a rigid body, driven by the game, and those of static and kinematic bodies.

#include "lattice/attempt.h"
#include "matching/constants.h"
#include "matching/rotation.h"
#include "world/bodies/placing.h"
#include "world/step/soft_body_system.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <iterator>

namespace pliant {

Pin* SoftBody::Impl::findPin( int node )
{
	const auto found = std::lower_bound( pins.begin(), pins.end(), node, []( const Pin& pin, int n ) { return pin.node < n; } );
	return found != pins.end() && found->node == node ? &*found : nullptr;
}

namespace {

const char* const kPinCalls[] = { "pinNode", "pinNodeToBody", "driveNode" }; // by PinKind

} // namespace

Status SoftBody::pin( const PinRequest& request )
{
	return attempt( [&]() {
		rejectIf( !m_impl->hasNode( request.node ), "pinNode", "there is no node of this number." ); // the others have looked
		insist( m_impl->checkTime( kPinCalls[request.kind] ) );
		Impl& impl = *m_impl;
		Pin* pin = impl.findPin( request.node );
		if ( !pin )
		{
			const auto slot = std::lower_bound(
				impl.pins.begin(), impl.pins.end(), request.node, []( const Pin& p, int n ) { return p.node < n; } );
			pin = &*impl.pins.insert( slot, Pin{} );
		}
		pin->node = request.node;
		pin->kind = PinKind( request.kind );
		pin->body = request.body;
		pin->bodyIndex = request.body ? request.body->getWorldArrayIndex() : -1;
		pin->bodyProxy = request.body ? request.body->getBroadphaseHandle()->getUid() : -1;
		pin->point = request.point;
		pin->hasTarget = pin->kind == PinKind::Driven;
		impl.body->setPinned( request.node, true );
		impl.mustDeform = true;
		impl.body->nodes().v.set( request.node, Vec3::Zero() );
		impl.system ? impl.system->equationsChanged( *this ) : void();
		activate( true );
	} );
}

Status SoftBody::pinNode( int node )
{
	return pin( PinRequest{ node, int( PinKind::Still ), nullptr, btVector3( 0, 0, 0 ) } );
}

// A pin keeps a pointer to its rigid body, so it must be released before that body is deleted. The world does this when the rigid body is
// removed, so both bodies must be in the same world. If this body is in no world, the pin is checked again when the body is added.
Status SoftBody::pinNodeToBody( int node, btRigidBody* body )
{
	return attempt( [&]() {
		rejectIf( !body || !m_impl->hasNode( node ), ResultCode::BadArgument, "pinNodeToBody needs a node and a rigid body." );
		int index = body->getWorldArrayIndex();
		rejectIf( !body->getBroadphaseHandle() || index < 0, "pinNodeToBody",
			"the rigid body is in no world. Add it first; the pin goes when it is removed." );
		rejectIf( m_impl->system && !m_impl->system->holds( body, index ), "pinNodeToBody",
			"the rigid body is in another world than the soft body." );
		rejectIf( !isFinite( body->getWorldTransform() ), "pinNodeToBody", "the rigid body's transform is not finite." );
		return pin( PinRequest{ node, int( PinKind::FollowsBody ), body, body->getWorldTransform().invXform( nodePosition( node ) ) } );
	} );
}

Status SoftBody::driveNode( int node, const btVector3& worldPosition )
{
	return attempt( [&]() {
		rejectIf( !m_impl->hasNode( node ), "driveNode", "there is no node of this number." );
		insist( checkVector( worldPosition, "driveNode", "the position" ) );
		const double distance = ( toVec3d( worldPosition ) - m_impl->body->nodes().worldPosition( node ) ).norm();
		rejectIf( distance > m_impl->farthestDrive(), "driveNode",
			"the position is more than 100 times the body's size from the node; teleport the body, or move the node in steps." );
		return pin( PinRequest{ node, int( PinKind::Driven ), nullptr, worldPosition } );
	} );
}

double SoftBody::Impl::farthestDrive() const
{
	btVector3 low, high;
	shape->getAabb( btTransform::getIdentity(), low, high );
	return std::min( kFarthestDrive * double( ( high - low ).length() ), 0.5 * double( kSpeedLimit ) * double( kNominalStep ) );
}

void SoftBody::releaseNode( int node )
{
	Impl& impl = *m_impl;
	if ( Pin* const found = impl.isInField() ? nullptr : impl.findPin( node ) )
	{
		impl.pins.erase( impl.pins.begin() + ( found - impl.pins.data() ) );
		impl.body->setPinned( node, false );
		impl.mustDeform = true;
		impl.system ? impl.system->equationsChanged( *this ) : void();
		activate( true );
	}
}

int SoftBody::pinNodesInside( const btVector3& low, const btVector3& high )
{
	int count = 0;
	for ( int i = 0; i < nodeCount() && isFinite( low ) && isFinite( high ); ++i )
	{
		const btVector3 p = nodePosition( i );
		const bool isInside = p.x() >= low.x() && p.y() >= low.y() && p.z() >= low.z() && p.x() <= high.x() && p.y() <= high.y() &&
			p.z() <= high.z();
		if ( isInside && pinNode( i ).ok() )
		{
			++count;
		}
	}
	return count;
}

bool SoftBody::isPinned( int node ) const
{
	return m_impl->findPin( node ) != nullptr;
}

void SoftBodySystem::releasePinsTo( const btRigidBody& body )
{
	for ( BlockSolve& solve : m_implicit )
	{
		solve.forget( body );
	}
	for ( SoftBody* soft : m_bodies )
	{
		std::vector<Pin>& pins = soft->impl().pins;
		for ( std::size_t k = pins.size(); k-- > 0; )
		{
			if ( pins[k].body == &body )
			{
				soft->releaseNode( pins[k].node );
			}
		}
	}
}

// Compares the pointer and the id of the broadphase proxy, which a world does not reuse: a rigid body may be created at the address of a
// deleted one.
void SoftBodySystem::releaseLostPins( SoftBody& body, bool isAdded )
{
	std::vector<Pin>& pins = body.impl().pins;
	for ( std::size_t k = pins.size(); k-- > 0; )
	{
		if ( pins[k].kind != PinKind::FollowsBody )
		{
			continue;
		}
		const bool isHere = holds( pins[k].body, pins[k].bodyIndex );
		if ( !isHere || ( isAdded && pins[k].body->getBroadphaseHandle()->getUid() != pins[k].bodyProxy ) )
		{
			body.releaseNode( pins[k].node );
		}
	}
}

// Kinematic bodies are already where the substep ends. Below 5e-4 rad a step Bullet gives them no angular velocity. A rotation R by h w
// takes the nodes along chords; the velocities less
//
//   B r / h,   B = R - 1 - [ h w ]x
//
// r relative to the nodes' middle, are those of a rigid motion, and do not strain what is on the pins. A body that was teleported does not
// move as its angular velocity says: its nodes go along chords.
void SoftBodySystem::drivePinsOn( btRigidBody& holder, SoftBody& body, btScalar h )
{
	SoftBody::Impl& impl = body.impl();
	NodeState& nodes = impl.body->nodes();
	const Vec3d turn = double( h ) * toVec3d( holder.getAngularVelocity() );
	const Eigen::Matrix3d moved = rotationBy( turn ).toRotationMatrix() - Eigen::Matrix3d::Identity(), bend = moved - crossMatrix( turn );
	const auto displacementOf = [&]( const Pin& pin ) {
		return Vec3d( toVec3d( holder.getWorldTransform() * pin.point ) - nodes.worldPosition( pin.node ) );
	};
	const auto forPins = [&]( const auto& visit ) {
		for ( const Pin& pin : impl.pins )
		{
			pin.kind == PinKind::FollowsBody&& pin.body == &holder ? visit( pin ) : void();
		}
	};
	Vec3d middle = Vec3d::Zero(), mean = Vec3d::Zero();
	double count = 0.0, turned = 0.0, otherwise = 0.0;
	forPins( [&]( const Pin& pin ) {
		middle += nodes.x.get( pin.node ).cast<double>();
		mean += displacementOf( pin );
		count += 1.0;
	} );
	middle /= count;
	mean /= count;
	forPins( [&]( const Pin& pin ) {
		const Vec3d own = moved * ( nodes.x.get( pin.node ).cast<double>() - middle );
		turned += own.squaredNorm();
		otherwise += ( displacementOf( pin ) - mean - own ).squaredNorm();
	} );
	const bool isTurning = otherwise < kTurnedOtherwise * turned;
	forPins( [&]( const Pin& pin ) {
		const Vec3d bent = isTurning ? Vec3d( bend * ( nodes.x.get( pin.node ).cast<double>() - middle ) ) : Vec3d( Vec3d::Zero() );
		nodes.v.set( pin.node, Vec3d( ( displacementOf( pin ) - bent ) / double( h ) ).cast<float>() );
	} );
}

// Gives each pinned node the velocity of its point of the rigid body, or the one that reaches its target by the end of the game step.
void SoftBodySystem::drivePins( SoftBody& body, btScalar h, int substep )
{
	SoftBody::Impl& impl = body.impl();
	NodeState& nodes = impl.body->nodes();
	for ( std::size_t k = 0; k < impl.pins.size(); ++k )
	{
		const Pin& pin = impl.pins[k];
		if ( pin.kind == PinKind::FollowsBody && pin.body->isKinematicObject() )
		{
			const auto before = std::make_reverse_iterator( impl.pins.begin() + std::ptrdiff_t( k ) );
			if ( std::none_of( before, impl.pins.rend(), [&pin]( const Pin& other ) { return other.body == pin.body; } ) )
			{
				drivePinsOn( *pin.body, body, h );
			}
			continue;
		}
		btVector3 velocity( 0, 0, 0 );
		if ( pin.kind == PinKind::FollowsBody )
		{
			velocity = pin.body->getVelocityInLocalPoint( pin.body->getWorldTransform().getBasis() * pin.point );
		}
		if ( pin.kind == PinKind::Driven && pin.hasTarget )
		{
			velocity = ( pin.point - impl.position( pin.node ) ) / ( h * btScalar( substepsOf( body ) - substep ) );
		}
		nodes.v.set( pin.node, toVec3( velocity ) );
	}
}

// Call after rigid bodies have moved: corrects the velocities so that pinned nodes reach their targets exactly.
void SoftBodySystem::settlePins( SoftBody& body, btScalar h, int substep )
{
	SoftBody::Impl& impl = body.impl();
	NodeState& nodes = impl.body->nodes();
	for ( Pin& pin : impl.pins )
	{
		if ( pin.kind == PinKind::FollowsBody )
		{
			const Vec3d target = toVec3d( pin.body->getWorldTransform() * pin.point ) - nodes.origin;
			nodes.v.set( pin.node, ( ( target - nodes.x.get( pin.node ).cast<double>() ) / double( h ) ).cast<float>() );
		}
		if ( pin.kind == PinKind::Driven && pin.hasTarget && substep + 1 == substepsOf( body ) )
		{
			const Vec3d displacement = toVec3d( pin.point ) - nodes.worldPosition( pin.node );
			nodes.v.set( pin.node, ( displacement / double( h ) ).cast<float>() );
			pin.hasTarget = false;
		}
	}
}

// A kinematic body is where the game put it, by `teleport` or pins, with the velocity of that displacement; a static one is at rest.
void SoftBodySystem::moveHeldBodies()
{
	for ( SoftBody* body : m_bodies )
	{
		SoftBody::Impl& impl = body->impl();
		if ( !body->isStaticOrKinematicObject() || impl.isScenery )
		{
			impl.heldBefore.clear();
			impl.isScenery && !body->isStaticObject() ? leaveScenery( *body ) : void();
			continue;
		}
		NodeState& nodes = impl.body->nodes();
		const std::size_t count = std::size_t( nodes.count );
		bool isDriven = false;
		for ( Pin& pin : impl.pins )
		{
			const bool follows = pin.kind == PinKind::FollowsBody;
			if ( follows || ( pin.kind == PinKind::Driven && pin.hasTarget ) )
			{
				const btVector3 target = follows ? pin.body->getWorldTransform() * pin.point : pin.point;
				nodes.x.set( pin.node, ( toVec3d( target ) - nodes.origin ).cast<float>() );
				pin.hasTarget = false;
				isDriven = true;
			}
		}
		const bool isKnown = body->isKinematicObject() && impl.heldBefore.size() == count && m_gameStep > 0;
		impl.heldBefore.resize( count, Vec3d::Zero() );
		Vec3d low = Vec3d::Zero(), high = Vec3d::Zero();
		for ( int i = 0; i < nodes.count; ++i )
		{
			const Vec3d at = nodes.worldPosition( i );
			const Vec3d velocity = isKnown ? Vec3d( ( at - impl.heldBefore[std::size_t( i )] ) / double( m_gameStep ) )
										   : Vec3d( Vec3d::Zero() );
			nodes.v.set( i, velocity.cast<float>() );
			impl.heldBefore[std::size_t( i )] = at;
			low = low.cwiseMin( velocity );
			high = high.cwiseMax( velocity );
		}
		impl.shape->setSweep( m_gameStep * toBt( low ), m_gameStep * toBt( high ) );
		if ( isDriven )
		{
			impl.skin.nodesMoved();
			impl.placeShape( *body );
		}
	}
}

} // namespace pliant
