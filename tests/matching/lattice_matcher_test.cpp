// The kernels compared with the reference implementation, and the guarantee of equal bits.

#include "matching/reference/reference_matcher.h"
#include "matching/step/lattice_matcher.h"
#include "pliant/task_runner.h"
#include "support/block_body.h"
#include "support/block_lattice.h"
#include "support/explicit_material.h"

#include <gtest/gtest.h>

#include <cstring>

namespace pliant {
namespace {

/// A block rotated, moved and displaced at random by `shake` cells a node.
NodeState shaken( const Lattice& lattice, float shake )
{
	NodeState nodes = test::restNodes( lattice );
	test::Seeded random( 7 );
	const Eigen::Matrix3f turn = Eigen::AngleAxisf( 1.3f, Vec3( 1, 2, 3 ).normalized() ).toRotationMatrix();
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.set( i, turn * nodes.x0.get( i ) + random.inBox( shake * lattice.cellSize ) + Vec3( 3, 1, -2 ) );
		nodes.v.set( i, random.inBox( 1.0f ) );
	}
	return nodes;
}

/// A block with a missing corner and a slit: regions that are not full cubes.
Lattice crackedLattice()
{
	Lattice lattice = makeBlockLattice( 7, 6, 5, 0.1f );
	std::vector<std::uint32_t> start( 1, 0 ), to;
	for ( int i = 0; i < lattice.cellCount(); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			const auto a = lattice.coordinate[i], b = lattice.coordinate[lattice.linkTo[k]];
			const bool crossesSlit = ( a.x() <= 3 ) != ( b.x() <= 3 ) && std::max( a.y(), b.y() ) >= 3;
			if ( !crossesSlit )
			{
				to.push_back( lattice.linkTo[k] );
			}
		}
		start.push_back( std::uint32_t( to.size() ) );
	}
	lattice.linkStart = start;
	lattice.linkTo = to;
	return lattice;
}

float worstDifference( const NodeState& a, const NodeState& b )
{
	float worst = 0.0f;
	for ( int i = 0; i < a.count; ++i )
	{
		worst = std::max( worst, ( a.v.get( i ) - b.v.get( i ) ).norm() );
	}
	return worst;
}

float largestSpeed( const NodeState& nodes )
{
	float largest = 0.0f;
	for ( int i = 0; i < nodes.count; ++i )
	{
		largest = std::max( largest, nodes.v.get( i ).norm() );
	}
	return largest;
}

bool sameBits( const AlignedArray<float>& a, const AlignedArray<float>& b )
{
	return a.size() == b.size() && std::memcmp( a.data(), b.data(), a.size() * sizeof( float ) ) == 0;
}

bool sameVelocities( const NodeState& a, const NodeState& b )
{
	return sameBits( a.v.x, b.v.x ) && sameBits( a.v.y, b.v.y ) && sameBits( a.v.z, b.v.z );
}

struct Setting
{
	int halfWidth;
	float beta;
	Weights weights;
	RotationFrom rotationFrom;
};

class AgainstReference : public testing::TestWithParam<Setting>
{};

TEST_P( AgainstReference, AgreesOverTenSubsteps )
{
	Material material = test::explicitMaterial();
	material.regionHalfWidth = GetParam().halfWidth;
	material.beta = GetParam().beta;
	material.weights = GetParam().weights;
	material.rotationFrom = GetParam().rotationFrom;
	const MatchStep step{ 1.0f / 240.0f, 0.7f, 10.0f, 0.0f, 0.2f };
	for ( const Lattice& lattice : { makeBlockLattice( 9, 7, 8, 0.1f ), crackedLattice() } )
	{
		ReferenceMatcher slow( lattice, material );
		NodeState wanted = shaken( lattice, 0.2f );
		slow.reset( wanted, Eigen::Quaterniond::Identity() );
		std::vector<NodeState> seen;
		for ( Summation summation : { Summation::Table, Summation::BoxSums } )
		{
			LatticeMatcher fast( lattice, material, summation );
			seen.push_back( shaken( lattice, 0.2f ) );
			fast.reset( seen.back(), Eigen::Quaterniond::Identity() );
			for ( int k = 0; k < 10; ++k )
			{
				fast.accelerate( seen.back(), step, nullptr );
			}
		}
		for ( int k = 0; k < 10; ++k )
		{
			slow.accelerate( wanted, step, nullptr );
		}
		// The reference keeps the net impulse left by rounding and by masses in float; the kernels remove it.
		EXPECT_LT( worstDifference( seen[0], wanted ), 1e-3f * largestSpeed( wanted ) );
		EXPECT_LT( worstDifference( seen[1], wanted ), 1e-3f * largestSpeed( wanted ) );
		EXPECT_LT( worstDifference( seen[0], seen[1] ), 1e-5f * largestSpeed( wanted ) );
	}
}

INSTANTIATE_TEST_SUITE_P( Settings, AgainstReference,
	testing::Values( Setting{ 1, 0.0f, Weights::Conserving, RotationFrom::Apq }, Setting{ 2, 0.0f, Weights::Conserving, RotationFrom::Apq },
		Setting{ 3, 0.0f, Weights::Conserving, RotationFrom::Apq }, Setting{ 1, 0.6f, Weights::Conserving, RotationFrom::Apq },
		Setting{ 1, 0.0f, Weights::Literal, RotationFrom::Apq }, Setting{ 2, 0.0f, Weights::Literal, RotationFrom::F },
		Setting{ 1, 0.3f, Weights::Conserving, RotationFrom::F } ) );

