// Bodies that follow the pose of a skeleton (pliant/game/skeleton.h).

#include "world/test_world.h"

#include <pliant/game/skeleton.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

constexpr float kHeld = std::numeric_limits<float>::infinity();

Material flesh( Elasticity elasticity, float youngsModulus = 2e4f )
{
	Material made = test::stiff( youngsModulus );
	made.elasticity = elasticity;
	made.density = 1000.0f;
	made.damping = 2.0f;
	return made;
}

/// An arm of 1.2 m along x about the origin of its mesh.
std::shared_ptr<const BodyTemplate> arm()
{
	static const std::shared_ptr<const BodyTemplate> made = block( 12, 2, 2, 0.1f );
	return made;
}

/// The mesh positions of an arm's vertices: the skin of a body at the origin.
std::vector<btVector3> verticesOf( SoftBody& body )
{
	const SurfaceView skin = body.surface();
	std::vector<btVector3> vertices;
	for ( int v = 0; v < skin.vertexCount; ++v )
	{
		vertices.emplace_back( skin.positions[3 * v], skin.positions[3 * v + 1], skin.positions[3 * v + 2] );
		vertices.back() += skin.origin;
	}
	return vertices;
}

/// Two bones, the first left of x = 0 and the second right of it, and a box's corners: 2 weights a vertex.
struct TwoBones
{
	std::vector<int> bones;
	std::vector<float> weights;
	SkinWeights view;

	explicit TwoBones( int vertexCount, const std::vector<btVector3>& vertices )
	{
		for ( const btVector3& vertex : vertices )
		{
			const float right = std::min( std::max( float( vertex.x() ) / 0.2f + 0.5f, 0.0f ), 1.0f );
			bones.insert( bones.end(), { 0, 1 } );
			weights.insert( weights.end(), { 1.0f - right, right } );
		}
		view.bones = bones.data();
		view.weights = weights.data();
		view.perVertex = 2;
		view.vertexCount = vertexCount;
		view.boneCount = 2;
	}
};

SoftBody* addArm( TestWorld& test, const Material& material, const PoseSettings& settings, const Adaptivity& adaptivity = {} )
{
	SoftBody* const body = test.addSoft( arm(), btTransform::getIdentity(), material, adaptivity );
	const TwoBones bones( body->bodyTemplate().vertexCount(), verticesOf( *body ) );
	const Status status = followBones( *body, bones.view, settings );
	EXPECT_TRUE( status.ok() ) << status.sentence;
	return body;
}

/// The first bone moves rigidly, the second rotates about z relative to it by `bend`, rad.
void pose( SoftBody& body, const btVector3& root, btScalar bend, bool jumps = false )
{
	const btTransform bones[2] = {
		btTransform( btQuaternion::getIdentity(), root ), btTransform( btQuaternion( btVector3( 0, 0, 1 ), bend ), root ) };
	const Status status = setPose( body, bones, 2, jumps );
	ASSERT_TRUE( status.ok() ) << status.sentence;
}

double farthestFromPose( const SoftBody& body )
{
	std::vector<btVector3> sums( std::size_t( body.nodeCount() ), btVector3( 0, 0, 0 ) );
	std::vector<int> cells( sums.size(), 0 );
	for ( int cell = 0; cell < body.bodyTemplate().cellCount(); ++cell )
	{
		if ( const int node = body.nodeOfCell( cell ); node >= 0 )
		{
			sums[std::size_t( node )] += poseTarget( body, cell );
			++cells[std::size_t( node )];
		}
	}
	double farthest = 0.0;
	for ( std::size_t node = 0; node < sums.size(); ++node )
	{
		farthest = std::max( farthest, double( ( body.nodePosition( int( node ) ) - sums[node] / btScalar( cells[node] ) ).length() ) );
	}
	return farthest;
}

class Following : public testing::TestWithParam<Elasticity>
{};

