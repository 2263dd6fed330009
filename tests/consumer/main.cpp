// A stranger's project: a soft cube in its own world class, built against the installed library alone.
#include <pliant/soft_body_world.h>
#include <pliant/version.h>

#include <btBulletDynamicsCommon.h>

#include <cstdio>

// Games subclass worlds, with or without run-time type information.
class CountingWorld : public pliant::SoftBodyWorld
{
public:
	using SoftBodyWorld::SoftBodyWorld;
	int steps = 0;

protected:
	void internalSingleStepSimulation( btScalar timeStep ) override
	{
		++steps;
		SoftBodyWorld::internalSingleStepSimulation( timeStep );
	}
};

int main()
{
	btDefaultCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher( &configuration );
	btDbvtBroadphase broadphase;
	btSequentialImpulseConstraintSolver solver;
	CountingWorld world( &dispatcher, &broadphase, &solver, &configuration );

	const float corners[] = { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1 };
	const std::uint32_t triangles[] = {
		2, 1, 0, 3, 2, 0, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 2, 3, 7, 2, 7, 6, 1, 2, 6, 1, 6, 5, 0, 4, 7, 0, 7, 3 };
	pliant::LatticeSettings settings;
	settings.cellSize = 0.25f;
	const auto cube = pliant::BodyTemplate::build( pliant::MeshView{ corners, 8, 3, triangles, 12 }, settings );
	const auto body = pliant::SoftBody::create( cube.value, btTransform::getIdentity() );
	if ( !body.ok() )
	{
		std::puts( body.status.sentence.c_str() );
		return 1;
	}
	world.addSoftBody( body.value.get() );
	const double before = body.value->nodePosition( 0 ).y();
	for ( int step = 0; step < 60; ++step )
		world.stepSimulation( btScalar( 1 ) / 60 );
	const double fallen = before - double( body.value->nodePosition( 0 ).y() );
	world.removeSoftBody( body.value.get() );

	std::printf( "pliant %d.%d.%d, %d bytes a btScalar: node 0 fell %.3f m in 1 s, %d steps\n", PLIANT_VERSION_MAJOR, PLIANT_VERSION_MINOR,
		PLIANT_VERSION_PATCH, int( sizeof( btScalar ) ), fallen, world.steps );
	return fallen > 4.5 && fallen < 5.5 && world.steps > 0 ? 0 : 1; // g / 2 is 4.9 m
}
