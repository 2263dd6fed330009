#pragma once

// Ray caster for btRaycastVehicle that also finds soft bodies; btDefaultVehicleRaycaster finds rigid bodies only.

#include "pliant/export.h"
#include "pliant/soft_body_host.h"

#include <BulletDynamics/Dynamics/btActionInterface.h>
#include <BulletDynamics/Vehicle/btVehicleRaycaster.h>

class btRaycastVehicle;

namespace pliant {

/// Finds rigid bodies as btDefaultVehicleRaycaster does, and soft bodies by their drawn surface, from outside only. The vehicle treats a
/// soft body as fixed ground. Bullet's vehicle exerts no force on the ground; for soft bodies this class does: set the vehicle and add the
/// ray caster to the world as an action, after the vehicle.
///
///     pliant::VehicleRaycaster caster( world );
///     btRaycastVehicle vehicle( tuning, chassis, &caster );
///     world.addVehicle( &vehicle );
///     caster.setVehicle( &vehicle );
///     world.addAction( &caster );
class PLIANT_API VehicleRaycaster : public btVehicleRaycaster, public btActionInterface
{
public:
	/// Collision group and mask of its rays, as for any of Bullet's. The world must outlive it.
	explicit VehicleRaycaster( SoftBodyHost& world, int group = btBroadphaseProxy::DefaultFilter, int mask = btBroadphaseProxy::AllFilter );

	/// Called by Bullet's vehicle; positions in world coordinates, m. Returns the btRigidBody that is hit, Bullet's fixed body where a soft
	/// body is hit (callers read the result as a btRigidBody), or null where nothing is hit; then `result` is unchanged.
	void* castRay( const btVector3& from, const btVector3& to, btVehicleRaycasterResult& result ) override;
	/// The soft body that castRay would hit; null where there is none or a rigid body is nearer.
	[[nodiscard]] SoftBody* softBodyAt( const btVector3& from, const btVector3& to );

	/// Sets the vehicle whose wheels press on soft bodies: each suspension force acts on the nodes within the wheel's radius, or within two
	/// node radii if that is more. Not owned; null (the default): none. A sleeping vehicle does not press.
	void setVehicle( const btRaycastVehicle* vehicle ) { m_vehicle = vehicle; }
	/// The vehicle last set; null: none.
	[[nodiscard]] const btRaycastVehicle* vehicle() const { return m_vehicle; }
	/// Called by the world once per step, `step` in s: presses the wheels of the vehicle on soft bodies.
	void updateAction( btCollisionWorld* world, btScalar step ) override;
	/// As Bullet's; draws nothing.
	void debugDraw( btIDebugDraw* ) override {}

private:
	struct Hit;
	Hit nearest( const btVector3& from, const btVector3& to );

	SoftBodyHost& m_world;
	int m_group, m_mask;
	const btRaycastVehicle* m_vehicle = nullptr;
};

} // namespace pliant
