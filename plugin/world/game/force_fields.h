#pragma once

// The force fields of a world, and the gas in a body's cavities: forces on nodes for one substep (Body::fieldForce).

#include "pliant/game/forces.h"
#include "pliant/soft_body.h"
#include "world/game/body_boundary.h"

#include <memory>
#include <vector>

class btDynamicsWorld;
class btRigidBody;

namespace pliant {

/// The gas in one cavity.
struct GasCavity
{
	std::vector<std::uint32_t> cells; ///< of its wall: numbers in the family's first body, ascending
	double amount = 0.0;              ///< of an ideal gas: absolute pressure times volume, J
	double pressure = 0.0;            ///< above that outside, in the last substep, Pa
	int surface = -1;                 ///< in the present boundary
};

/// The data of a body for forces on its surface; made when it is first needed.
struct SurfaceForces
{
	BodyBoundary boundary;
	Gas gas;
	std::vector<GasCavity> cavities;
	unsigned cavityVersion = 0;         ///< SoftBody::fractureVersion that they were found at
	std::vector<Vec3d> nodeForce;       ///< sums of a substep, N
	std::vector<Vec3d> cavityNodeForce; ///< scratch: per pressure, m^2

	/// Those of a piece that breaks off a body with `whole`, which may be null. `version`: SoftBody::fractureVersion of the whole, before.
	static std::unique_ptr<SurfaceForces> ofPiece( const SurfaceForces* whole, unsigned version );

	/// Starts the sums of forces on nodes; `boundary` is up to date.
	void begin( const Body& body );
	/// Adds a force on a point of the boundary, N, to the nodes that carry it.
	void add( const Body& body, int point, const Vec3d& force );
	/// Adds the forces of the gas on the walls of its cavities for a substep of length h, s.
	void pushWalls( const Body& body, unsigned version, double h );
	/// The force on a node, N, with its part of the torque that the points' distances from their nodes make.
	Vec3d forceOn( const Body& body, int node ) const;
	/// Before forceOn.
	void finish( const Body& body );
	/// Finds the cavities, and fills them with the gas of those that they were before. `isNew`: with Gas::pressure.
	void findCavities( const Body& body, unsigned version, bool isNew );

private:
	Vec3d m_missing = Vec3d::Zero(); ///< torque about the mass centre that the nodes' forces lack, N m
	Vec3d m_centre = Vec3d::Zero(),
		  m_turn = Vec3d::Zero(); ///< mass centre, m, and angular acceleration of the whole body by the torque, 1/s^2
};

class ForceFields
{
public:
	explicit ForceFields( btDynamicsWorld& world ) : m_world( world ) {}
	~ForceFields();

	/// Returns false if the field is in a world already.
	bool add( ForceField& field );
	/// Returns false if it is not in this world. Bodies that it acted on wake.
	bool remove( ForceField& field );
	/// The same for a field that is being destroyed: its `actsOn` cannot be called any more.
	void leave( ForceField& field );
	int count() const { return int( m_fields.size() ); }
	/// Whether fields are being called. Their calls of the library may read, but change nothing: several threads work on the bodies then.
	bool areActing() const { return m_areActing; }
	/// Create one for as long as fields are called.
	class Acting
	{
	public:
		explicit Acting( ForceFields& fields ) : m_fields( fields ) { m_fields.m_areActing = true; }
		~Acting() { m_fields.m_areActing = false; }
		Acting( const Acting& ) = delete;
		Acting& operator=( const Acting& ) = delete;

	private:
		ForceFields& m_fields;
	};
	void wake( const ForceField& field );

	/// Sets the nodes' field forces for a substep of length h, s; nothing and no cost where there are neither fields nor gas. Thread-safe
	/// for different bodies.
	void push( SoftBody& body, const btVector3& gravity, double h ) const;
	/// Adds accelerations to the forces on rigid bodies, once a game step.
	void pushRigid();
	/// Forces on rigid bodies have been cleared.
	void noteClearedForces() { m_given.clear(); }
	/// A rigid body leaves the world.
	void forget( const btRigidBody& body );

private:
	btVector3 accelerationAt( const btCollisionObject& object, const btVector3& position ) const;
	btVector3 volumeForceAt( const SoftBody& body, const VolumePoint& point ) const;
	/// `kinds`: those of ForceField that act on the body.
	void pushSurface( SoftBody& body, const btVector3& gravity, double h, int kinds ) const;
	void pushCavities( const SoftBody& body, const btVector3& gravity, SurfaceForces& forces ) const;

	struct Given
	{
		btRigidBody* body;
		btVector3 force;
	};
	btDynamicsWorld& m_world;
	std::vector<ForceField*> m_fields;
	std::vector<Given> m_given; ///< since forces were last cleared
	bool m_areActing = false;
};

} // namespace pliant
