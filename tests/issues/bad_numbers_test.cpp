// Invalid arguments are refused by the call itself with a code and a message, and the body continues unaffected.

#include "world/test_world.h"

#include <cmath>
#include <functional>
#include <limits>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

const btScalar kNan = std::numeric_limits<btScalar>::quiet_NaN(), kInfinity = std::numeric_limits<btScalar>::infinity();

std::vector<btVector3> positionsOf( const SoftBody& body )
{
	std::vector<btVector3> positions;
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		positions.push_back( body.nodePosition( i ) );
	}
	return positions;
}

/// Returns the positions of a cube, one second after it began to fall on the floor, with the calls of `ask` in between.
std::vector<btVector3> fallen( const std::function<void( SoftBody& )>& call )
{
	TestWorld t;
	t.addFloor();
	SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, btScalar( 0.5 ), 0 ) );
	t.run( 20 );
	call( *cube );
	t.run( 40 );
	EXPECT_TRUE( cube->isHealthy() );
	return positionsOf( *cube );
}

void expectEqual( const std::vector<btVector3>& a, const std::vector<btVector3>& b, const char* what )
{
	ASSERT_EQ( a.size(), b.size() );
	for ( std::size_t k = 0; k < a.size(); ++k )
	{
		ASSERT_EQ( ( a[k] - b[k] ).length(), 0 ) << what;
	}
}

// Results of a division by zero may reach the body's calls; the body must continue bit-identically.
TEST( BadNumbers, AreRefusedByTheCallAndTheBodyContinuesBitIdentically )
{
	const std::vector<btVector3> alone = fallen( []( SoftBody& ) {} );
	const std::vector<btVector3> asked = fallen( []( SoftBody& body ) {
		const btVector3 bads[] = { btVector3( kNan, 0, 0 ), btVector3( 0, kInfinity, 0 ), btVector3( 0, 0, -kInfinity ),
			btVector3( 0, std::numeric_limits<float>::max(), 0 ) };
		for ( const btVector3& bad : bads )
		{
			const Status answers[] = { body.setLinearVelocity( bad ), body.setVelocities( bad, btVector3( 0, 0, 0 ) ),
				body.setVelocities( btVector3( 0, 0, 0 ), bad ), body.applyCentralForce( bad ), body.applyForce( bad, 3 ),
				body.applyCentralImpulse( bad ), body.applyImpulse( bad, 3 ), body.setGravity( bad ), body.driveNode( 3, bad ),
				body.teleport( btTransform( btQuaternion::getIdentity(), bad ) ),
				body.reset( btTransform( btQuaternion::getIdentity(), bad ) ) };
			for ( const Status& answer : answers )
			{
				EXPECT_EQ( answer.code, ResultCode::BadArgument );
				EXPECT_FALSE( answer.sentence.empty() );
			}
			if ( !std::isfinite( bad.length() ) )
			{
				EXPECT_EQ(
					body.cutPlane( bad, btVector3( 0, 1, 0 ) ) + body.cutPlane( btVector3( 0, 0, 0 ), bad ) + body.cutSphere( bad, 1 ), 0 );
				EXPECT_EQ( body.cutSweep( bad, bad, bad, bad ), 0 );
				EXPECT_EQ( body.pinNodesInside( bad, bad ), 0 );
			}
		}
		EXPECT_EQ(
			body.cutPlane( body.massCentre(), btVector3( 0, 1, 0 ), kNan ) + body.cutSphere( body.massCentre(), kNan ) + body.heal( kNan ),
			0 );
	} );
	expectEqual( alone, asked, "refused calls" );
}

// A node index kept across a cut may be out of range.
TEST( BadNumbers, NodeIndicesOutOfRangeAreRefused )
{
	const std::vector<btVector3> alone = fallen( []( SoftBody& ) {} );
	const std::vector<btVector3> asked = fallen( []( SoftBody& body ) {
		for ( const int node : { -1, body.nodeCount(), std::numeric_limits<int>::max(), std::numeric_limits<int>::min() } )
		{
			EXPECT_EQ( body.applyForce( btVector3( 1, 0, 0 ), node ).code, ResultCode::BadArgument );
			EXPECT_EQ( body.applyImpulse( btVector3( 1, 0, 0 ), node ).code, ResultCode::BadArgument );
			EXPECT_EQ( body.pinNode( node ).code, ResultCode::BadArgument );
			EXPECT_EQ( body.driveNode( node, btVector3( 0, 0, 0 ) ).code, ResultCode::BadArgument );
			EXPECT_EQ( body.pinNodeToBody( node, nullptr ).code, ResultCode::BadArgument );
			body.releaseNode( node );
			EXPECT_FALSE( body.isPinned( node ) );
			EXPECT_EQ( body.nodeOfShapeIndex( node ), -1 );
			EXPECT_EQ( body.nodeOfCell( node ), -1 );
#ifdef NDEBUG // with assertions these abort the program at the mistake
			EXPECT_EQ(
				body.nodePosition( node ).length() + body.nodeVelocity( node ).length() + body.nodeMass( node ) + body.nodeRadius( node ),
				0 );
			EXPECT_EQ( body.nodeLevel( node ), 0 );
#endif
		}
	} );
	expectEqual( alone, asked, "refused calls" );
}

