// Far levels: compared with their reference implementation, on all instruction sets and numbers of threads; conservation, bodies without
// them, refusals.

#include "matching/reference/reference_coarse_to_fine.h"
#include "matching/step/lattice_matcher.h"
#include "pliant/task_runner.h"
#include "support/block_body.h"
#include "support/block_lattice.h"
#include "support/explicit_material.h"
#include "support/shapes.h"

#include <gtest/gtest.h>

#include <cstring>

namespace pliant {
namespace {

constexpr float kCell = 0.1f, kStep = 1.0f / 240.0f;

/// Bodies that are likely to fail: several parts in a block, plates and rods of one cell, cells that are not full.
Lattice lattices( int which )
{
	if ( which == 1 )
	{
		Lattice blob = test::makeBlobLattice( 20, kCell, 3 );
		test::Seeded random( 5 );
		for ( float& fill : blob.fill )
		{
			fill = random.uniform( 0.1f, 1.0f );
		}
		return blob;
	}
	if ( which == 4 ) // box sums over a grid with holes: records are not in the cells' order
	{
		return test::makeShapeLattice( { 24, 9, 8 }, kCell, []( int x, int, int ) { return x >= 5; } );
	}
	return which == 0 ? makeBlockLattice( 19, 9, 10, kCell )
		: which == 2  ? makeBlockLattice( 24, 17, 1, kCell )
					  : makeBlockLattice( 33, 1, 1, kCell );
}

/// Rotated by a large angle, bent, and both.
NodeState bentAndTurned( const Lattice& lattice, float shake, const Vec3& where = Vec3( 2, -1, 3 ) )
{
	NodeState nodes = test::restNodes( lattice );
	test::Seeded random( 7 );
	const Eigen::Quaternionf turn( Eigen::AngleAxisf( 2.8f, Vec3( 1, 2, 3 ).normalized() ) );
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3 q = nodes.x0.get( i );
		const Vec3 bent = q + shake * Vec3( 0.3f * q.x() * q.y(), 0.5f * q.x() * q.x(), 0.2f * q.z() + 0.3f * q.y() * q.z() ) +
			random.inBox( 0.2f * shake * kCell );
		nodes.x.set( i, turn * bent + where );
	}
	return nodes;
}

MatchStep stepOf( const FarFractions& fractions )
{
	MatchStep step{ kStep, 1.0f };
	step.far = fractions;
	return step;
}

double largestVelocity( const NodeState& nodes )
{
	double largest = 0.0;
	for ( int i = 0; i < nodes.count; ++i )
	{
		largest = std::max( largest, double( nodes.v.get( i ).norm() ) );
	}
	return largest;
}

bool sameVelocityBits( const NodeState& a, const NodeState& b )
{
	const std::size_t bytes = std::size_t( a.count ) * sizeof( float );
	return std::memcmp( a.v.x.data(), b.v.x.data(), bytes ) == 0 && std::memcmp( a.v.y.data(), b.v.y.data(), bytes ) == 0 &&
		std::memcmp( a.v.z.data(), b.v.z.data(), bytes ) == 0;
}

class FarTwin : public testing::TestWithParam<int>
{};

TEST_P( FarTwin, AgreesOnEveryLevel )
{
	const Lattice lattice = lattices( GetParam() );
	for ( int level = 1; level <= 3; ++level )
	{
		for ( const bool isHeld : { false, true } )
		{
			NodeState start = bentAndTurned( lattice, 0.5f );
			for ( int i = 0; i < start.count; ++i )
			{
				start.freedom[i] = isHeld && i % 23 < 4 ? 0.0f : 1.0f;
			}
			LatticeMatcher matcher( lattice, Material{} ), plain( lattice, Material{} );
			matcher.setFarLevels( level );
			EXPECT_EQ( matcher.tables().gridHasHoles, GetParam() == 4 );
			NodeState with = start, without = start;
			FarFractions fractions = {};
			for ( int l = 0; l < level; ++l )
			{
				fractions[l] = 0.3f + 0.1f * float( l );
			}
			matcher.accelerate( with, stepOf( fractions ), nullptr );
			plain.accelerate( without, MatchStep{ kStep, 1.0f }, nullptr );

			std::vector<Vec3d> expected( start.count, Vec3d::Zero() );
			for ( int l = 1; l <= level; ++l )
			{
				const std::vector<Vec3d> way = referenceFarDisplacement( lattice, start, *matcher.farLevels(), l );
				for ( int i = 0; i < start.count; ++i )
				{
					expected[i] += double( fractions[l - 1] ) * double( start.freedom[i] ) * way[i] / double( kStep );
				}
			}
			double worst = 0.0, largest = 0.0;
			for ( int i = 0; i < start.count; ++i )
			{
				worst = std::max( worst, ( ( with.v.get( i ) - without.v.get( i ) ).cast<double>() - expected[i] ).norm() );
				largest = std::max( largest, expected[i].norm() );
			}
			std::printf( "%d cells, %d levels%s: off by %.1e of %.1e m/s\n", start.count, level, isHeld ? ", held" : "", worst, largest );
			EXPECT_LT( worst, 1e-4 * largest );
			EXPECT_GT( largest, 0.1 );
		}
	}
}

TEST_P( FarTwin, MovesNoMomentumOnAnyLevel )
{
	const Lattice lattice = lattices( GetParam() );
	const NodeState nodes = bentAndTurned( lattice, 2.0f );
	LatticeMatcher matcher( lattice, Material{} );
	matcher.setFarLevels( 3 );
	for ( int level = 1; level <= 3; ++level )
	{
		const std::vector<Vec3d> way = referenceFarDisplacement( lattice, nodes, *matcher.farLevels(), level );
		Vec3d impulse = Vec3d::Zero(), turn = Vec3d::Zero();
		double size = 0.0, arm = 0.0;
		for ( int i = 0; i < nodes.count; ++i )
		{
			const Vec3d push = double( nodes.mass[i] ) * way[i], at = nodes.x.get( i ).cast<double>() - Vec3d( 2, -1, 3 );
			impulse += push;
			turn += at.cross( push );
			size += push.norm();
			arm += at.norm() * push.norm();
		}
		EXPECT_LT( impulse.norm(), 1e-7 * size ) << level; // masses are floats
		EXPECT_LT( turn.norm(), 1e-7 * arm ) << level;
	}
}

TEST_P( FarTwin, MovesNoMomentumInTheStep )
{
	const Lattice lattice = lattices( GetParam() );
	NodeState nodes = bentAndTurned( lattice, 2.0f, Vec3::Zero() );
	LatticeMatcher matcher( lattice, Material{} );
	matcher.setFarLevels( 3 );
	matcher.accelerate( nodes, stepOf( { 0.6f, 0.6f, 0.6f } ), nullptr );
	Vec3d impulse = Vec3d::Zero(), turn = Vec3d::Zero();
	double size = 0.0, arm = 0.0;
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3d push = double( nodes.mass[i] ) * nodes.v.get( i ).cast<double>(), at = nodes.x.get( i ).cast<double>();
		impulse += push;
		turn += at.cross( push );
		size += push.norm();
		arm += at.norm() * push.norm();
	}
	EXPECT_LT( impulse.norm(), 1e-6 * size );
	EXPECT_LT( turn.norm(), 1e-6 * arm );
}