// Held cells are at their targets, also while these move; with springs they hang a little lower, by g / omega^2.
TEST_P( Following, CellsAreWhereThePoseHasThem )
{
	for ( const float frequency : { kHeld, 4.0f } )
	{
		TestWorld test;
		PoseSettings settings;
		settings.frequency = frequency;
		settings.dampingRatio = 1.0f;
		SoftBody* const body = addArm( test, flesh( GetParam() ), settings );
		double farthest = 0.0;
		for ( int frame = 0; frame < 120; ++frame )
		{
			pose( *body, btVector3( btScalar( 0.5 ) * btScalar( std::sin( frame / 20.0 ) ), 0, 0 ),
				btScalar( 0.8 ) * btScalar( std::sin( frame / 30.0 ) ) );
			test.run( 1 );
			farthest = std::max( farthest, farthestFromPose( *body ) );
		}
		EXPECT_LT( farthest, frequency == kHeld ? 1e-3 : 0.05 );
		EXPECT_TRUE( body->isActive() );
		if ( frequency != kHeld )
		{
			test.run( 240 );
			const double omega = 2.0 * 3.14159265 * double( frequency );
			const double sag = double( poseTarget( *body, 0 ).y() - body->nodePosition( body->nodeOfCell( 0 ) ).y() );
			EXPECT_NEAR( sag, test::kGravity / ( omega * omega ), 0.3 * test::kGravity / ( omega * omega ) );
			EXPECT_NEAR( poseForce( *body ).force.y(), test::kGravity * double( body->mass() ), 0.02 * test::kGravity * body->mass() );
			EXPECT_LT( std::abs( poseForce( *body ).torque.z() ), 0.2 * double( body->mass() ) );
		}
	}
}

// A body comes to rest with any strength and any frequency, also if the pose jumps by metres.
TEST_P( Following, IsStableAtAnyStrength )
{
	for ( const float frequency : { 3.0f, 50.0f, 1000.0f, kHeld } )
	{
		for ( const float youngsModulus : { 1e3f, 1e6f } )
		{
			TestWorld test;
			PoseSettings settings;
			settings.frequency = frequency;
			settings.paint = []( const float* point, void* ) { return PosePaint{ point[0] < 0 ? 1.0f : 0.05f }; };
			SoftBody* const body = addArm( test, flesh( GetParam(), youngsModulus ), settings );
			pose( *body, btVector3( 0, 0, 0 ), 0 );
			test.run( 20 );
			pose( *body, btVector3( 1, 2, 0 ), btScalar( 0.5 ) );
			test.run( 600 );
			double fastest = 0.0;
			for ( int node = 0; node < body->nodeCount(); ++node )
			{
				fastest = std::max( fastest, double( body->nodeVelocity( node ).length() ) );
			}
			EXPECT_LT( fastest, 0.05 ) << frequency << " Hz, E " << youngsModulus;
			EXPECT_EQ( test.world.stepReport().quarantined, 0 );
		}
	}
}

// A blend of 0 releases the body with the velocity of the pose; at 1 it returns to the pose.
TEST_P( Following, ABlendOfZeroHandsOver )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	PoseSettings settings;
	settings.frequency = kHeld;
	SoftBody* const body = addArm( test, flesh( GetParam() ), settings );
	for ( int frame = 0; frame < 30; ++frame )
	{
		pose( *body, btVector3( btScalar( frame ) * btScalar( 0.05 ), 0, 0 ), 0 ); // 3 m/s
		test.run( 1 );
	}
	EXPECT_NEAR( body->linearVelocity().x(), 3, 0.01 );
	ASSERT_TRUE( setPoseBlend( *body, 0 ).ok() );
	const btScalar x = body->massCentre().x();
	test.run( 60 );
	EXPECT_NEAR( body->linearVelocity().x(), 3, 0.01 );
	EXPECT_NEAR( body->massCentre().x() - x, 3, 0.01 );
	EXPECT_EQ( poseForce( *body ).force.length(), 0 );
	ASSERT_TRUE( setPoseBlend( *body, btScalar( 0.5 ) ).ok() );
	test.run( 120 );
	EXPECT_LT( farthestFromPose( *body ), 0.01 );
	stopFollowing( *body );
	EXPECT_FALSE( isFollowing( *body ) );
	test.run( 10 );
	EXPECT_EQ( poseBlend( *body ), 0 );
}

