// Runs with a library that was built without some of its features: the other features work, and missing ones are refused with a sentence.
// Arguments: the missing features.

#include <pliant/build.h>
#include <pliant/soft_body_world.h>

#include <btBulletDynamicsCommon.h>

#include <cstdio>
#include <set>
#include <string>

namespace {

class Checks
{
public:
	void expect( bool isSo, const char* what )
	{
		if ( !isSo )
		{
			std::printf( "options: NOT SO: %s\n", what );
			++m_failures;
		}
	}

	/// Refused with the feature's name if it is missing, accepted otherwise.
	void expectAnswer( pliant::Feature feature, const pliant::Status& status )
	{
		const bool isRight = pliant::hasFeature( feature )
			? status.ok()
			: status.sentence.find( std::string( "without " ) + toString( feature ) ) != std::string::npos;
		if ( !isRight )
		{
			std::printf( "options: %s answered \"%s\"\n", toString( feature ), status.sentence.c_str() );
			++m_failures;
		}
	}

	int failures() const { return m_failures; }

private:
	int m_failures = 0;
};

struct Cube
{
	float positions[24];
	std::uint32_t indices[36] = {
		0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };

	Cube()
	{
		for ( int corner = 0; corner < 8; ++corner )
		{
			for ( int axis = 0; axis < 3; ++axis )
			{
				positions[3 * corner + axis] = ( corner >> axis & 1 ) ? 0.5f : -0.5f;
			}
		}
	}
	pliant::MeshView view() const { return { positions, 8, 3, indices, 12 }; }
};

struct Scene
{
	btDefaultCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher{ &configuration };
	btDbvtBroadphase broadphase;
	btSequentialImpulseConstraintSolver solver;
	pliant::SoftBodyWorld world{ &dispatcher, &broadphase, &solver, &configuration };
	btStaticPlaneShape plane{ btVector3( 0, 1, 0 ), 0 };
	btRigidBody ground{ btScalar( 0 ), nullptr, &plane };

	Scene() { world.addRigidBody( &ground ); }
	~Scene() { world.removeRigidBody( &ground ); }
};

using Template = std::shared_ptr<const pliant::BodyTemplate>;

/// Drops a body with all features that are available.
void fall( Checks& checks, const Template& shape, const pliant::Material& material, const pliant::Adaptivity& levels )
{
	Scene scene;
	auto made = pliant::SoftBody::create(
		shape, btTransform( btQuaternion::getIdentity(), btVector3( 0, btScalar( 0.8 ), 0 ) ), material, levels );
	checks.expect( made.ok(), "a body is made" );
	if ( !made )
	{
		std::printf( "options: %s\n", made.status.sentence.c_str() );
		return;
	}
	pliant::SoftBody& body = *made.value;
	scene.world.addSoftBody( &body );
	pliant::Fracture fracture;
	fracture.rule = pliant::BreakRule::Distance;
	checks.expectAnswer( pliant::Feature::Fracture, body.setFracture( fracture ) );
	checks.expectAnswer( pliant::Feature::SelfCollision, body.setSelfCollision( true ) );
	checks.expect( body.selfCollision() == pliant::hasFeature( pliant::Feature::SelfCollision ), "self-collision is on where it is there" );
	for ( int k = 0; k < 120; ++k )
	{
		scene.world.stepSimulation( btScalar( 1.0 / 60 ), 0 );
	}
	const bool wasCut = body.cutPlane( body.massCentre(), btVector3( 1, 0, 0 ) ) > 0;
	checks.expect( wasCut == pliant::hasFeature( pliant::Feature::Fracture ), "it is cut where it can be" );
	for ( int k = 0; k < 60; ++k )
	{
		scene.world.stepSimulation( btScalar( 1.0 / 60 ), 0 );
	}
	checks.expect(
		body.isHealthy() && body.massCentre().y() > btScalar( 0.3 ) && body.massCentre().y() < btScalar( 0.6 ), "it lies on the ground" );
	const bool hasSkin = body.surface().vertexCount > 0;
	checks.expect( hasSkin == pliant::hasFeature( pliant::Feature::Surface ), "it has a skin where there are skins" );
	scene.world.removeSoftBody( &body );
}

pliant::Status createStatus( const Template& shape, const pliant::Material& material, const pliant::Adaptivity& levels = {} )
{
	return pliant::SoftBody::create( shape, btTransform::getIdentity(), material, levels ).status;
}

void testAll( Checks& checks )
{
	using pliant::Feature;
	const Cube cube;
	pliant::LatticeSettings settings;
	settings.targetCells = 216;
	checks.expectAnswer( Feature::Surface, pliant::BodyTemplate::build( cube.view(), settings ).status );
	settings.skinning = pliant::hasFeature( Feature::Surface ) ? pliant::Skinning::NearbyNodes : pliant::Skinning::None;
	const auto shape = pliant::BodyTemplate::build( cube.view(), settings );
	checks.expect( shape.ok(), "a template is built" );

	pliant::Material plain;
	plain.youngsModulus = 2e5f;
	pliant::Material plastic = plain, implicit = plain, far = plain, cluster = plain;
	plastic.yieldStrain = 0.1f;
	checks.expectAnswer( Feature::Plasticity, createStatus( shape.value, plastic ) );
	implicit.elasticity = pliant::Elasticity::Implicit;
	checks.expect( createStatus( shape.value, implicit ).ok(), "a body steps implicitly" );
	far.farLevels = 1;
	checks.expectAnswer( Feature::FarLevels, createStatus( shape.value, far ) );
	cluster.method = pliant::Method::SingleCluster;
	checks.expectAnswer( Feature::Clusters, createStatus( shape.value, cluster ) );
	pliant::Adaptivity levels;
	levels.coarseLevels = 1;
	levels.refineStrain = 0.1f;
	checks.expectAnswer( Feature::Levels, createStatus( shape.value, plain, levels ) );

	fall( checks, shape.value, plain, {} );
	plain.elasticity = pliant::Elasticity::Automatic;
	fall( checks, shape.value, plain, pliant::hasFeature( Feature::Levels ) ? levels : pliant::Adaptivity() );
	if ( pliant::hasFeature( Feature::Plasticity ) )
	{
		fall( checks, shape.value, plastic, pliant::hasFeature( Feature::Levels ) ? levels : pliant::Adaptivity() );
	}
	fall( checks, shape.value, implicit, {} );
	if ( pliant::hasFeature( Feature::FarLevels ) )
	{
		fall( checks, shape.value, far, {} );
	}
}

} // namespace

int main( int count, char** words )
{
	Checks checks;
	const std::set<std::string> missing( words + 1, words + count );
	for ( int k = 0; k < pliant::kFeatureCount; ++k )
	{
		const pliant::Feature feature = pliant::Feature( k );
		checks.expect( pliant::hasFeature( feature ) != ( missing.count( toString( feature ) ) > 0 ), toString( feature ) );
	}
	testAll( checks );
	std::printf( "options: %d features missing: %s\n", int( missing.size() ), checks.failures() == 0 ? "as it should be" : "FAILED" );
	return checks.failures() == 0 ? 0 : 1;
}