INSTANTIATE_TEST_SUITE_P( Bodies, FarTwin, testing::Range( 0, 5 ) );

TEST( FarLevels, LeaveARigidMotionAlone )
{
	const Lattice lattice = makeBlockLattice( 32, 8, 9, kCell );
	NodeState nodes = bentAndTurned( lattice, 0.0f );
	LatticeMatcher matcher( lattice, Material{} );
	matcher.setFarLevels( 3 );
	matcher.accelerate( nodes, stepOf( { 0.6f, 0.6f, 0.6f } ), nullptr );
	EXPECT_LT( largestVelocity( nodes ), 1e-3 ); // positions of 5 m are accurate to 5e-7 m
}

TEST( FarLevels, TurnWithTheBody )
{
	const Lattice lattice = makeBlockLattice( 24, 8, 9, kCell );
	const Eigen::Quaternionf turn( Eigen::AngleAxisf( 2.5f, Vec3( -2, 1, 1 ).normalized() ) );
	NodeState here = bentAndTurned( lattice, 1.0f, Vec3::Zero() ), there = here;
	for ( int i = 0; i < there.count; ++i )
	{
		there.x.set( i, turn * there.x.get( i ) );
	}
	for ( NodeState* nodes : { &here, &there } )
	{
		LatticeMatcher matcher( lattice, Material{} );
		matcher.setFarLevels( 3 );
		matcher.accelerate( *nodes, stepOf( { 0.6f, 0.6f, 0.6f } ), nullptr );
	}
	double worst = 0.0;
	for ( int i = 0; i < here.count; ++i )
	{
		worst = std::max( worst, double( ( turn * here.v.get( i ) - there.v.get( i ) ).norm() ) );
	}
	EXPECT_LT( worst, 1e-4 * largestVelocity( here ) );
}

