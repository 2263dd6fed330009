// Bodies that break into shards in a world: pieces, events, the drawn faces, and the world's budget of debris.

#include "world/bodies/soft_body_impl.h"
#include "world/test_world.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::stiff;
using test::TestWorld;

constexpr float kCell = 0.05f;

Fracture shards( float size, float strain )
{
	Fracture fracture;
	fracture.rule = BreakRule::Shards;
	fracture.breakStrain = strain;
	fracture.shardSize = size;
	return fracture;
}

btTransform tilted( btScalar x, btScalar y )
{
	return btTransform( btQuaternion( btVector3( 0, 0, 1 ), btScalar( 0.3 ) ), btVector3( x, y, 0 ) );
}

/// A block that is thrown at the floor, an edge first.
struct Thrown
{
	TestWorld test;
	SoftBody* body = nullptr;

	explicit Thrown( const Fracture& fracture, int threads = 1 )
	{
		test.world.setThreadCount( threads );
		test.addFloor();
		body = throwAnother( fracture, 0 );
	}

	SoftBody* throwAnother( const Fracture& fracture, btScalar x )
	{
		SoftBody* const soft = test.addSoft( block( 10, 10, 10, kCell ), tilted( x, btScalar( 0.6 ) ), stiff( 2e6f ) );
		EXPECT_TRUE( soft->setFracture( fracture ).ok() );
		EXPECT_TRUE( soft->setVelocities( btVector3( 0, -15, 0 ), btVector3( 1, 2, 1 ) ).ok() );
		return soft;
	}
};

TEST( Shards, AThrownBlockBreaksIntoTensOfPiecesWithFewCrumbs )
{
	Fracture fracture = shards( 0.15f, 0.01f );
	fracture.crumbFraction = 0.05f;
	Thrown scene( fracture );
	int links = 0, events = 0;
	for ( int frame = 0; frame < 60; ++frame )
	{
		scene.test.run( 1 );
		links += scene.test.world.stepReport().brokenLinks;
		for ( const FractureEvent& event : scene.test.world.fractureEvents() )
		{
			++events;
			EXPECT_GT( event.area, 0.0 );
			EXPECT_GT( event.energy, 0.0 );
			EXPECT_NEAR( std::hypot( event.normal[0], event.normal[1], event.normal[2] ), 1.0, 1e-9 );
			EXPECT_TRUE( std::isfinite( event.partingVelocity ) );
			EXPECT_LT( std::hypot( event.point[0], event.point[1], event.point[2] ), 3.0 );
		}
	}
	int cells = 0, small = 0, pieces = scene.test.world.softBodyCount();
	for ( int i = 0; i < pieces; ++i )
	{
		const int own = scene.test.world.softBody( i )->cellCount();
		EXPECT_TRUE( scene.test.world.softBody( i )->isHealthy() );
		cells += own;
		small += own <= 6 ? own : 0;
	}
	std::printf( "%d pieces, %d links in %d events, %d cells in pieces of at most six\n", pieces, links, events, small );
	EXPECT_EQ( cells, 10 * 10 * 10 );
	EXPECT_GE( pieces, 12 );
	EXPECT_LE( pieces, 100 );
	EXPECT_LT( small, 0.06 * cells );
}

TEST( Shards, BreakAlikeOnAnyNumberOfThreads )
{
	std::vector<btVector3> reference;
	for ( const int threads : { 1, 3 } )
	{
		Fracture fracture = shards( 0.15f, 0.01f );
		fracture.crumbFraction = 0.05f;
		Thrown scene( fracture, threads );
		scene.test.run( 12 );
		std::vector<btVector3> places;
		for ( int i = 0; i < scene.test.world.softBodyCount(); ++i )
		{
			const SoftBody& body = *scene.test.world.softBody( i );
			for ( int node = 0; node < body.nodeCount(); ++node )
			{
				places.push_back( body.nodePosition( node ) );
			}
		}
		reference = reference.empty() ? places : reference;
		ASSERT_EQ( places.size(), reference.size() );
		EXPECT_TRUE( std::equal( places.begin(), places.end(), reference.begin() ) );
	}
}

