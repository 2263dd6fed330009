#include "world/step/step_impulses.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>

#include <algorithm>

namespace pliant {

namespace {

/// Returns the largest impulse per step of joints that limit impulses instead of forces; 0 for other joints and where there is no limit.
btScalar largestImpulse( btTypedConstraint& joint )
{
	switch ( joint.getConstraintType() )
	{
		case HINGE_CONSTRAINT_TYPE: return static_cast<btHingeConstraint&>( joint ).getMaxMotorImpulse();
		case CONETWIST_CONSTRAINT_TYPE: return static_cast<btConeTwistConstraint&>( joint ).getMaxMotorImpulse();
		case POINT2POINT_CONSTRAINT_TYPE: return static_cast<btPoint2PointConstraint&>( joint ).m_setting.m_impulseClamp;
		default: return btScalar( 0 );
	}
}

void setLargestImpulse( btTypedConstraint& joint, btScalar impulse )
{
	switch ( joint.getConstraintType() )
	{
		case HINGE_CONSTRAINT_TYPE: static_cast<btHingeConstraint&>( joint ).setMaxMotorImpulse( impulse ); break;
		case CONETWIST_CONSTRAINT_TYPE: {
			auto& cone = static_cast<btConeTwistConstraint&>( joint );
			cone.isMaxMotorImpulseNormalized() ? cone.setMaxMotorImpulseNormalized( impulse ) : cone.setMaxMotorImpulse( impulse );
			break;
		}
		case POINT2POINT_CONSTRAINT_TYPE: static_cast<btPoint2PointConstraint&>( joint ).m_setting.m_impulseClamp = impulse; break;
		default: break;
	}
}

} // namespace

/// m_companionIdA of a manifold is the index of its contact here, plus 1: Bullet's sequential solvers do not use it.
StepImpulses::Contact* StepImpulses::find( const btPersistentManifold& manifold )
{
	const int index = manifold.m_companionIdA - 1;
	if ( index < 0 || index >= int( m_contacts.size() ) )
	{
		return nullptr;
	}
	Contact& contact = m_contacts[std::size_t( index )];
	const bool isSame = contact.manifold == &manifold && contact.bodies[0] == manifold.getBody0() &&
		contact.bodies[1] == manifold.getBody1();
	return isSame ? &contact : nullptr;
}

void StepImpulses::add( const Contact& contact )
{
	m_contacts.push_back( contact );
	contact.manifold->m_companionIdA = int( m_contacts.size() );
}

// Impulses that the game has changed since the last step stay unchanged.
void StepImpulses::restoreLastSubstep( btDispatcher& dispatcher )
{
	for ( int m = 0; m < dispatcher.getNumManifolds() && !m_contacts.empty(); ++m )
	{
		btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal( m );
		const Contact* const contact = find( manifold );
		for ( int k = 0; contact && contact->points == manifold.getNumContacts() && k < contact->points; ++k )
		{
			btManifoldPoint& point = manifold.getContactPoint( k );
			if ( point.m_appliedImpulse == contact->shown[k] )
			{
				point.m_appliedImpulse = contact->last[k].normal;
				point.m_appliedImpulseLateral1 = contact->last[k].lateral1;
				point.m_appliedImpulseLateral2 = contact->last[k].lateral2;
			}
		}
	}
	m_contacts.clear();
}

void StepImpulses::begin( const btAlignedObjectArray<btTypedConstraint*>& joints, int substeps )
{
	m_joints.clear();
	const btScalar part = btScalar( 1 ) / btScalar( substeps );
	for ( int i = 0; i < joints.size() && substeps > 1; ++i )
	{
		btTypedConstraint& joint = *joints[i];
		const btScalar threshold = joint.getBreakingImpulseThreshold(), motor = largestImpulse( joint );
		m_joints.push_back(
			Joint{ &joint, threshold, threshold < SIMD_INFINITY ? part * threshold : threshold, motor, part * motor, 0.0 } );
		joint.setBreakingImpulseThreshold( m_joints.back().scaledThreshold );
		setLargestImpulse( joint, m_joints.back().scaledMotor );
	}
}

void StepImpulses::add( btDispatcher& dispatcher )
{
	for ( int m = 0; m < dispatcher.getNumManifolds(); ++m )
	{
		btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal( m );
		double sum = 0.0;
		for ( int k = 0; k < manifold.getNumContacts(); ++k )
		{
			sum += double( manifold.getContactPoint( k ).m_appliedImpulse );
		}
		if ( sum == 0.0 )
		{
			continue;
		}
		if ( Contact* const contact = find( manifold ) )
		{
			contact->sum += sum;
			continue;
		}
		add( Contact{ &manifold, { manifold.getBody0(), manifold.getBody1() }, sum, 0, {}, {} } );
	}
	for ( Joint& joint : m_joints )
	{
		joint.sum += double( joint.joint->internalGetAppliedImpulse() );
	}
}

// Divides a contact's sum among its points in proportion to the last substep's impulses; if those are zero, gives it to the first point.
void StepImpulses::end( btDispatcher& dispatcher )
{
	for ( int m = 0; m < dispatcher.getNumManifolds(); ++m )
	{
		btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal( m );
		Contact* const contact = find( manifold );
		if ( !contact )
		{
			continue;
		}
		double last = 0.0;
		contact->points = std::min( manifold.getNumContacts(), kMostPoints );
		for ( int k = 0; k < contact->points; ++k )
		{
			const btManifoldPoint& point = manifold.getContactPoint( k );
			contact->last[k] = PointImpulse{ point.m_appliedImpulse, point.m_appliedImpulseLateral1, point.m_appliedImpulseLateral2 };
			last += double( point.m_appliedImpulse );
		}
		const btScalar scale = last > 0.0 ? btScalar( contact->sum / last ) : btScalar( 0 );
		for ( int k = 0; k < contact->points; ++k )
		{
			btManifoldPoint& point = manifold.getContactPoint( k );
			point.m_appliedImpulse = last > 0.0 ? scale * point.m_appliedImpulse : k == 0 ? btScalar( contact->sum ) : btScalar( 0 );
			point.m_appliedImpulseLateral1 *= scale;
			point.m_appliedImpulseLateral2 *= scale;
			contact->shown[k] = point.m_appliedImpulse;
		}
	}
	for ( const Joint& joint : m_joints )
	{
		joint.joint->internalSetAppliedImpulse( btScalar( joint.sum ) );
		if ( joint.joint->getBreakingImpulseThreshold() == joint.scaledThreshold )
		{
			joint.joint->setBreakingImpulseThreshold( joint.threshold );
		}
		if ( largestImpulse( *joint.joint ) == joint.scaledMotor )
		{
			setLargestImpulse( *joint.joint, joint.motor );
		}
	}
	m_joints.clear();
}

void StepImpulses::forget( const btTypedConstraint* joint )
{
	m_joints.erase(
		std::remove_if( m_joints.begin(), m_joints.end(), [joint]( const Joint& own ) { return own.joint == joint; } ), m_joints.end() );
}

} // namespace pliant