TEST( LatticeMatcher, ChoosesBoxSumsOnlyWhereRegionsAreFullCubes )
{
	const Lattice full = makeBlockLattice( 6, 6, 6, 0.1f ), cracked = crackedLattice();
	EXPECT_TRUE( LatticeMatcher( full, Material{} ).usesBoxSums() );
	EXPECT_FALSE( LatticeMatcher( cracked, Material{} ).usesBoxSums() );
	EXPECT_FALSE( LatticeMatcher( cracked, Material{}, Summation::BoxSums ).usesBoxSums() );
}

TEST( LatticeMatcher, GivesTheSameBitsOnEveryInstructionSet )
{
	const MatchStep step{ 1.0f / 240.0f, 0.8f, 10.0f, 3.0f, 0.0f };
	int tried = 0;
	for ( int halfWidth : { 1, 2, 3 } )
	{
		for ( float shake : { 0.1f, 3.0f } ) // 3 cells: many regions take the careful rotation
		{
			const Lattice lattice = crackedLattice();
			Material material = test::explicitMaterial();
			material.regionHalfWidth = halfWidth;
			material.beta = 0.3f;
			std::vector<NodeState> results;
			for ( KernelTarget target : { KernelTarget::Baseline, KernelTarget::Avx2, KernelTarget::Avx512 } )
			{
				const Kernels* kernels = findKernels( target );
				if ( !kernels )
				{
					continue;
				}
				LatticeMatcher matcher( lattice, material, Summation::Automatic, *kernels );
				results.push_back( shaken( lattice, shake ) );
				for ( int k = 0; k < 20; ++k )
				{
					matcher.accelerate( results.back(), step, nullptr );
				}
				EXPECT_TRUE( sameVelocities( results.front(), results.back() ) ) << kernels->name;
				++tried;
			}
		}
	}
	EXPECT_GE( tried, 6 );
}

TEST( LatticeMatcher, GivesTheSameBitsForAnyThreadCount )
{
	const MatchStep step{ 1.0f / 240.0f, 0.8f, 10.0f, 3.0f, 0.0f };
	const Lattice lattice = makeBlockLattice( 17, 16, 15, 0.1f );
	for ( Summation summation : { Summation::Table, Summation::BoxSums } )
	{
		std::vector<NodeState> results;
		for ( int threads : { 1, 2, 4, 8 } )
		{
			const auto pool = createThreadPool( threads );
			LatticeMatcher matcher( lattice, Material{}, summation );
			results.push_back( shaken( lattice, 0.5f ) );
			for ( int k = 0; k < 10; ++k )
			{
				matcher.accelerate( results.back(), step, pool.get() );
			}
			EXPECT_TRUE( sameVelocities( results.front(), results.back() ) ) << threads << " threads";
		}
	}
}

TEST( LatticeMatcher, LeavesARigidMotionAlone )
{
	const Lattice lattice = makeBlockLattice( 8, 6, 7, 0.1f );
	NodeState nodes = test::restNodes( lattice );
	const Eigen::Matrix3f turn = Eigen::AngleAxisf( 2.6f, Vec3( -1, 2, 0.5f ).normalized() ).toRotationMatrix();
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.set( i, turn * nodes.x0.get( i ) + Vec3( 5, -3, 2 ) );
	}
	LatticeMatcher matcher( lattice, Material{} );
	matcher.accelerate( nodes, MatchStep{ 1.0f / 240.0f, 1.0f, 10.0f, 3.0f, 0.0f }, nullptr );

	// Positions of a few metres are accurate to 5e-7 m; at 240 substeps a second that is 1e-4 m/s.
	EXPECT_LT( largestSpeed( nodes ), 2.5e-4f );
	std::vector<float> q( nodes.count * 4 );
	matcher.nodeRotations( nodes, q.data() );
	const Eigen::Quaternionf expected( turn );
	EXPECT_LT( Eigen::Quaternionf( q[3], q[0], q[1], q[2] ).angularDistance( expected ), 1e-5f );
}

TEST( LatticeMatcher, RegionVelocityDampingIsTheSameLawForSmallMotion )
{
	// Rivers and James damp towards each region's mean rigid motion; the kernels damp the change of goal - position. For small
	// strain rates both are - k ( v - P v ) with the same averaging P.
	const Lattice lattice = makeBlockLattice( 6, 5, 7, 0.1f );
	const float h = 1.0f / 240.0f;
	NodeState a = test::restNodes( lattice ), b = a;
	ReferenceMatcher rate( lattice, Material{}, DampingForm::GoalRate ), literal( lattice, Material{}, DampingForm::RegionVelocity );
	test::Seeded random( 3 );
	rate.accelerate( a, MatchStep{ h, 1e-6f, 20.0f, 0.0f, 0.0f }, nullptr );
	for ( int i = 0; i < a.count; ++i )
	{
		const Vec3 v = Vec3( 0.1f, 0.2f, 0.3f ).cross( a.x.get( i ) ) + random.inBox( 0.01f );
		a.v.set( i, v );
		a.x.set( i, a.x.get( i ) + h * v );
	}
	b = a;
	const NodeState before = a;
	rate.accelerate( a, MatchStep{ h, 1e-6f, 20.0f, 0.0f, 0.0f }, nullptr );
	literal.accelerate( b, MatchStep{ h, 1e-6f, 20.0f, 0.0f, 0.0f }, nullptr );
	EXPECT_GT( worstDifference( a, before ), 5e-4f );
	EXPECT_LT( worstDifference( a, b ), 0.02f * worstDifference( a, before ) );
}

} // namespace
} // namespace pliant
