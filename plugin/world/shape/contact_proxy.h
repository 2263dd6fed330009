#pragma once

// The contact proxy that represents one node in Bullet's manifolds: a light rigid body that belongs to no world, created when the node is
// first touched and returned to a pool when nothing touches it any more. A body of 20 000 nodes resting on 100 of them has 100 proxies.

#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <cstdint>
#include <vector>

namespace pliant {

class ContactProxyPool;
class SoftBody;

class ContactProxy : public btRigidBody
{
public:
	/// The offset keeps the data that each stage reads in few cache lines: position; identity; velocity and mass; the members below.
	static void* operator new( std::size_t size ) { return static_cast<char*>( btAlignedAlloc( size + kOffset, kLine ) ) + kOffset; }
	static void operator delete( void* body ) { btAlignedFree( static_cast<char*>( body ) - kOffset ); }

	explicit ContactProxy( ContactProxyPool& pool );
	~ContactProxy() override;

	/// m
	btScalar radius() const { return static_cast<const btSphereShape*>( getCollisionShape() )->getRadius(); }

private:
	static constexpr int kLine = 64, kOffset = 56;
	[[maybe_unused]] char m_gap[32] = {}; ///< fills the cache line

public:
	SoftBody* owner = nullptr;
	int node = -1; ///< -1: a change of levels removed the node; all references to the proxy are released in the next collision phase
	int uses = 0;  ///< manifolds and predictive contacts that refer to it
	int touchedIndex = -1;                    ///< in its owner's list of touched nodes
	btScalar mass = btScalar( 1 );            ///< kg, 0 while the node is held
	unsigned stamp = 0;                       ///< collision phase in which it was last written
	unsigned step = 0;                        ///< game step in which its surface properties were last checked
	bool wasAsleep = false;                   ///< when last written: if awake now, something has woken it
	bool isDirected = false;                  ///< its axes are the material's
	btVector3 written = btVector3( 0, 0, 0 ); ///< world position given to the solver, m
	unsigned surface = 0;                     ///< NodeSurface::version of its surface properties; 0: none set
	btBroadphaseProxy* handle = nullptr;      ///< copy of Bullet's pointer, which lies in another cache line
	ContactProxyPool* pool = nullptr;         ///< that it belongs to; null while the pool is being destroyed
};

/// Surface properties that a user sets on a soft body and Bullet reads from its contact proxies.
class NodeSurface
{
public:
	/// Reads the body's properties, once per `step`.
	void follow( const SoftBody& owner, unsigned step );
	/// Increases with every change of a property; 0 before the first read.
	unsigned version() const { return m_version; }
	void applyTo( ContactProxy& body ) const;

private:
	struct Values
	{
		btVector3 slip; ///< anisotropic friction
		btScalar friction, restitution, rolling, spinning, threshold, stiffness, damping;
		bool isSpring;
		int index[3];
		void* pointer;

		bool operator==( const Values& ) const = default;
	};

	Values m_values{};
	unsigned m_version = 0, m_step = 0;
};

/// Marks an object as a contact proxy without touching the user's pointers.
extern const char kContactProxyMark;

inline bool isContactProxy( const btCollisionObject* object )
{
	return object && object->internalGetExtensionPointer() == &kContactProxyMark;
}

/// The soft body of a contact proxy, or null for any other object.
inline SoftBody* ownerOfContactProxy( const btCollisionObject* object )
{
	return isContactProxy( object ) ? static_cast<const ContactProxy*>( object )->owner : nullptr;
}

/// Whether the game has contact callbacks, and can therefore access proxies.
bool hasContactCallback();

class ContactProxyPool
{
public:
	~ContactProxyPool();

	/// The node's proxy, written for this collision phase; counts one use.
	ContactProxy* acquire( SoftBody& owner, int node );
	void release( ContactProxy* body );

	/// Starts a collision phase: proxies are rewritten when next acquired or refreshed; friction and the like once per game step.
	void nextPhase( bool isNewStep )
	{
		++m_phase;
		m_step += isNewStep ? 1 : 0;
		m_clearsForces = isNewStep ? m_hadCallback : m_clearsForces;
		m_hadCallback = hasContactCallback() || ( !isNewStep && m_hadCallback );
	}
	unsigned phase() const { return m_phase; }
	/// The owner leaves its world: remaining references to proxies of its nodes must not access it again.
	static void detach( SoftBody& owner );
	/// The game has deleted a proxy, which it took for one of its own rigid bodies.
	void forget( const ContactProxy& body );
	/// Copies position, velocity, mass and surface properties from the node, once per phase.
	void refresh( ContactProxy& body );

	std::size_t count() const { return m_all.size(); }

	/// The owner's nodes are renumbered: `nodeNow` by previous number, kNoNode where the node is gone; `nodeCount` is the new count.
	static void renumber( SoftBody& owner, const std::vector<std::uint32_t>& nodeNow, int nodeCount );

private:
	std::vector<ContactProxy*> m_all, m_free;
	unsigned m_phase = 1, m_step = 1;
	bool m_hadCallback = false, m_clearsForces = false; ///< in this step; in the last one: proxies may have received forces
};

} // namespace pliant