// Transforms with a scale, as level editors make them, are refused with a code.
TEST( BadNumbers, AScaleInATransformIsRefusedWithACode )
{
	TestWorld t;
	const auto shape = block( 3, 3, 3, 0.1f );
	SoftBody* cube = t.addSoft( shape, at( 0, 1, 0 ) );
	const std::vector<btVector3> before = positionsOf( *cube );
	btTransform scaled = at( 0, 2, 0 ), sheared = at( 0, 2, 0 ), mirrored = at( 0, 2, 0 ),
				drifted( btQuaternion( btVector3( 0, 1, 0 ), 1 ), btVector3( 0, 2, 0 ) );
	scaled.setBasis( scaled.getBasis().scaled( btVector3( 2, 2, 2 ) ) );
	sheared.getBasis()[0][1] = btScalar( 0.5 );
	mirrored.getBasis()[2][2] = -1;
	for ( const btTransform& bad : { scaled, sheared, mirrored } )
	{
		const Status made = SoftBody::create( shape, bad ).status;
		EXPECT_EQ( made.code, ResultCode::BadArgument );
		EXPECT_NE( made.sentence.find( "scale" ), std::string::npos ) << made.sentence;
		EXPECT_EQ( cube->teleport( bad ).code, ResultCode::BadArgument );
		EXPECT_EQ( cube->reset( bad ).code, ResultCode::BadArgument );
	}
	expectEqual( positionsOf( *cube ), before, "a refused position" );
	drifted.setBasis( drifted.getBasis().scaled( btVector3( 1, btScalar( 1.001 ), 1 ) ) ); // rounding error of many products
	EXPECT_TRUE( cube->teleport( drifted ).ok() );
	EXPECT_TRUE( cube->reset( drifted ).ok() );
}

// A drag target far outside the window must not move a node out of the simulated range.
TEST( BadNumbers, ANodeIsNotDrivenArbitrarilyFar )
{
	TestWorld t;
	SoftBody* cube = t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 1, 0 ) );
	for ( const btScalar far : { btScalar( 100 ), btScalar( 1e6 ), btScalar( 1e30 ) } )
	{
		EXPECT_EQ( cube->driveNode( 13, btVector3( far, 0, 0 ) ).code, ResultCode::BadArgument );
		EXPECT_FALSE( cube->isPinned( 13 ) );
	}
	for ( const Elasticity step : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		Material material = test::stiff( 1e5f );
		material.elasticity = step;
		ASSERT_TRUE( cube->setMaterial( material ).ok() );
		ASSERT_TRUE( cube->reset( at( 0, 1, 0 ) ).ok() );
		ASSERT_TRUE( cube->driveNode( 13, btVector3( 40, 1, 0 ) ).ok() );
		t.run( 1 );
		EXPECT_LT( ( cube->nodePosition( 13 ) - btVector3( 40, 1, 0 ) ).length(), btScalar( 1e-4 ) );
		t.run( 300 );
		EXPECT_TRUE( cube->isHealthy() ) << "up to a hundred body sizes";
		cube->releaseNode( 13 );
		t.run( 5 );
		EXPECT_TRUE( cube->isHealthy() );
	}
}

/// The centre of a cube on the floor after steps of irregular length, and that of a rigid box next to it.
struct Stood
{
	btScalar soft, rigid, side;
};
Stood stoodThrough( Elasticity elasticity, const std::vector<std::pair<btScalar, int>>& steps )
{
	TestWorld t;
	t.addPlane();
	btRigidBody* box = t.addBox( 10, btVector3( 0.2f, 0.2f, 0.2f ), at( 3, btScalar( 0.2 ), 0 ) );
	Material material = test::stiff( 1e5f );
	material.elasticity = elasticity;
	SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, btScalar( 0.2 ), 0 ), material );
	t.run( 60 );
	for ( const auto& [step, most] : steps )
	{
		t.world.stepSimulation( step, most );
	}
	t.run( 240 );
	EXPECT_TRUE( cube->isHealthy() );
	btVector3 low, high;
	cube->getCollisionShape()->getAabb( cube->getWorldTransform(), low, high );
	return { cube->massCentre().y(), box->getWorldTransform().getOrigin().y(), high.x() - low.x() };
}

// A clock may give NaN, infinity, negative times, or the hundred seconds that a laptop has slept.
TEST( BadNumbers, OddTimeStepsAreRefusedOrCutShort )
{
	const std::vector<std::pair<btScalar, int>> odd[] = { { { kNan, 0 }, { kNan, 4 } }, { { kInfinity, 0 }, { kInfinity, 4 } },
		{ { -kInfinity, 0 }, { btScalar( -1 ), 0 } }, { { btScalar( 1e30 ), 4 } }, { { btScalar( 100 ), 0 } },
		{ { btScalar( 100 ), 0 }, { kNan, 3 }, { btScalar( 1e9 ), 0 }, { btScalar( 0.5 ), 0 }, { btScalar( 0.2 ), 0 } } };
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		for ( const auto& steps : odd )
		{
			const Stood stood = stoodThrough( elasticity, steps );
			EXPECT_NEAR( stood.soft, 0.2, 0.02 ) << steps[0].first;
			EXPECT_NEAR( stood.side, 0.4, 0.1 ) << steps[0].first;
			EXPECT_NEAR( stood.rigid, 0.2, 0.03 ) << steps[0].first;
		}
	}
}

TEST( BadNumbers, AnInvalidFixedTimeStepDoesNothing )
{
	TestWorld t;
	SoftBody* cube = t.addSoft( block( 2, 2, 2, 0.1f ), at( 0, 1, 0 ) );
	for ( const btScalar bad : { btScalar( 0 ), btScalar( -1 ), kNan, kInfinity } )
	{
		EXPECT_EQ( t.world.stepSimulation( test::kFrame, 4, bad ), 0 );
	}
	EXPECT_EQ( cube->linearVelocity().length(), 0 );
	EXPECT_EQ( t.world.softBody( -1 ), nullptr );
	EXPECT_EQ( t.world.softBody( 1 ), nullptr );
	EXPECT_EQ( t.world.softBody( 0 ), cube );
}

} // namespace
} // namespace pliant
