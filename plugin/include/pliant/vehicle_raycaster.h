#pragma once

// Wheels of btRaycastVehicle on soft bodies: btDefaultVehicleRaycaster sees rigid bodies only.

#include "pliant/export.h"
#include "pliant/soft_body_host.h"

#include <BulletDynamics/Dynamics/btActionInterface.h>
#include <BulletDynamics/Vehicle/btVehicleRaycaster.h>

class btRaycastVehicle;

namespace pliant {

/// Rigid bodies as btDefaultVehicleRaycaster finds them, and soft bodies as the surface that their nodes' spheres make up: a wheel does not
/// fall between two nodes. To the vehicle a soft body is ground, as any rigid body is to Bullet's vehicle. Bullet's vehicle never pushes
/// what it stands on; this can, for soft bodies: name the vehicle and add the caster to the world as an action, after the vehicle.
///
///     pliant::VehicleRaycaster caster( world );
///     btRaycastVehicle vehicle( tuning, chassis, &caster );
///     world.addVehicle( &vehicle );
///     caster.setVehicle( &vehicle );
///     world.addAction( &caster );
class PLIANT_API VehicleRaycaster : public btVehicleRaycaster, public btActionInterface
{
public:
	/// Group and mask of its rays, as of any of Bullet's. The world must outlive it.
	explicit VehicleRaycaster( SoftBodyHost& world, int group = btBroadphaseProxy::DefaultFilter, int mask = btBroadphaseProxy::AllFilter );

	/// What Bullet's vehicle asks. The rigid body that is hit; where that is a soft body, Bullet's fixed body: programs read what they get
	/// as a btRigidBody. Null where nothing is hit.
	void* castRay( const btVector3& from, const btVector3& to, btVehicleRaycasterResult& result ) override;
	/// The soft body that castRay would find; null where there is none, or something rigid is nearer.
	SoftBody* softBodyAt( const btVector3& from, const btVector3& to );

	/// The vehicle whose wheels press on soft bodies, by the force of their suspension on the nodes within a wheel's radius; not owned,
	/// null for none (the default). A vehicle that sleeps does not press.
	void setVehicle( const btRaycastVehicle* vehicle ) { m_vehicle = vehicle; }
	void updateAction( btCollisionWorld* world, btScalar step ) override;
	void debugDraw( btIDebugDraw* ) override {}

private:
	struct Hit;
	Hit nearest( const btVector3& from, const btVector3& to );

	SoftBodyHost& m_world;
	int m_group, m_mask;
	const btRaycastVehicle* m_vehicle = nullptr;
};

} // namespace pliant