/// A bar in empty space whose ends fly apart.
struct TornBar
{
	TestWorld test;
	SoftBody* bar;

	explicit TornBar( const Fracture& fracture, const ShardCentres& centres = {}, const Adaptivity& levels = {} )
	{
		test.world.setGravity( btVector3( 0, 0, 0 ) );
		bar = test.addSoft( block( 16, 4, 4, kCell ), at( 0, 1, 0 ), stiff( 1e5f ), levels );
		bar->surface();
		EXPECT_TRUE( bar->setFracture( fracture, {}, centres ).ok() );
		for ( int node = 0; node < bar->nodeCount(); ++node )
		{
			const btScalar x = bar->nodePosition( node ).x();
			EXPECT_TRUE( bar->applyImpulse( btVector3( 6 * x * bar->mass() / btScalar( bar->nodeCount() ), 0, 0 ), node ).ok() );
		}
	}

	/// Steps until it is in pieces.
	FractureEvent tear()
	{
		for ( int frame = 0; frame < 60; ++frame )
		{
			test.run( 1 );
			if ( !test.world.fractureEvents().empty() )
			{
				return test.world.fractureEvents().front();
			}
		}
		return {};
	}
};

// Two centres of shards in a direction oblique to the lattice: the drawn crack is the plane midway between them.
TEST( Shards, AreDrawnWithTheSmoothBorderBetweenThem )
{
	const btVector3 normal = btVector3( 1, btScalar( 0.3 ), btScalar( 0.2 ) ).normalized(), middle( btScalar( 0.021 ), 0, 0 );
	std::vector<float> points;
	for ( const btScalar side : { btScalar( -0.2 ), btScalar( 0.2 ) } )
	{
		const btVector3 place = middle + side * normal;
		points.insert( points.end(), { float( place.x() ), float( place.y() ), float( place.z() ) } );
	}
	TornBar scene( shards( 0.2f, 0.05f ), ShardCentres{ points.data(), 2, nullptr } );
	const FractureEvent event = scene.tear();
	ASSERT_EQ( event.fragments.size(), 1u );
	ASSERT_EQ( scene.test.world.softBodyCount(), 2 );
	EXPECT_GT( std::fabs( event.normal[0] * double( normal.x() ) + event.normal[1] * double( normal.y() ) +
				   event.normal[2] * double( normal.z() ) ),
		0.98 );
	EXPECT_GT( event.partingVelocity, 0.0 );
	EXPECT_NEAR( event.point[1], 1.0, 0.05 );
	const double section = 0.2 * 0.2 / double( normal.x() );
	EXPECT_NEAR( event.area, section, 0.1 * section );
	for ( int i = 0; i < 2; ++i )
	{
		SoftBody& piece = *scene.test.world.softBody( i );
		EXPECT_TRUE( piece.reset( at( 0, 0, 0 ) ).ok() ); // to the rest shape: drawn where its mass centre is
		const SurfaceView view = piece.surface();
		double area = 0.0, low = 1e9, high = -1e9;
		btVector3 sum( 0, 0, 0 );
		for ( int t = 0; t < view.triangleCount; ++t )
		{
			btVector3 corner[3];
			for ( int k = 0; k < 3; ++k )
			{
				const float* p = view.positions + 3 * std::size_t( view.indices[3 * std::size_t( t ) + std::size_t( k )] );
				corner[k] = btVector3( p[0], p[1], p[2] );
			}
			const btVector3 across = ( corner[1] - corner[0] ).cross( corner[2] - corner[0] ) / 2;
			sum += across;
			if ( view.triangleSource[t] == SurfaceView::kInside )
			{
				area += double( across.length() );
				for ( const btVector3& p : corner )
				{
					low = std::min( low, double( normal.dot( p ) ) );
					high = std::max( high, double( normal.dot( p ) ) );
				}
			}
		}
		EXPECT_NEAR( area, section, 2e-3 * section ); // the stairs would be 1.4 of it
		EXPECT_LT( high - low, 2e-3 * double( kCell ) );
		EXPECT_LT( double( sum.length() ), 1e-5 );
	}
}

