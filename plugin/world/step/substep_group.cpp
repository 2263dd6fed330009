#include "world/step/substep_group.h"

#include "archive/archive.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/joints/attachments.h"
#include "world/joints/frames.h"
#include "world/step/object_motion.h"
#include "world/step/swept_box.h"

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraint.h>

#include <algorithm>

namespace pliant {

// A body in its rigid state that pins hold is like the ground: each pass solves the contacts of its own objects with it. If it took the
// substeps of one object on it, another that rests on it would be in no pass with its contacts, and fall for that step.
bool SubstepGroup::canMove( const btCollisionObject& object )
{
	const SoftBody* const soft = SoftBody::upcast( &object );
	return !object.isStaticOrKinematicObject() && !( soft && soft->impl().rigidProxy && soft->impl().rigidProxy->isHeld() );
}

bool SubstepGroup::isMember( const std::vector<unsigned char>& flags, const btCollisionObject& object )
{
	const SoftBody* const owner = ownerOfContactProxy( &object );
	const int index = owner ? static_cast<const btCollisionObject*>( owner )->getWorldArrayIndex() : object.getWorldArrayIndex();
	return index >= 0 && index < int( flags.size() ) && flags[std::size_t( index )] != 0;
}

bool SubstepGroup::contains( const btMultiBody& body ) const
{
	bool isIn = false;
	forEachCollider( body, [&]( const btCollisionObject& link ) { isIn = isIn || contains( link ); } );
	return isIn;
}

bool SubstepGroup::moves( StepPass pass, const btMultiBody& body ) const
{
	return !m_isSplit || contains( body ) == ( pass == StepPass::Substeps );
}

bool SubstepGroup::include( const btMultiBody& body )
{
	bool isNew = false;
	forEachCollider( body, [&]( const btCollisionObject& link ) { isNew = include( link ) || isNew; } );
	return isNew;
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

void SubstepGroup::includeNearby( const Scene& scene, const std::vector<SoftBody*>& substepped, btScalar gameStep )
{
	std::vector<SweptNodes> movers;
	const btScalar far = SIMD_INFINITY;
	SweptBox all{ btVector3( far, far, far ), btVector3( -far, -far, -far ) };
	for ( const SoftBody* body : substepped )
	{
		movers.emplace_back( *body, scene.world.getGravity(), gameStep );
		all.low.setMin( movers.back().box().low );
		all.high.setMax( movers.back().box().high );
	}
	const auto isNear = [&]( const SweptBox& other ) {
		return all.overlaps( other ) &&
			std::any_of( movers.begin(), movers.end(), [&]( const SweptNodes& mover ) { return mover.mayTouch( other ); } );
	};
	for ( int i = 0; i < scene.rigid.size(); ++i )
	{
		const btRigidBody& body = *scene.rigid[i];
		if ( canMove( body ) && !contains( body ) && isNear( SweptBox::of( body, gameStep ) ) )
		{
			include( body );
		}
	}
	for ( int i = 0; i < scene.multiBodies.size(); ++i )
	{
		forEachCollider( *scene.multiBodies[i], [&]( const btCollisionObject& link ) {
			if ( canMove( link ) && !contains( link ) && isNear( SweptBox::of( link, motionOf( link ), gameStep ) ) )
			{
				include( link );
			}
		} );
	}
	for ( const SoftBody* body : scene.soft )
	{
		if ( canMove( *body ) && !contains( *body ) && isNear( SweptBox::of( *body, scene.world.getGravity(), gameStep ) ) )
		{
			include( *body );
		}
	}
}

// A rigid object outside that an object of the group touches is given the impulse; the nodes of a soft body outside have no equations in
// that pass, and would be fixed.
bool SubstepGroup::includeSoftNear( const Scene& scene, btScalar gameStep )
{
	const btVector3 gravity = scene.world.getGravity();
	std::vector<SweptBox> members;
	bool isChanged = false;
	for ( const SoftBody* body : scene.soft )
	{
		if ( !body->isActive() || !canMove( *body ) || contains( *body ) )
		{
			continue;
		}
		if ( members.empty() )
		{
			for ( int i = 0; i < scene.rigid.size(); ++i )
			{
				contains( *scene.rigid[i] ) ? members.push_back( SweptBox::of( *scene.rigid[i], gameStep ) ) : void();
			}
			for ( int i = 0; i < scene.multiBodies.size(); ++i )
			{
				forEachCollider( *scene.multiBodies[i], [&]( const btCollisionObject& link ) {
					contains( link ) ? members.push_back( SweptBox::of( link, motionOf( link ), gameStep ) ) : void();
				} );
			}
			for ( const SoftBody* member : scene.soft )
			{
				contains( *member ) ? members.push_back( SweptBox::of( *member, gravity, gameStep ) ) : void();
			}
		}
		const SweptNodes own( *body, gravity, gameStep );
		if ( std::any_of( members.begin(), members.end(), [&]( const SweptBox& member ) { return own.mayTouch( member ); } ) )
		{
			include( *body );
			members.push_back( own.box() );
			isChanged = true;
		}
	}
	return isChanged;
}

void SubstepGroup::includeIslands( const Scene& scene )
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
	const btCollisionObjectArray& objects = scene.world.getCollisionObjectArray();
	for ( int i = 0; i < objects.size(); ++i )
	{
		const int tag = objects[i]->getIslandTag();
		if ( tag >= 0 && tag < int( m_tags.size() ) && m_tags[std::size_t( tag )] != 0 )
		{
			include( *objects[i] );
		}
	}
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
	for ( int i = 0; i < scene.multiBodies.size(); ++i )
	{
		isChanged = ( contains( *scene.multiBodies[i] ) && include( *scene.multiBodies[i] ) ) || isChanged;
	}
	for ( int i = 0; i < scene.multiBodyJoints.size(); ++i )
	{
		const btMultiBody *const a = scene.multiBodyJoints[i]->getMultiBodyA(), *const b = scene.multiBodyJoints[i]->getMultiBodyB();
		if ( a && b && contains( *a ) != contains( *b ) )
		{
			isChanged = include( contains( *a ) ? *b : *a ) || isChanged;
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
	for ( int i = 0; i < scene.multiBodies.size(); ++i )
	{
		forEachCollider(
			*scene.multiBodies[i], [&]( const btCollisionObject& link ) { count += link.isActive() && contains( link ) ? 1 : 0; } );
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
	for ( bool isChanged = true; isChanged; )
	{
		includeIslands( scene );
		isChanged = includeJoined( scene );
		isChanged = includeSoftNear( scene, gameStep ) || isChanged;
	}
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