// A painted distance limits the displacement that a weak spring allows.
TEST_P( Following, StaysWithinTheLargestDistance )
{
	TestWorld test;
	PoseSettings settings;
	settings.frequency = 0.3f; // without that limit it would sag by 2.8 m
	settings.dampingRatio = 1.0f;
	settings.paint = []( const float*, void* ) { return PosePaint{ 1.0f, 0.1f }; };
	SoftBody* const body = addArm( test, flesh( GetParam() ), settings );
	for ( int frame = 0; frame < 180; ++frame )
	{
		pose( *body, btVector3( btScalar( frame ) * btScalar( 0.02 ), 0, 0 ), 0 );
		test.run( 1 );
		EXPECT_LT( farthestFromPose( *body ), 0.115 ) << frame;
	}
	EXPECT_GT( farthestFromPose( *body ), 0.09 );
}

// A box of a tenth of the mass lies on the arm and bends it; an arm that is held carries it like a rigid one, and throws it off.
TEST_P( Following, PushesAndIsPushed )
{
	TestWorld test;
	PoseSettings settings;
	settings.frequency = 3.0f;
	settings.dampingRatio = 1.0f;
	SoftBody* const body = addArm( test, flesh( GetParam() ), settings );
	pose( *body, btVector3( 0, 0, 0 ), 0 );
	test.run( 120 );
	const btScalar sagBefore = body->massCentre().y();
	btRigidBody* const box = test.addBox( 10, btVector3( 0.2f, 0.1f, 0.1f ), at( 0, btScalar( 0.3 ), 0 ) );
	test.run( 240 );
	EXPECT_LT( body->massCentre().y(), sagBefore - 0.001 );
	EXPECT_NEAR( poseForce( *body ).force.y(), test::kGravity * double( body->mass() + 10 ), 0.05 * test::kGravity * body->mass() );
	EXPECT_GT( box->getWorldTransform().getOrigin().y(), 0.1 );
	for ( int frame = 0; frame < 30; ++frame )
	{
		pose( *body, btVector3( 0, btScalar( frame ) * btScalar( 0.05 ), 0 ), 0 );
		test.run( 1 );
	}
	EXPECT_GT( box->getLinearVelocity().y(), 1.5 );
}

// Targets follow the material when levels change and when the body breaks.
TEST_P( Following, KeepsTargetsThroughLevelsAndFracture )
{
	TestWorld test;
	PoseSettings settings;
	settings.frequency = kHeld;
	Adaptivity adaptivity;
	adaptivity.coarseLevels = GetParam() == Elasticity::Explicit ? 1 : 0;
	SoftBody* const body = addArm( test, flesh( GetParam() ), settings, adaptivity );
	pose( *body, btVector3( 0, 0, 0 ), btScalar( 0.3 ), true );
	test.run( 30 );
	for ( int level = adaptivity.coarseLevels; level >= 0; --level )
	{
		body->setFinestLevel( level );
		body->requestRefinement( btVector3( -9, -9, -9 ), btVector3( 9, 9, 9 ) );
		pose( *body, btVector3( 0, btScalar( 0.1 ) * btScalar( level ), 0 ), btScalar( 0.3 ) );
		test.run( 60 );
		EXPECT_NEAR( body->massCentre().y(), 0.1 * level + 0.044, 0.02 ) << level;
	}
	ASSERT_GT( body->cutPlane( btVector3( 0, 0, 0 ), btVector3( 1, 0, 0 ) ), 0 );
	test.run( 10 );
	ASSERT_EQ( test.world.softBodyCount(), 2 );
	for ( int k = 0; k < 2; ++k )
	{
		SoftBody& piece = *test.world.softBody( k );
		ASSERT_TRUE( isFollowing( piece ) );
		pose( piece, btVector3( 0, 1, 0 ), btScalar( 0.3 ) );
	}
	test.run( 30 );
	for ( int k = 0; k < 2; ++k )
	{
		// Nodes of so small pieces do not merge: the fine ones of explicit pieces sag by 3 mm.
		EXPECT_LT( farthestFromPose( *test.world.softBody( k ) ), GetParam() == Elasticity::Explicit ? 4e-3 : 2e-3 );
	}
	ASSERT_TRUE( setPoseBlend( *test.world.softBody( 1 ), 0 ).ok() ); // each separately
	test.run( 30 );
	EXPECT_LT( farthestFromPose( *test.world.softBody( 0 ) ), 2e-3 );
	EXPECT_GT( farthestFromPose( *test.world.softBody( 1 ) ), 0.5 );
}