TEST( Shards, KeepMomentumAndAddNoEnergy )
{
	TornBar scene( shards( 0.15f, 0.03f ) );
	const auto totals = [&scene]( btVector3& momentum, double& energy ) {
		momentum = btVector3( 0, 0, 0 );
		energy = 0.0;
		for ( int i = 0; i < scene.test.world.softBodyCount(); ++i )
		{
			SoftBody& body = *scene.test.world.softBody( i );
			momentum += body.linearVelocity() * body.mass();
			energy += body.impl().body->sums().kineticEnergy;
		}
	};
	btVector3 before, after;
	double energyBefore = 0.0, energy = 0.0;
	totals( before, energyBefore );
	for ( int frame = 0; frame < 60; ++frame )
	{
		scene.test.run( 1 );
		totals( after, energy );
		EXPECT_LT( energy, energyBefore * 1.0001 );
	}
	EXPECT_GT( scene.test.world.softBodyCount(), 1 );
	EXPECT_LT( double( ( after - before ).length() ), 1e-5 );
}

TEST( Shards, ABodyWithLevelsBreaksAlongThemToo )
{
	Adaptivity levels;
	levels.coarseLevels = 1;
	TornBar scene( shards( 0.15f, 0.05f ), {}, levels );
	scene.test.run( 60 );
	EXPECT_GE( scene.test.world.softBodyCount(), 2 );
	int cells = 0;
	for ( int i = 0; i < scene.test.world.softBodyCount(); ++i )
	{
		cells += scene.test.world.softBody( i )->cellCount();
	}
	EXPECT_EQ( cells, 16 * 4 * 4 );
}

TEST( Shards, BadCentresAreRefusedAndChangeNothing )
{
	TestWorld test;
	SoftBody* const soft = test.addSoft( block( 8, 4, 4, kCell ), at( 0, 1, 0 ) );
	const float bad = std::numeric_limits<float>::quiet_NaN();
	const float points[6] = { 0, 0, 0, 1, 0, 0 }, broken[6] = { 0, 0, 0, bad, 0, 0 }, far[6] = { 0, 0, 0, 1e9f, 0, 0 };
	const int below[2] = { 0, -1 };
	const Fracture fracture = shards( 0.1f, 0.05f );
	for ( const ShardCentres& centres : { ShardCentres{ nullptr, 2, nullptr }, ShardCentres{ points, 1, nullptr },
			  ShardCentres{ points, -2, nullptr }, ShardCentres{ points, 200000, nullptr }, ShardCentres{ broken, 2, nullptr },
			  ShardCentres{ far, 2, nullptr }, ShardCentres{ points, 2, below } } )
	{
		EXPECT_EQ( soft->setFracture( fracture, {}, centres ).code, ResultCode::BadArgument );
		EXPECT_EQ( soft->fracture().rule, BreakRule::Never );
	}
	EXPECT_TRUE( soft->setFracture( fracture, {}, ShardCentres{ points, 2, nullptr } ).ok() );
}

TEST( Debris, AnEventsPiecesAreSpreadOverSteps )
{
	Thrown scene( shards( 0.13f, 0.01f ) );
	DebrisBudget budget;
	budget.piecesPerStep = 3;
	ASSERT_TRUE( scene.test.world.setDebrisBudget( budget ).ok() );
	EXPECT_EQ( scene.test.world.debrisBudget().piecesPerStep, 3 );
	int fragments = 0, full = 0;
	for ( int frame = 0; frame < 60; ++frame )
	{
		scene.test.run( 1 );
		int now = 0;
		for ( const FractureEvent& event : scene.test.world.fractureEvents() )
		{
			now += int( event.fragments.size() );
		}
		EXPECT_LE( now, 3 );
		EXPECT_EQ( now, scene.test.world.stepReport().fragments );
		full += now == 3 ? 1 : 0;
		fragments += now;
	}
	EXPECT_GT( full, 1 );
	EXPECT_GT( fragments, 8 );
	EXPECT_EQ( fragments, scene.test.world.fragmentCount() );
	for ( int i = 0; i < scene.test.world.softBodyCount(); ++i )
	{
		EXPECT_FALSE( scene.test.world.softBody( i )->impl().partsWait );
	}
}

