#pragma once

// One sequence of random public calls on one or two worlds. random_calls_test.cpp.

#include "world/test_world.h"

#include <random>

namespace pliant::test {

/// Bullet's parts with pools of size one: all manifolds and algorithms are on the heap, where a sanitizer detects reads after free.
struct SmallParts
{
	SmallParts();
	static btDefaultCollisionConstructionInfo info();

	btDefaultCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher;
};

/// Rigid bodies that touch no soft body: a box that tumbles on a floor, and one that hangs on a joint.
template <class World>
struct Bystanders
{
	explicit Bystanders( World& to );
	~Bystanders();

	World& world;
	btBoxShape floorShape{ btVector3( 3, 1, 3 ) }, boxShape{ btVector3( btScalar( 0.3 ), btScalar( 0.2 ), btScalar( 0.5 ) ) };
	btRigidBody floor, box, bob;
	btPoint2PointConstraint joint;
};

class RandomCalls
{
public:
	explicit RandomCalls( unsigned seed );
	~RandomCalls();

	void run();
	/// All of its soft bodies are implicit and no time step is irregular: then the bystanders are compared bit for bit.
	bool comparesBystanders() const { return m_isPlain; }
	int calls() const { return m_calls; }
	int removedInCallbacks() const { return m_removed; }

	/// Called from a contact callback with the two objects.
	void contact( const btCollisionObject* a, const btCollisionObject* b );

private:
	using Call = void ( RandomCalls::* )();

	int below( int n ) { return int( m_random() % unsigned( n ) ); }
	bool oneIn( int n ) { return below( n ) == 0; }
	btScalar some( btScalar low, btScalar high ) { return low + ( high - low ) * btScalar( below( 10001 ) ) / 10000; }
	btVector3 someVector( btScalar size );
	btTransform someTransform();
	Material someMaterial();
	int someNode( const SoftBody& body );
	SoftBodyWorld& someWorld() { return *m_worlds[std::size_t( below( int( m_worlds.size() ) ) )]; }
	SoftBody* someSoft();
	btRigidBody* someRigid();
	void removeRigid( btRigidBody* body );
	bool owns( const SoftBody* body ) const;
	void takeIfLeft( SoftBody* body );
	void stepAll( btScalar time, int most );

	void create();
	void add();
	void remove();
	void removeByManifold();
	void destroy();
	void destroyWorld();
	void forgetObjects();
	void step();
	void oddStep();
	void flags();
	void ignore();
	void pins();
	void attach();
	void game();
	void cuts();
	void breaking();
	void material();
	void place();
	void push();
	void rigid();
	void callbacks();
	void features();
	void activation();
	void queries();
	void output();
	void fragments();
	void settings();
	void badNodes();
	void check();

	std::mt19937 m_random;
	bool m_isPlain;
	int m_calls = 0, m_removed = 0;
	Wind m_wind;
	Water m_water;
	std::unique_ptr<SmallParts> m_parts[2];
	std::unique_ptr<btDbvtBroadphase> m_broadphases[2];
	std::unique_ptr<btSequentialImpulseConstraintSolver> m_solvers[2];
	std::vector<std::unique_ptr<SoftBodyWorld>> m_worlds;
	btBoxShape m_floorShape{ btVector3( 4, 1, 4 ) }, m_boxShape{ btVector3( btScalar( 0.2 ), btScalar( 0.15 ), btScalar( 0.2 ) ) };
	struct Rigid
	{
		std::unique_ptr<btRigidBody> body;
		SoftBodyWorld* world = nullptr;
	};
	std::vector<Rigid> m_rigid;
	std::vector<std::unique_ptr<SoftBody>> m_soft;
	std::unique_ptr<Bystanders<SoftBodyWorld>> m_bystanders;
	// The same without soft bodies.
	std::unique_ptr<SmallParts> m_twinParts;
	std::unique_ptr<btDbvtBroadphase> m_twinBroadphase;
	std::unique_ptr<btSequentialImpulseConstraintSolver> m_twinSolver;
	std::unique_ptr<btDiscreteDynamicsWorld> m_twinWorld;
	std::unique_ptr<Bystanders<btDiscreteDynamicsWorld>> m_twin;
};

} // namespace pliant::test