INSTANTIATE_TEST_SUITE_P( Steps, Following, testing::Values( Elasticity::Explicit, Elasticity::Implicit ),
	[]( const auto& step ) { return std::string( step.param == Elasticity::Implicit ? "Implicit" : "Explicit" ); } );

// Targets of the game's own, and sleep while they do not move.
TEST( Skeleton, FollowsGivenTargets )
{
	TestWorld test;
	SoftBody* const body = test.addSoft( arm(), btTransform::getIdentity(), flesh( Elasticity::Explicit ) );
	PoseSettings settings;
	settings.dampingRatio = 1.0f;
	ASSERT_TRUE( followTargets( *body, settings ).ok() );
	std::vector<btVector3> targets;
	for ( int cell = 0; cell < body->bodyTemplate().cellCount(); ++cell )
	{
		targets.push_back( body->nodePosition( body->nodeOfCell( cell ) ) + btVector3( 0, 1, 0 ) );
	}
	ASSERT_TRUE( setTargets( *body, targets.data(), int( targets.size() ) ).ok() );
	test.run( 400 );
	EXPECT_NEAR( body->massCentre().y(), 1, 0.03 );
	EXPECT_FALSE( body->isActive() );
	ASSERT_TRUE( setTargets( *body, targets.data(), int( targets.size() ) ).ok() );
	EXPECT_FALSE( body->isActive() ); // nothing new
	// Targets are shifted with the origin of the world.
	ASSERT_TRUE( test.world.shiftOrigin( btVector3( 64, 0, 0 ) ).ok() );
	body->activate( true );
	test.run( 30 );
	EXPECT_NEAR( body->massCentre().x(), 64, 0.03 );
	EXPECT_NEAR( body->massCentre().y(), 1, 0.03 );
	targets[0] += btVector3( 0, btScalar( 0.1 ), 0 );
	ASSERT_TRUE( setTargets( *body, targets.data(), int( targets.size() ) ).ok() );
	EXPECT_TRUE( body->isActive() );
}

