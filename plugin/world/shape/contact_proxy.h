#pragma once

// The stand-in through which Bullet's solver moves one node: a light rigid body that is in no world, made when the node is first
// touched and given back to a pool when nothing touches it any more. A body of 20 000 nodes resting on 100 of them has 100.

#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace pliant {

class ContactProxyPool;
class SoftBody;

class ContactProxy : public btRigidBody
{
public:
	/// So that what each stage asks for lies in few lines of the cache: where it is in one, who it is, its speed and mass, and what is
	/// below.
	static void* operator new( std::size_t size ) { return static_cast<char*>( btAlignedAlloc( size + kOffset, kLine ) ) + kOffset; }
	static void operator delete( void* body ) { btAlignedFree( static_cast<char*>( body ) - kOffset ); }

	explicit ContactProxy( ContactProxyPool& pool );
	~ContactProxy() override;

	/// m
	btScalar radius() const { return static_cast<const btSphereShape*>( getCollisionShape() )->getRadius(); }

private:
	static constexpr int kLine = 64, kOffset = 56;
	[[maybe_unused]] char m_gap[32] = {}; ///< to the next line

public:
	SoftBody* owner = nullptr;
	int node = -1;  ///< -1: a change of levels did away with it; what names the stand-in lets go of it in the next collision phase
	int uses = 0;   ///< manifolds and predictive contacts that name it
	int place = -1; ///< among its owner's touched ones
	btScalar mass = btScalar( 1 );            ///< kg, 0 while the node is held
	unsigned stamp = 0;                       ///< collision phase in which it was last written
	unsigned step = 0;                        ///< game step in which its surface was looked at
	bool wasAsleep = false;                   ///< when it was last written: awake now means that something has woken it
	bool isDirected = false;                  ///< its axes are the material's
	btVector3 written = btVector3( 0, 0, 0 ); ///< world position given to the solver, m
	unsigned surface = 0;                     ///< NodeSurface::version of what it was given; 0: nothing
	btBroadphaseProxy* handle = nullptr;      ///< what Bullet has of it: that lies in a line of its own
	ContactProxyPool* pool = nullptr;         ///< that it came from; null while that goes
};

/// What a user sets on a soft body and Bullet asks of its stand-ins.
class NodeSurface
{
public:
	/// Looks at the body, once in `step`.
	void follow( const SoftBody& owner, unsigned step );
	/// One more whenever something of it has changed; 0 before it has looked.
	unsigned version() const { return m_version; }
	void giveTo( ContactProxy& body ) const;

private:
	struct Values
	{
		btVector3 slip; ///< friction by direction
		btScalar friction, restitution, rolling, spinning, threshold, stiffness, damping;
		bool isSpring;
		int index[3];
		void* pointer;

		bool operator==( const Values& ) const = default;
	};

	Values m_values{};
	unsigned m_version = 0, m_step = 0;
};

/// Marks an object as a stand-in without touching the user's pointers.
extern const char kContactProxyMark;

inline bool isContactProxy( const btCollisionObject* object )
{
	return object && object->internalGetExtensionPointer() == &kContactProxyMark;
}

/// The soft body behind a node body, or null for any other object.
inline SoftBody* ownerOfContactProxy( const btCollisionObject* object )
{
	return isContactProxy( object ) ? static_cast<const ContactProxy*>( object )->owner : nullptr;
}

/// The game has a say about contacts, and so comes by stand-ins.
bool hasContactCallback();

class ContactProxyPool
{
public:
	~ContactProxyPool();

	/// The node's stand-in, written for this collision phase; counts one use.
	ContactProxy* acquire( SoftBody& owner, int node );
	void release( ContactProxy* body );

	/// A new collision phase begins: stand-ins are written anew when they are next acquired or refreshed; what the game sets on a body
	/// (friction and the like) once a game step.
	void nextPhase( bool isNewStep )
	{
		++m_phase;
		m_step += isNewStep ? 1 : 0;
		m_forgetsForces = isNewStep ? m_hadCallback : m_forgetsForces;
		m_hadCallback = hasContactCallback() || ( !isNewStep && m_hadCallback );
	}
	unsigned phase() const { return m_phase; }
	/// The owner leaves its world: what still holds stand-ins of its nodes must not ask it again.
	static void detach( SoftBody& owner );
	/// The game has deleted a stand-in, which it took for a rigid body of its own.
	void forget( const ContactProxy& body );
	/// Position, velocity, mass and surface properties from the node, once a phase.
	void refresh( ContactProxy& body );
	/// Whether it was written in this collision phase: what the solver made of it is for its node then.
	bool isFresh( const ContactProxy& body ) const { return body.stamp == m_phase; }
	/// The body is to be refreshed some turns later: what of it is written then.
	static void prefetchAhead( const ContactProxy& body );
	/// What it has come to is to be read: its place and speed.
	static void prefetchVelocity( const ContactProxy& body );

	std::size_t count() const { return m_all.size(); }

	/// The owner's nodes have other numbers: `nodeNow` by the number before, kNoNode where the node is gone; `nodeCount` there are now.
	static void renumber( SoftBody& owner, const std::vector<std::uint32_t>& nodeNow, int nodeCount );

private:
	std::vector<ContactProxy*> m_all, m_free;
	unsigned m_phase = 1, m_step = 1;
	bool m_hadCallback = false, m_forgetsForces = false; ///< in this step; in the last one: stand-ins may have been pushed
};

} // namespace pliant
