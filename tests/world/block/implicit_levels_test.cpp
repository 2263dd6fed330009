// Elasticity::Implicit for bodies with levels of detail: heavy loads, nodes split and merged under load, and bodies that break.

#include "world/levels/adaptive_bodies.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::implicit;
using test::kGravity;
using test::TestWorld;

/// Mean height and mean rest height of the nodes whose cubes reach the block's top or bottom.
struct Layer
{
	double now = 0.0, rest = 0.0;
};

Layer layer( const SoftBody& cube, bool isTop )
{
	const NodeState& nodes = cube.impl().body->nodes();
	Layer sum;
	double mass = 0.0;
	for ( int i = 0; i < nodes.count; ++i )
	{
		const double y = double( nodes.x0.y[i] ), half = double( cube.nodeRadius( i ) );
		if ( ( isTop ? y : -y ) + 1.5 * half > 0.3 )
		{
			sum.now += double( nodes.mass[i] ) * nodes.worldPosition( i ).y();
			sum.rest += double( nodes.mass[i] ) * y;
			mass += double( nodes.mass[i] );
		}
	}
	return { sum.now / mass, sum.rest / mass };
}

struct LoadedLevels
{
	double strain = 0.0, theory = 0.0, tilt = 0.0, speed = 0.0, penetration = 0.0;
	bool sleeps = false;
	int substeps = 0, least = 1 << 20, most = 0;
};

/// A box `ratio` times as heavy rests on a cube of 216 kg; the modulus allows a compression of a tenth.
LoadedLevels load( double ratio, int cells, const Adaptivity& settings )
{
	TestWorld t;
	t.addPlane();
	const double weight = kGravity * 216.0, area = 0.36, modulus = ratio * weight / area / 0.1;
	SoftBody* cube = t.addSoft(
		block( cells, cells, cells, 0.6f / float( cells ) ), at( 0, btScalar( 0.3 ), 0 ), implicit( float( modulus ) ), settings );
	btRigidBody* box = t.addBox( btScalar( ratio * 216.0 ), btVector3( 0.3f, 0.3f, 0.3f ), at( 0, btScalar( 0.901 ), 0 ) );
	LoadedLevels loaded;
	for ( int frame = 0; frame < 400; ++frame )
	{
		const bool isAwake = cube->isActive();
		t.run( 1 );
		EXPECT_EQ( t.world.stepReport().implicitBodies, isAwake ? 1 : 0 );
		loaded.substeps = std::max( loaded.substeps, t.world.stepReport().substeps );
		loaded.speed = frame == 300 ? double( box->getLinearVelocity().length() ) : loaded.speed;
		loaded.least = std::min( loaded.least, cube->nodeCount() );
		loaded.most = std::max( loaded.most, cube->nodeCount() );
	}
	const Layer top = layer( *cube, true ), bottom = layer( *cube, false );
	// Levels have the energy of the finest cells for the same strain, and the finest cells are strained between the centres of their
	// outermost layers. Big outermost nodes have that energy over a shorter distance.
	const double length = top.rest - bottom.rest, finest = 0.6 - 0.6 / cells;
	loaded.theory = ( ratio + 0.5 ) * weight / area / modulus * length / finest;
	loaded.strain = 1.0 - ( top.now - bottom.now ) / length;
	loaded.tilt = double( btAcos( btMin( btScalar( 1 ), box->getWorldTransform().getBasis()[1].y() ) ) ) * 180.0 / SIMD_PI;
	for ( int i = 0; i < cube->nodeCount(); ++i )
	{
		loaded.penetration = std::max( loaded.penetration, double( cube->nodeRadius( i ) - cube->nodePosition( i ).y() ) );
	}
	loaded.sleeps = cube->getActivationState() == ISLAND_SLEEPING && box->getActivationState() == ISLAND_SLEEPING;
	return loaded;
}

struct Kind
{
	const char* name;
	int cells;
	Adaptivity settings;
};