TEST( Skeleton, RefusesBadArguments )
{
	TestWorld test;
	SoftBody* const body = test.addSoft( arm(), btTransform::getIdentity(), flesh( Elasticity::Explicit ) );
	const TwoBones good( body->bodyTemplate().vertexCount(), verticesOf( *body ) );
	const auto refuses = [body]( const SkinWeights& weights, const PoseSettings& settings, ResultCode code ) {
		const Status status = followBones( *body, weights, settings );
		EXPECT_EQ( status.code, code );
		EXPECT_FALSE( status.sentence.empty() );
		EXPECT_FALSE( isFollowing( *body ) );
	};
	const btTransform bones[2] = { btTransform::getIdentity(), btTransform::getIdentity() };
	const std::vector<btVector3> targets( std::size_t( body->bodyTemplate().cellCount() ), btVector3( 0, 0, 0 ) );
	EXPECT_EQ( setPose( *body, bones, 2 ).code, ResultCode::BadArgument ); // follows nothing
	EXPECT_EQ( setTargets( *body, targets.data(), int( targets.size() ) ).code, ResultCode::BadArgument );
	EXPECT_EQ( setPoseBlend( *body, 1 ).code, ResultCode::BadArgument );
	stopFollowing( *body );

	SkinWeights weights = good.view;
	weights.bones = nullptr;
	refuses( weights, {}, ResultCode::BadArgument );
	weights = good.view;
	weights.weights = nullptr;
	refuses( weights, {}, ResultCode::BadArgument );
	weights = good.view;
	weights.perVertex = 5;
	refuses( weights, {}, ResultCode::BadArgument );
	weights = good.view;
	weights.boneCount = 1; // bone 1 has weights
	refuses( weights, {}, ResultCode::BadArgument );
	weights = good.view;
	--weights.vertexCount;
	refuses( weights, {}, ResultCode::BadArgument );
	for ( const float bad : { -1.0f, NAN, std::numeric_limits<float>::infinity(), 0.0f } )
	{
		TwoBones wrong = good;
		wrong.weights[0] = wrong.weights[1] = bad;
		wrong.view.weights = wrong.weights.data();
		refuses( wrong.view, {}, ResultCode::BadArgument );
	}
	PoseSettings settings;
	for ( const float bad : { 0.0f, -1.0f, NAN } )
	{
		settings.frequency = bad;
		refuses( good.view, settings, ResultCode::BadSettings );
		EXPECT_EQ( followTargets( *body, settings ).code, ResultCode::BadSettings );
	}
	settings = {};
	settings.dampingRatio = -1.0f;
	refuses( good.view, settings, ResultCode::BadSettings );
	settings = {};
	settings.paint = []( const float*, void* ) { return PosePaint{ 2.0f }; };
	refuses( good.view, settings, ResultCode::BadSettings );
	settings.paint = []( const float*, void* ) { return PosePaint{ 1.0f, 0.0f }; };
	refuses( good.view, settings, ResultCode::BadSettings );
}

TEST( Skeleton, RefusesBadPoses )
{
	TestWorld test;
	SoftBody* const body = test.addSoft( arm(), btTransform::getIdentity(), flesh( Elasticity::Explicit ) );
	const TwoBones good( body->bodyTemplate().vertexCount(), verticesOf( *body ) );
	const btTransform bones[2] = { btTransform::getIdentity(), btTransform::getIdentity() };
	const std::vector<btVector3> targets( std::size_t( body->bodyTemplate().cellCount() ), btVector3( 0, 0, 0 ) );
	ASSERT_TRUE( followBones( *body, good.view ).ok() );
	btTransform bad[2] = { btTransform::getIdentity(), btTransform::getIdentity() };
	bad[1].setOrigin( btVector3( NAN, 0, 0 ) );
	EXPECT_EQ( setPose( *body, bad, 2 ).code, ResultCode::BadArgument );
	EXPECT_EQ( setPose( *body, bones, 1 ).code, ResultCode::BadArgument );
	EXPECT_EQ( setPose( *body, nullptr, 2 ).code, ResultCode::BadArgument );
	EXPECT_EQ( setTargets( *body, targets.data(), int( targets.size() ) ).code, ResultCode::BadArgument ); // follows bones
	EXPECT_EQ( setPoseBlend( *body, btScalar( 1.5 ) ).code, ResultCode::BadArgument );
	EXPECT_EQ( setPoseBlend( *body, NAN ).code, ResultCode::BadArgument );
	EXPECT_EQ( poseTarget( *body, -1 ), btVector3( 0, 0, 0 ) );
	EXPECT_EQ( poseTarget( *body, 0 ), btVector3( 0, 0, 0 ) ); // no pose yet
	ASSERT_TRUE( followTargets( *body ).ok() );
	EXPECT_EQ( setPose( *body, bones, 2 ).code, ResultCode::BadArgument );
	EXPECT_EQ( setTargets( *body, targets.data(), 1 ).code, ResultCode::BadArgument );
	EXPECT_EQ( setTargets( *body, nullptr, int( targets.size() ) ).code, ResultCode::BadArgument );
	test.run( 5 ); // without a pose no spring acts on it
	EXPECT_EQ( poseForce( *body ).force.length(), 0 );
}

} // namespace
} // namespace pliant