TEST( FarLevels, GiveTheSameBitsOnEveryInstructionSetAndForAnyThreadCount )
{
	const Lattice lattice = test::makeBlobLattice( 28, kCell, 5 );
	for ( const float shake : { 0.3f, 20.0f } ) // 20: many regions take the careful rotation
	{
		std::vector<NodeState> results;
		const auto run = [&]( const Kernels& kernels, TaskRunner* runner ) {
			LatticeMatcher matcher( lattice, Material{}, Summation::Automatic, kernels );
			matcher.setFarLevels( 3 );
			results.push_back( bentAndTurned( lattice, shake ) );
			MatchStep step = stepOf( { 0.6f, 0.5f, 0.3f } );
			step.damping = 10.0f;
			for ( int k = 0; k < 5; ++k )
			{
				matcher.accelerate( results.back(), step, runner );
			}
			EXPECT_TRUE( sameVelocityBits( results.front(), results.back() ) ) << kernels.name;
		};
		for ( const KernelTarget target : { KernelTarget::Baseline, KernelTarget::Avx2, KernelTarget::Avx512 } )
		{
			if ( const Kernels* kernels = findKernels( target ) )
			{
				run( *kernels, nullptr );
			}
		}
		for ( const int threads : { 2, 5 } )
		{
			const auto pool = createThreadPool( threads );
			run( bestKernels(), pool.get() );
		}
		EXPECT_GE( results.size(), 3u );
	}
}

TEST( FarLevels, DoNothingWhereTheFinestLevelIsEnough )
{
	const Lattice lattice = makeBlockLattice( 32, 5, 5, kCell );
	Material material = test::explicitMaterial();
	material.youngsModulus = 0.9f * planStiffness( material, kCell, kStep, 1 ).reachedModulus /
		planStiffness( material, kCell, kStep, 1 ).alpha;
	material.farLevels = 3;
	const FarFractions none = farFractions( material, kCell, kStep );
	EXPECT_EQ( farMoment( none ), 0.0 );
	LatticeMatcher plain( lattice, material ), with( lattice, material );
	with.setFarLevels( 3 );
	NodeState a = bentAndTurned( lattice, 1.0f ), b = a;
	plain.accelerate( a, stepOf( {} ), nullptr );
	with.accelerate( b, stepOf( none ), nullptr );
	EXPECT_TRUE( sameVelocityBits( a, b ) );
	EXPECT_EQ( plain.farLevels(), nullptr );
	with.setFarLevels( 0 );
	EXPECT_EQ( with.farLevels(), nullptr );
}