std::vector<Kind> kinds()
{
	Adaptivity fineSkin = test::levels( 2 ), strained = test::levels( 2 ), touched = test::levels( 2 ), intervals = test::levels( 1 );
	fineSkin.isSurfaceFine = true;
	strained.refineStrain = 0.05f;
	touched.refinesOnContact = true;
	intervals.regions = RegionRule::Interval;
	return { { "one level", 6, test::levels( 1 ) }, { "two levels", 12, test::levels( 2 ) }, { "fine surface", 12, fineSkin },
		{ "split by strain", 8, strained }, { "split by touch", 8, touched }, { "intervals", 6, intervals } };
}

TEST( ImplicitLevels, CarryABoxOfAnyMassByTheoryAndSleep )
{
	for ( const Kind& kind : kinds() )
	{
		for ( const double ratio : { 1.0, 1000.0 } )
		{
			const LoadedLevels loaded = load( ratio, kind.cells, kind.settings );
			std::printf(
				"%s 1:%-4.0f strain %.4f of %.4f (%+.1f %%), tilt %.2f deg, penetration %.5f m, speed after 5 s %.1e m/s, %d to %d nodes\n",
				kind.name, ratio, loaded.strain, loaded.theory, 100.0 * ( loaded.strain / loaded.theory - 1.0 ), loaded.tilt,
				loaded.penetration, loaded.speed, loaded.least, loaded.most );
			EXPECT_NEAR( loaded.strain / loaded.theory, 1.0, 0.05 ) << kind.name;
			EXPECT_LT( loaded.tilt, 2.0 ) << kind.name;
			EXPECT_LT( loaded.penetration, 0.1 * 0.6 / kind.cells ) << kind.name;
			EXPECT_LT( loaded.speed, 1e-3 ) << kind.name;
			EXPECT_TRUE( loaded.sleeps ) << kind.name;
			EXPECT_EQ( loaded.substeps, 1 );
		}
	}
}

struct LevelSums
{
	Vec3d momentum = Vec3d::Zero(), spin = Vec3d::Zero();
	double energy = 0.0;
};

LevelSums levelSumsOf( const TestWorld& t )
{
	LevelSums sums;
	for ( int k = 0; k < t.world.softBodyCount(); ++k )
	{
		const NodeState& nodes = const_cast<SoftBodyWorld&>( t.world ).softBody( k )->impl().body->nodes();
		for ( int i = 0; i < nodes.count; ++i )
		{
			const Vec3d value = double( nodes.mass[i] ) * nodes.v.get( i ).cast<double>();
			sums.momentum += value;
			sums.spin += nodes.worldPosition( i ).cross( value );
			sums.energy += 0.5 * value.dot( nodes.v.get( i ).cast<double>() );
		}
	}
	for ( const auto& body : t.rigid )
	{
		const Vec3d value = toVec3d( body->getLinearVelocity() ) / double( body->getInvMass() );
		const Vec3d spin = toVec3d( body->getInvInertiaTensorWorld().inverse() * body->getAngularVelocity() );
		sums.momentum += value;
		sums.spin += toVec3d( body->getCenterOfMassPosition() ).cross( value ) + spin;
		sums.energy += 0.5 * value.dot( toVec3d( body->getLinearVelocity() ) ) + 0.5 * spin.dot( toVec3d( body->getAngularVelocity() ) );
	}
	return sums;
}

TEST( ImplicitLevels, CollisionsThatSplitAndMergeNodesKeepMomentumAndAddNoEnergy )
{
	for ( const float youngsModulus : { 3e3f, 3e5f, 3e7f } )
	{
		TestWorld t;
		t.world.setGravity( btVector3( 0, 0, 0 ) );
		Adaptivity settings = test::levels( 2 );
		settings.refineStrain = 0.01f;
		settings.refinesOnContact = true;
		Material material = implicit( youngsModulus );
		SoftBody* cube = t.addSoft( block( 8, 8, 8, 0.1f ), at( 0, 0, 0 ), material, settings );
		btRigidBody* box = t.addBox( 1000, btVector3( 0.2f, 0.2f, 0.2f ), at( -1, btScalar( 0.15 ), btScalar( 0.1 ) ) );
		box->setLinearVelocity( btVector3( 4, 0, 0 ) );
		box->setAngularVelocity( btVector3( 0, 1, 2 ) );
		const LevelSums before = levelSumsOf( t );
		double most = 0.0;
		int splits = 0, merges = 0;
		for ( int frame = 0; frame < 180; ++frame )
		{
			t.run( 1 );
			most = std::max( most, levelSumsOf( t ).energy );
			splits += t.world.stepReport().splits;
			merges += t.world.stepReport().merges;
		}
		const LevelSums after = levelSumsOf( t );
		const double momentum = ( after.momentum - before.momentum ).norm() / before.momentum.norm(),
					 spin = ( after.spin - before.spin ).norm() / before.spin.norm();
		std::printf( "E %.0e: %d splits, %d merges, %d nodes left, momentum %.1e, spin %.1e, energy %.4f\n", double( youngsModulus ),
			splits, merges, cube->nodeCount(), momentum, spin, most / before.energy );
		EXPECT_GT( splits, 0 );
		EXPECT_TRUE( merges > 0 || youngsModulus < 1e4f ); // the softest keeps oscillating
		EXPECT_LT( momentum, 1e-5 );
		EXPECT_LT( spin, 1e-4 );
		EXPECT_LE( most, before.energy * 1.0001 );
		EXPECT_LT( after.energy, 0.999 * before.energy ); // they did touch
	}
}

