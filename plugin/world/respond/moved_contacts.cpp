#include "world/respond/moved_contacts.h"

#include "world/bodies/manifolds.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"

#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>

namespace pliant {

void MovedContacts::moveToNodes( btDispatcher& dispatcher, const btContactSolverInfo& info )
{
	const btScalar deepest = info.m_erp2 > 0 ? btScalar( -kPushOutSpeed ) * info.m_timeStep / info.m_erp2 : -SIMD_INFINITY;
	m_moved.clear();
	m_deep.clear();
	m_hasRollingFriction = false;
	m_manifolds.clear();
	forEachManifold( dispatcher, [this]( btPersistentManifold& manifold ) {
		if ( ownerOfContactProxy( manifold.getBody0() ) || ownerOfContactProxy( manifold.getBody1() ) )
		{
			m_manifolds.push_back( &manifold );
		}
	} );
	for ( btPersistentManifold* const each : m_manifolds )
	{
		btPersistentManifold& manifold = *each;
		const bool nodeIsFirst = ownerOfContactProxy( manifold.getBody0() ) != nullptr;
		const auto& node = static_cast<const ContactProxy&>( *( nodeIsFirst ? manifold.getBody0() : manifold.getBody1() ) );
		const btScalar radius = node.radius();
		const btScalar deep = -kDeepFraction * radius;
		for ( int k = 0; k < manifold.getNumContacts(); ++k )
		{
			btManifoldPoint& point = manifold.getContactPoint( k );
			if ( point.m_distance1 < deep && ( nodeIsFirst ? manifold.getBody1() : manifold.getBody0() )->isStaticOrKinematicObject() )
			{
				node.owner->impl().isGuarded = true; // crushed nodes pass through slowly
			}
			m_hasRollingFriction = m_hasRollingFriction || point.m_combinedRollingFriction != 0 || point.m_combinedSpinningFriction != 0;
			const btScalar fromSurface = point.m_distance1 + radius;
			btVector3& position = nodeIsFirst ? point.m_positionWorldOnB : point.m_positionWorldOnA;
			m_moved.push_back( Moved{ &position, position } );
			if ( point.m_distance1 < deepest )
			{
				m_deep.push_back( Deep{ &point.m_distance1, point.m_distance1 } );
				point.m_distance1 = deepest;
			}
			position += point.m_normalWorldOnB * ( nodeIsFirst ? fromSurface : -fromSurface );
		}
	}
}

void MovedContacts::moveBack()
{
	for ( const Deep& deep : m_deep )
	{
		*deep.distance = deep.original;
	}
	for ( const Moved& moved : m_moved )
	{
		*moved.point = moved.original;
	}
}

} // namespace pliant