TEST( Debris, FadesBeyondTheBudgetButNotWhatIsKept )
{
	Thrown scene( shards( 0.13f, 0.01f ) );
	SoftBody* const kept = scene.throwAnother( shards( 0.13f, 0.01f ), 3 );
	kept->setKept( true );
	DebrisBudget budget;
	budget.maxPieces = 5;
	budget.fadeTime = 0.1f;
	ASSERT_TRUE( scene.test.world.setDebrisBudget( budget ).ok() );
	int faded = 0, removed = 0, fragments = 0;
	for ( int frame = 0; frame < 60; ++frame )
	{
		scene.test.run( 1 );
		const StepReport& report = scene.test.world.stepReport();
		faded += report.debrisFading;
		removed += report.removedPieces;
		fragments += report.fragments;
		for ( int i = 0; i < scene.test.world.softBodyCount(); ++i )
		{
			SoftBody& body = *scene.test.world.softBody( i );
			EXPECT_TRUE( !body.isKept() || body.fadeFraction() == 1.0f );
		}
	}
	int keptPieces = 0;
	for ( int i = 0; i < scene.test.world.softBodyCount(); ++i )
	{
		keptPieces += scene.test.world.softBody( i )->isKept() ? 1 : 0;
	}
	EXPECT_GT( faded, 3 );
	EXPECT_EQ( removed, faded );
	EXPECT_GT( keptPieces, 5 ); // more than the budget
	EXPECT_EQ( scene.test.world.fragmentCount(), fragments - removed );
	EXPECT_EQ( scene.test.world.softBodyCount() - keptPieces, 1 ); // of the other body only the body itself remains
	EXPECT_EQ( scene.test.world.stepReport().debrisPieces, scene.test.world.fragmentCount() );
}

TEST( Debris, NodesHaveABudgetTooAndReleasedPiecesAreTheGames )
{
	Thrown scene( shards( 0.13f, 0.01f ) );
	DebrisBudget budget;
	budget.maxNodes = 300;
	budget.fadeTime = 0.05f;
	ASSERT_TRUE( scene.test.world.setDebrisBudget( budget ).ok() );
	std::vector<std::unique_ptr<SoftBody>> taken;
	for ( int frame = 0; frame < 60; ++frame )
	{
		scene.test.run( 1 );
		for ( const FractureEvent& event : scene.test.world.fractureEvents() )
		{
			if ( taken.empty() && !event.fragments.empty() && scene.test.world.releaseFragment( event.fragments[0] ) )
			{
				taken.emplace_back( event.fragments[0] );
			}
		}
	}
	ASSERT_EQ( taken.size(), 1u );
	EXPECT_EQ( taken[0]->fadeFraction(), 1.0f );
	EXPECT_LE( scene.test.world.stepReport().debrisNodes, 300 );
	EXPECT_GT( scene.test.world.stepReport().debrisPieces, 0 );
}

TEST( Debris, ABadBudgetIsRefusedAndChangesNothing )
{
	TestWorld test;
	DebrisBudget budget;
	budget.maxPieces = 7;
	ASSERT_TRUE( test.world.setDebrisBudget( budget ).ok() );
	budget.maxPieces = -1;
	EXPECT_EQ( test.world.setDebrisBudget( budget ).code, ResultCode::BadSettings );
	EXPECT_EQ( test.world.debrisBudget().maxPieces, 7 );
}

} // namespace
} // namespace pliant