// A change of levels moves the load on the body by less than a twentieth of a cell.
TEST( ImplicitLevels, AChangeOfLevelsHardlyMovesTheLoad )
{
	TestWorld t;
	t.addPlane();
	const double modulus = 100.0 * kGravity * 216.0 / 0.36 / 0.1;
	Adaptivity settings = test::levels( 1 );
	settings.isSurfaceFine = true;
	settings.mergeDelay = 10.0f;
	SoftBody* cube = t.addSoft( block( 10, 10, 10, 0.06f ), at( 0, btScalar( 0.3 ), 0 ), implicit( float( modulus ) ), settings );
	btRigidBody* box = t.addBox( 21600, btVector3( 0.3f, 0.3f, 0.3f ), at( 0, btScalar( 0.901 ), 0 ) );
	cube->setActivationState( DISABLE_DEACTIVATION );
	box->setActivationState( DISABLE_DEACTIVATION );
	t.run( 240 );
	const btScalar before = box->getWorldTransform().getOrigin().y();
	const int nodes = cube->nodeCount();
	test::changeLevels( *cube, test::coarseNodes( *cube, test::anyNode ), {} );
	double moved = 0.0;
	for ( int frame = 0; frame < 120; ++frame )
	{
		t.run( 1 );
		moved = std::max( moved, std::abs( double( box->getWorldTransform().getOrigin().y() - before ) ) );
	}
	std::printf( "%d to %d nodes: box moves by %.2e m, at last %.2e\n", nodes, cube->nodeCount(), moved,
		double( box->getWorldTransform().getOrigin().y() - before ) );
	EXPECT_EQ( cube->nodeCount(), 1000 );
	EXPECT_LT( nodes, 900 );
	EXPECT_LT( moved, 0.05 * 0.06 );
}

TEST( ImplicitLevels, AutomaticTakesTheImplicitStepUnderAHeavyLoad )
{
	TestWorld t;
	t.addPlane();
	Material material = test::stiff( 2e5f );
	material.elasticity = Elasticity::Automatic;
	Adaptivity settings = test::levels( 1 );
	settings.refinesOnContact = true;
	SoftBody* cube = t.addSoft( block( 8, 8, 8, 0.075f ), at( 0, btScalar( 0.301 ), 0 ), material, settings );
	t.run( 30 );
	EXPECT_FALSE( cube->stepsImplicitly() );
	btRigidBody* box = t.addBox( 600, btVector3( 0.3f, 0.3f, 0.3f ), at( 0, btScalar( 0.903 ), 0 ) );
	cube->setActivationState( DISABLE_DEACTIVATION );
	box->setActivationState( DISABLE_DEACTIVATION );
	t.run( 300 );
	EXPECT_TRUE( cube->stepsImplicitly() );
	const Layer top = layer( *cube, true ), bottom = layer( *cube, false );
	const double theory = ( 600.0 + 108.0 ) * kGravity / 0.36 / 2e5, got = 1.0 - ( top.now - bottom.now ) / ( top.rest - bottom.rest );
	std::printf( "strain %.4f of %.4f\n", got, theory );
	EXPECT_NEAR( got / theory, 1.0, 0.1 );
	EXPECT_LT( box->getLinearVelocity().length(), btScalar( 1e-2 ) );
}

