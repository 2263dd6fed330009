// A soft cube falls on a rigid box: a whole program. Build it with find_package( pliant ) and the target pliant::pliant.
#include <pliant/pliant.h>

#include <btBulletDynamicsCommon.h>

#include <cstdio>

int main()
{
	btDefaultCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher( &configuration );
	btDbvtBroadphase broadphase;
	btSequentialImpulseConstraintSolver solver;
	pliant::SoftBodyWorld world( &dispatcher, &broadphase, &solver, &configuration ); // instead of btDiscreteDynamicsWorld

	btBoxShape boxShape( btVector3( 2, 1, 2 ) ); // its top is at y = 1
	btRigidBody box( btRigidBody::btRigidBodyConstructionInfo( 0, nullptr, &boxShape ) );
	world.addRigidBody( &box );

	const float corners[] = { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1 };
	const std::uint32_t triangles[] = {
		2, 1, 0, 3, 2, 0, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 2, 3, 7, 2, 7, 6, 1, 2, 6, 1, 6, 5, 0, 4, 7, 0, 7, 3 };
	const pliant::MeshView mesh = { corners, 8, 3, triangles, 12 };
	const auto cube = pliant::BodyTemplate::build( mesh );
	const auto body = pliant::SoftBody::create( cube.value, btTransform( btQuaternion::getIdentity(), btVector3( 0, 2, 0 ) ) );
	if ( !body.ok() )
	{
		std::puts( cube.ok() ? body.status.sentence.c_str() : cube.status.sentence.c_str() );
		return 1;
	}
	world.addSoftBody( body.value.get() );
	for ( int step = 0; step < 180; ++step )
	{
		world.stepSimulation( btScalar( 1 ) / 60 );
		std::printf( "%.3f s: mass centre at %.3f m\n", ( step + 1 ) / 60.0, double( body.value->massCentre().y() ) );
	}
	world.removeSoftBody( body.value.get() );
	return body.value->massCentre().y() > btScalar( 1.3 ) ? 0 : 1; // it rests on the box
}
