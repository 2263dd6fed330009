#include "world/step/substep_group.h"

#include "archive/archive.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/joints/attachments.h"
#include "world/joints/frames.h"

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <algorithm>

namespace pliant {

namespace {

struct SweptBox : SubstepGroup::Box
{
	void include( const btVector3& displacement )
	{
		btVector3 negative = displacement, positive = displacement;
		negative.setMin( btVector3( 0, 0, 0 ) );
		positive.setMax( btVector3( 0, 0, 0 ) );
		low += negative;
		high += positive;
	}
	void grow( btScalar distance )
	{
		const btVector3 margin( distance, distance, distance );
		low -= margin;
		high += margin;
	}
	bool overlaps( const SweptBox& other ) const { return TestAabbAgainstAabb2( low, high, other.low, other.high ); }
};

/// Returns the box that a rigid body may sweep within the step, from its velocities and the changes by gravity and forces.
SweptBox boxOf( const btRigidBody& body, btScalar step )
{
	SweptBox box;
	body.getCollisionShape()->getAabb( body.getWorldTransform(), box.low, box.high );
	const btScalar turned = step * body.getAngularVelocity().length() * ( box.high - box.low ).length() / 2;
	box.include( step * ( body.getLinearVelocity() + step * body.getInvMass() * body.getTotalForce() ) );
	box.grow( turned + gContactBreakingThreshold );
	return box;
}

/// Returns the bounds of the displacements of a soft body's nodes within the step, m.
SweptBox sweepOf( const SoftBody& body, const btVector3& gravity, btScalar step )
{
	const auto [low, high] = body.impl().body->nodes().velocityBounds();
	SweptBox sweep{ { step * toBt( low.cast<double>() ), step * toBt( high.cast<double>() ) } };
	sweep.include( step * step * gravity );
	sweep.low.setMin( btVector3( 0, 0, 0 ) );
	sweep.high.setMax( btVector3( 0, 0, 0 ) );
	return sweep;
}

SweptBox wholeBox( const SoftBody& body )
{
	if ( body.impl().rigidProxy )
	{
		SweptBox box;
		body.getCollisionShape()->getAabb( body.getWorldTransform(), box.low, box.high );
		return box;
	}
	const SphereRows::Box& whole = body.impl().shape->rows().whole();
	const btVector3 at = body.getWorldTransform().getOrigin();
	return SweptBox{ { at + whole.mins(), at + whole.maxs() } };
}

SweptBox boxOf( const SoftBody& body, const btVector3& gravity, btScalar step )
{
	SweptBox box = wholeBox( body );
	if ( body.isActive() )
	{
		const SweptBox sweep = sweepOf( body, gravity, step );
		box.low += sweep.low;
		box.high += sweep.high;
	}
	return box;
}

} // namespace

// A body in its rigid state that pins hold is like the ground: each pass solves the contacts of its own objects with it. If it took the
// substeps of one object on it, another that rests on it would be in no pass with its contacts, and fall for that step.
bool SubstepGroup::canMove( const btCollisionObject& object )
{
	const SoftBody* const soft = SoftBody::upcast( &object );
	return !object.isStaticOrKinematicObject() && !( soft && soft->impl().rigidProxy && soft->impl().rigidProxy->isHeld() );
}

SubstepGroup::Box SubstepGroup::sweptBox( const btCollisionObject& object, const btVector3& gravity, btScalar step )
{
	SweptBox box;
	if ( const SoftBody* const soft = SoftBody::upcast( &object ) )
	{
		box = boxOf( *soft, gravity, step );
		if ( !soft->impl().rigidProxy )
		{
			box.grow( btScalar( kDrawnBeyondSpheres ) * soft->impl().shape->largestRadius() ); // as for the box of the drawn surface
		}
	}
	else if ( const btRigidBody* const rigid = btRigidBody::upcast( &object ) )
	{
		box = boxOf( *rigid, step );
	}
	else
	{
		object.getCollisionShape()->getAabb( object.getWorldTransform(), box.low, box.high );
	}
	box.grow( gContactBreakingThreshold + kSweepMargin * ( box.high - box.low ).length() );
	return box;
}

bool SubstepGroup::isInBox( const btCollisionObject& object )
{
	Box now;
	object.getCollisionShape()->getAabb( object.getWorldTransform(), now.low, now.high );
	const btBroadphaseProxy& known = *object.getBroadphaseHandle();
	for ( int k = 0; k < 3; ++k )
	{
		if ( now.low[k] < known.m_aabbMin[k] || now.high[k] > known.m_aabbMax[k] )
		{
			return false;
		}
	}
	return true;
}

bool SubstepGroup::isMember( const std::vector<unsigned char>& flags, const btCollisionObject& object )
{
	const SoftBody* const owner = ownerOfContactProxy( &object );
	const int index = owner ? static_cast<const btCollisionObject*>( owner )->getWorldArrayIndex() : object.getWorldArrayIndex();
	return index >= 0 && index < int( flags.size() ) && flags[std::size_t( index )] != 0;
}

void SubstepGroup::add( const btCollisionObject& object )
{
	const int index = object.getWorldArrayIndex();
	if ( index >= 0 )
	{
		m_isMember.resize( std::max( m_isMember.size(), std::size_t( index ) + 1 ), 0 );
		m_isMember[std::size_t( index )] = 1;
	}
}

void SubstepGroup::noteRemoval( const btCollisionObject& object, int objectCount )
{
	m_touching.erase( std::remove_if( m_touching.begin(), m_touching.end(),
						  [&object]( const Touching& touching ) { return touching.a == &object || touching.b == &object; } ),
		m_touching.end() );
	const int index = object.getWorldArrayIndex(), last = objectCount - 1;
	for ( std::vector<unsigned char>* flags : { &m_isMember, &m_wasMember } )
	{
		const int count = int( flags->size() );
		if ( index < 0 || index >= count )
		{
			continue;
		}
		( *flags )[std::size_t( index )] = last < count ? ( *flags )[std::size_t( last )] : 0;
		flags->resize( std::size_t( std::min( count, last ) ) );
	}
}

void SubstepGroup::noteContact( const btCollisionObject& a, const btCollisionObject& b )
{
	m_touching.push_back( Touching{ &a, &b } );
}

void SubstepGroup::endSubsteps( btCollisionWorld& world )
{
	btCollisionObjectArray& objects = world.getCollisionObjectArray();
	for ( int i = 0; i < objects.size() && m_isSplit; ++i )
	{
		if ( contains( *objects[i] ) && objects[i]->getIslandTag() >= 0 )
		{
			objects[i]->setIslandTag( objects[i]->getIslandTag() + objects.size() ); // the whole-step pass numbers its islands from 0
		}
	}
	for ( const Touching& touching : m_touching )
	{
		if ( touching.a->getIslandTag() >= 0 && touching.b->getIslandTag() >= 0 )
		{
			m_joinedTags.push_back( TagPair{ touching.a->getIslandTag(), touching.b->getIslandTag() } );
		}
	}
	m_touching.clear();
}

/// Returns true if the object was not in the group yet.
bool SubstepGroup::include( const btCollisionObject& object )
{
	const int index = object.getWorldArrayIndex();
	if ( !canMove( object ) || index < 0 )
	{
		return false;
	}
	const int tag = object.getIslandTag();
	if ( tag >= 0 )
	{
		m_tags.resize( std::max( m_tags.size(), std::size_t( tag ) + 1 ), 0 );
		m_tags[std::size_t( tag )] = 1;
	}
	unsigned char& flag = m_isMember[std::size_t( index )];
	const bool isNew = flag == 0;
	flag = 1;
	return isNew;
}

// Tests boxes first, then the nodes' spheres: a large hollow or bent body fills little of its box.
void SubstepGroup::includeNearby( const Scene& scene, const std::vector<SoftBody*>& substepped, btScalar gameStep )
{
	std::vector<SweptBox> sweeps, boxes;
	SweptBox all{
		{ btVector3( SIMD_INFINITY, SIMD_INFINITY, SIMD_INFINITY ), btVector3( -SIMD_INFINITY, -SIMD_INFINITY, -SIMD_INFINITY ) } };
	for ( const SoftBody* body : substepped )
	{
		sweeps.push_back( sweepOf( *body, scene.world.getGravity(), gameStep ) );
		SweptBox box = boxOf( *body, scene.world.getGravity(), gameStep );
		box.grow( body->impl().shape->largestRadius() ); // a split node is replaced by nodes that fill its cube
		boxes.push_back( box );
		all.low.setMin( box.low );
		all.high.setMax( box.high );
	}
	const auto isNear = [&]( const SweptBox& other ) {
		for ( std::size_t k = 0; k < substepped.size() && all.overlaps( other ); ++k )
		{
			if ( !boxes[k].overlaps( other ) )
			{
				continue;
			}
			const NodeShape& shape = *substepped[k]->impl().shape;
			const btVector3 at = substepped[k]->getWorldTransform().getOrigin();
			SweptBox reach{ { other.low - at - sweeps[k].high, other.high - at - sweeps[k].low } };
			reach.grow( shape.largestRadius() );
			bool isFound = false;
			shape.rows().visitOverlaps( SphereRows::Box::of( reach.low, reach.high ), [&isFound]( int ) { isFound = true; } );
			if ( isFound )
			{
				return true;
			}
		}
		return false;
	};
	for ( int i = 0; i < scene.rigid.size(); ++i )
	{
		const btRigidBody& body = *scene.rigid[i];
		if ( canMove( body ) && !contains( body ) && isNear( boxOf( body, gameStep ) ) )
		{
			include( body );
		}
	}
	for ( const SoftBody* body : scene.soft )
	{
		if ( !canMove( *body ) || contains( *body ) )
		{
			continue;
		}
		if ( isNear( boxOf( *body, scene.world.getGravity(), gameStep ) ) )
		{
			include( *body );
		}
	}
}

bool SubstepGroup::includeIslands( const Scene& scene )
{
	for ( bool isChanged = true; isChanged; )
	{
		isChanged = false;
		for ( const TagPair& pair : m_joinedTags )
		{
			const std::size_t most = std::size_t( std::max( pair.a, pair.b ) ) + 1;
			m_tags.resize( std::max( m_tags.size(), most ), 0 );
			unsigned char &a = m_tags[std::size_t( pair.a )], &b = m_tags[std::size_t( pair.b )];
			isChanged = isChanged || a != b;
			a = b = static_cast<unsigned char>( a | b );
		}
	}
	bool isChanged = false;
	const btCollisionObjectArray& objects = scene.world.getCollisionObjectArray();
	for ( int i = 0; i < objects.size(); ++i )
	{
		const int tag = objects[i]->getIslandTag();
		if ( tag >= 0 && tag < int( m_tags.size() ) && m_tags[std::size_t( tag )] != 0 )
		{
			isChanged = include( *objects[i] ) || isChanged;
		}
	}
	return isChanged;
}

bool SubstepGroup::includeJoined( const Scene& scene )
{
	bool isChanged = false;
	for ( int i = 0; i < scene.constraints.size(); ++i )
	{
		const btTypedConstraint& joint = *scene.constraints[i];
		const btRigidBody &a = joint.getRigidBodyA(), &b = joint.getRigidBodyB();
		if ( joint.isEnabled() && contains( a ) != contains( b ) )
		{
			isChanged = include( contains( a ) ? b : a ) || isChanged;
		}
	}
	const auto includeBoth = [&]( const btCollisionObject& a, const btCollisionObject& b ) {
		if ( contains( a ) != contains( b ) )
		{
			isChanged = include( contains( a ) ? b : a ) || isChanged;
		}
	};
	for ( const Attachment& attachment : scene.attachments.all() )
	{
		includeBoth( *attachment.first.body, attachment.secondObject() );
	}
	for ( const Frame& frame : scene.frames.all() )
	{
		if ( frame.body )
		{
			includeBoth( *frame.body, *frame.rigid );
		}
	}
	return isChanged;
}

int SubstepGroup::rigidCount( const Scene& scene ) const
{
	int count = 0;
	for ( int i = 0; i < scene.rigid.size(); ++i )
	{
		count += scene.rigid[i]->isActive() && contains( *scene.rigid[i] ) ? 1 : 0;
	}
	return count;
}

void SubstepGroup::choose( const Scene& scene, const std::vector<SoftBody*>& substepped, btScalar gameStep )
{
	const btCollisionObjectArray& objects = scene.world.getCollisionObjectArray();
	m_isMember.assign( std::size_t( objects.size() ), 0 );
	m_tags.assign( m_tags.size(), 0 );
	m_isEmpty = substepped.empty();
	m_isSplit = false;
	if ( m_isEmpty )
	{
		return;
	}
	for ( const SoftBody* body : substepped )
	{
		include( *body );
	}
	includeNearby( scene, substepped, gameStep );
	includeIslands( scene );
	while ( includeJoined( scene ) && includeIslands( scene ) )
	{}
	for ( int i = 0; i < objects.size() && scene.canSplit && !m_isSplit; ++i )
	{
		m_isSplit = canMove( *objects[i] ) && objects[i]->isActive() && !contains( *objects[i] );
	}
	if ( !m_isSplit )
	{
		// Sleeping objects too, because they may be woken within the step.
		for ( int i = 0; i < objects.size(); ++i )
		{
			m_isMember[std::size_t( i )] = canMove( *objects[i] ) ? 1 : 0;
		}
	}
}

void SubstepGroup::TagPair::archive( Archive& archive )
{
	archive( a, b );
	archive.require( a >= 0 && b >= 0 && a < kMostTags && b < kMostTags, "The tag of an island is out of range." );
}

void SubstepGroup::archive( Archive& archive )
{
	archive( m_isMember, m_joinedTags, m_isEmpty, m_isSplit );
}

} // namespace pliant