Fracture breaksAt( float strain )
{
	Fracture fracture;
	fracture.rule = BreakRule::Distance;
	fracture.breakStrain = strain;
	return fracture;
}

TEST( ImplicitLevels, ABodyThatBreaksInFreeFlightKeepsMomentumAndSpin )
{
	for ( const bool hasLevels : { false, true } )
	{
		// In empty space a spinning bar tears itself apart.
		TestWorld t;
		t.world.setGravity( btVector3( 0, 0, 0 ) );
		SoftBody* soft = t.addSoft(
			block( 12, 4, 4, 0.1f ), at( 3, 2, 1 ), implicit( 1e6f ), hasLevels ? test::levels( 1 ) : Adaptivity{} );
		ASSERT_TRUE( soft->setFracture( breaksAt( 0.02f ) ).ok() );
		EXPECT_TRUE( soft->setVelocities( btVector3( 1, 2, 3 ), btVector3( 0, 20, 1 ) ).ok() );
		const LevelSums before = levelSumsOf( t );
		double most = 0.0;
		for ( int frame = 0; frame < 60; ++frame )
		{
			t.run( 1 );
			most = std::max( most, levelSumsOf( t ).energy );
			for ( int k = 0; k < t.world.softBodyCount(); ++k )
			{
				EXPECT_TRUE( t.world.softBody( k )->stepsImplicitly() || t.world.softBody( k )->cellCount() == 1 );
				EXPECT_TRUE( t.world.softBody( k )->isHealthy() );
			}
		}
		const LevelSums after = levelSumsOf( t );
		const double momentum = ( after.momentum - before.momentum ).norm() / before.momentum.norm(),
					 spin = ( after.spin - before.spin ).norm() / before.spin.norm();
		std::printf(
			"%d bodies; momentum off by %.1e, spin by %.1e, energy %.4f\n", t.world.softBodyCount(), momentum, spin, most / before.energy );
		EXPECT_GE( t.world.softBodyCount(), 2 );
		EXPECT_LT( momentum, 1e-5 );
		EXPECT_LT( spin, 1e-4 );
		EXPECT_LE( most, before.energy * 1.001 );
	}
}

std::vector<btScalar> positionsAfterBreaking( int threads )
{
	TestWorld t;
	t.addFloor();
	t.world.setThreadCount( threads );
	Adaptivity settings = test::levels( 2 );
	settings.refineStrain = 0.02f;
	for ( int k = 0; k < 2; ++k )
	{
		SoftBody* soft = t.addSoft( block( 8, 8, 8, 0.1f ), at( btScalar( 1.2 * k ), btScalar( 0.42 ), 0 ), implicit( 1e6f ), settings );
		EXPECT_TRUE( soft->setFracture( breaksAt( 0.05f ) ).ok() );
		t.addBox( 500, btVector3( 0.1f, 0.1f, 0.1f ), at( btScalar( 1.2 * k + 0.2 ), 2, 0 ) )->setLinearVelocity( btVector3( 0, -20, 0 ) );
	}
	int splits = 0, links = 0;
	for ( int frame = 0; frame < 60; ++frame )
	{
		t.run( 1 );
		splits += t.world.stepReport().splits;
		for ( const FractureEvent& event : t.world.fractureEvents() )
		{
			links += event.links;
		}
	}
	EXPECT_GT( splits, 0 );
	EXPECT_GT( links, 0 );
	std::vector<btScalar> positions;
	for ( int k = 0; k < t.world.softBodyCount(); ++k )
	{
		const SoftBody& body = *t.world.softBody( k );
		EXPECT_TRUE( body.isHealthy() );
		for ( int i = 0; i < body.nodeCount(); ++i )
		{
			positions.insert( positions.end(), { body.nodePosition( i ).x(), body.nodePosition( i ).y(), body.nodePosition( i ).z() } );
		}
	}
	return positions;
}