TEST( FarLevels, DoNotReachAcrossAGap )
{
	// Two prongs on a common foot, side by side without links: a force on the end of one has no effect on the end of the other.
	const auto inside = []( int, int, int ) { return true; };
	const auto isLeft = []( int cell ) { return cell % 6 < 3; };
	const auto isFoot = []( int cell ) { return cell / 6 % 64 < 8; };
	const auto linked = [&]( int a, int b ) { return isLeft( a ) == isLeft( b ) || ( isFoot( a ) && isFoot( b ) ); };
	const Lattice lattice = test::makeShapeLattice( { 6, 64, 4 }, kCell, inside, linked );
	NodeState nodes = test::restNodes( lattice );
	for ( int i = 0; i < nodes.count; ++i )
	{
		const bool isEnd = lattice.coordinate[i].x() >= 3 && lattice.coordinate[i].y() >= 60;
		nodes.x.y[i] += isEnd ? 0.5f * kCell : 0.0f;
	}
	LatticeMatcher matcher( lattice, Material{} );
	matcher.setFarLevels( 3 );
	for ( int level = 1; level <= 3; ++level )
	{
		const std::vector<Vec3d> way = referenceFarDisplacement( lattice, nodes, *matcher.farLevels(), level );
		double own = 0.0, other = 0.0;
		for ( int i = 0; i < nodes.count; ++i )
		{
			double& most = lattice.coordinate[i].x() < 3 ? other : own;
			most = std::max( most, way[i].norm() );
		}
		EXPECT_GT( own, 0.1 * kCell );
		EXPECT_LT( other, 1e-6 * own ) << level;
	}
}

TEST( FarLevels, LeavePinnedNodesWhereTheyAre )
{
	Material material = test::explicitMaterial();
	material.youngsModulus = 1e6f;
	material.farLevels = 3;
	const auto body = test::makeBlock( 4, 64, 4, kCell, material );
	for ( int i = 0; i < body->nodeCount(); ++i )
	{
		body->setPinned( i, body->nodes().x0.y[i] > 31.0f * kCell );
	}
	const NodeState before = body->nodes();
	for ( int k = 0; k < 100; ++k )
	{
		test::substep( *body, kStep, 1.0f, Vec3( 0, -9.81f, 0 ) );
	}
	for ( int i = 0; i < body->nodeCount(); ++i )
	{
		if ( before.freedom[i] == 0.0f )
		{
			EXPECT_EQ( body->nodes().worldPosition( i ), before.worldPosition( i ) );
		}
	}
}

TEST( FarLevels, ArePlannedAndRefused )
{
	Material material = test::explicitMaterial();
	material.youngsModulus = 1e7f;
	material.farLevels = 0;
	const StiffnessPlan alone = planStiffness( material, kCell, 1.0f / 60.0f, 4 );
	material.farLevels = 3;
	const StiffnessPlan with = planStiffness( material, kCell, 1.0f / 60.0f, 4 );
	EXPECT_FALSE( alone.reachable );
	EXPECT_TRUE( with.reachable );
	EXPECT_NEAR( with.reachedModulus / material.youngsModulus, 1.0, 1e-5 );
	EXPECT_LE( with.substepsNeeded, 4 );
	EXPECT_GT( alone.substepsNeeded, 4 );
	EXPECT_TRUE( planStiffness( material, kCell, 1.0f / 60.0f, with.substepsNeeded ).reachable );
	EXPECT_FALSE( planStiffness( material, kCell, 1.0f / 60.0f, with.substepsNeeded - 1 ).reachable );

	EXPECT_TRUE( check( material ).ok() );
	for ( const int levels : { -1, 4 } )
	{
		Material bad = material;
		bad.farLevels = levels;
		EXPECT_FALSE( check( bad ).ok() );
	}
	Material raw = material, plastic = material, clusters = material;
	raw.stiffness = Stiffness::RawAlpha;
	plastic.yieldStrain = 0.1f;
	clusters.method = Method::Clusters;
	EXPECT_FALSE( check( raw ).ok() );
	EXPECT_FALSE( check( plastic ).ok() );
	EXPECT_FALSE( check( clusters ).ok() );

	Adaptivity levelsOfDetail;
	levelsOfDetail.coarseLevels = 2;
	const auto lattice = std::make_shared<Lattice>( makeBlockLattice( 16, 4, 4, kCell ) );
	EXPECT_FALSE( Body::create( lattice, material, {}, nullptr, levelsOfDetail ).ok() );
	const auto made = Body::create( lattice, material, {} );
	ASSERT_TRUE( made.ok() );
	EXPECT_EQ( made.value->material().farLevels, 2 ); // 16 cells are 2 blocks of 8: too few for a third level
}

} // namespace
} // namespace pliant