// A falling body touches nothing and, unstrained, needs no solving. With the tolerance of contacts and without the frame's gravity in the
// initial guess it would take 25 products a frame, as many as a pile.
TEST( ImplicitLevels, AFallingBodyNeedsFewProducts )
{
	for ( const int levels : { 0, 1 } )
	{
		TestWorld t;
		SoftBody* const body = t.addSoft(
			block( 6, 6, 6, 0.1f ), at( 0, 100, 0 ), implicit( 1e6f ), levels > 0 ? test::levels( levels ) : Adaptivity{} );
		EXPECT_TRUE( body->setLinearVelocity( btVector3( 1, -3, 0 ) ).ok() );
		for ( int frame = 1; frame <= 60; ++frame )
		{
			t.run( 1 );
			EXPECT_LE( t.world.stepReport().implicitProducts, 4 ) << frame;
		}
		EXPECT_NEAR( body->linearVelocity().x(), 1, 1e-5 );
		EXPECT_NEAR( body->linearVelocity().y(), -3 - kGravity, 1e-4 );
		EXPECT_NEAR( body->massCentre().y(), 100 - 3 - kGravity * 0.5 * 61.0 / 60.0, 1e-3 ); // 60 steps of v += h g; x += h v
	}
}

// A body that hangs from held nodes does not fall: starting from free flight it would take 25 to 31 products a frame at rest. A swinging
// one converges faster with its affine motions in the preconditioner, in which held nodes add resistance.
TEST( ImplicitLevels, AHangingBodyNeedsFewProducts )
{
	for ( const int levels : { 0, 1 } )
	{
		TestWorld t;
		SoftBody* const body = t.addSoft(
			block( 6, 12, 6, 0.1f ), at( 0, 0, 0 ), implicit( 1e6f ), levels > 0 ? test::levels( levels ) : Adaptivity{} );
		body->setActivationState( DISABLE_DEACTIVATION );
		for ( int i = 0; i < body->nodeCount(); ++i )
		{
			if ( body->nodePosition( i ).y() > 0.45 )
			{
				ASSERT_TRUE( body->pinNode( i ).ok() );
			}
		}
		EXPECT_TRUE( body->setLinearVelocity( btVector3( 2, 0, 0 ) ).ok() );
		int swinging = 0;
		for ( int frame = 0; frame < 600; ++frame )
		{
			t.run( 1 );
			const int products = t.world.stepReport().implicitProducts;
			swinging += frame < 60 ? products : 0;
			EXPECT_TRUE( frame < 540 || products <= 3 ) << frame << ": " << products;
		}
		std::printf( "%d levels, %d nodes: %.1f products a frame while it swings\n", levels, body->nodeCount(), swinging / 60.0 );
		EXPECT_LT( swinging, 60 * 14 ); // 16 and 14 without the affine motions
	}
}

// A fragment of one node takes part in an implicit body's island with its mass alone. It has no inertia, so the restoration of momentum
// must not divide by it while it has no active contact.
TEST( ImplicitLevels, AFragmentBesideAnImplicitBodyStaysHealthy )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	// A millimetre apart: near enough for a contact, which is not active.
	SoftBody* const cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0, 0 ), implicit( 1e5f ) );
	SoftBody* const crumb = t.addSoft(
		block( 1, 1, 1, 0.1f ), at( btScalar( 0.05 ), btScalar( 0.251 ), btScalar( 0.05 ) ), implicit( 1e5f ) );
	ASSERT_EQ( crumb->nodeCount(), 1 );
	EXPECT_TRUE( crumb->setLinearVelocity( btVector3( 0, btScalar( 0.01 ), 0 ) ).ok() );
	for ( int frame = 0; frame < 10; ++frame )
	{
		t.run( 1 );
		ASSERT_TRUE( frame > 0 || crumb->getIslandTag() == cube->getIslandTag() );
		ASSERT_EQ( t.world.stepReport().quarantined, 0 ) << frame;
	}
	EXPECT_TRUE( cube->isHealthy() && crumb->isHealthy() );
	EXPECT_NEAR( crumb->linearVelocity().y(), 0.01, 1e-5 );
}

TEST( ImplicitLevels, SplitAndBreakToTheSameBitsForAnyThreadCount )
{
	const auto once = positionsAfterBreaking( 1 );
	EXPECT_EQ( positionsAfterBreaking( 1 ), once );
	EXPECT_EQ( positionsAfterBreaking( 3 ), once );
}

} // namespace
} // namespace pliant
