// Müller's clusters: conservation, recovery, and the deformations that each mode can follow.

#include "matching/clusters/cluster_matcher.h"
#include "support/explicit_material.h"
#include "support/kept_links.h"

#include "matching/raised_inverse.h"
#include "pliant/task_runner.h"
#include "support/block_body.h"
#include "support/block_lattice.h"
#include "support/inverted_fraction.h"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace pliant {
namespace {

constexpr float kStep = 1.0f / 240.0f;

struct Kind
{
	Method method;
	ClusterMode mode;
	float beta;
};

Material materialOf( const Kind& kind, int edge = 4 )
{
	Material material = test::explicitMaterial();
	material.method = kind.method;
	material.clusterMode = kind.mode;
	material.beta = kind.beta;
	material.clusterEdge = edge;
	return material;
}

std::vector<Kind> allKinds()
{
	std::vector<Kind> kinds;
	for ( Method method : { Method::SingleCluster, Method::Clusters } )
	{
		kinds.push_back( { method, ClusterMode::Rigid, 0.0f } );
		for ( ClusterMode mode : { ClusterMode::Linear, ClusterMode::Quadratic } )
		{
			kinds.push_back( { method, mode, 0.6f } );
			kinds.push_back( { method, mode, 0.9f } );
		}
	}
	return kinds;
}

/// Change of velocities by one call, for nodes at rest, m/s.
Vec3Array changeOf( Matcher& matcher, NodeState& nodes, const MatchStep& step, TaskRunner* runner = nullptr )
{
	nodes.v.resize( nodes.padded );
	matcher.accelerate( nodes, step, runner );
	return nodes.v;
}

double largest( const Vec3Array& values, int count )
{
	double most = 0.0;
	for ( int i = 0; i < count; ++i )
	{
		most = std::max( most, double( values.get( i ).norm() ) );
	}
	return most;
}

std::string nameOf( const testing::TestParamInfo<Kind>& info )
{
	static const char* const modes[] = { "Rigid", "Linear", "Quadratic" };
	return std::string( info.param.method == Method::Clusters ? "Boxes" : "Single" ) + modes[int( info.param.mode )] +
		std::to_string( std::lround( info.param.beta * 10.0f ) );
}

class Clusters : public testing::TestWithParam<Kind>
{};

INSTANTIATE_TEST_SUITE_P( Kinds, Clusters, testing::ValuesIn( allKinds() ), nameOf );

TEST_P( Clusters, LeaveARigidMotionAlone )
{
	const Lattice lattice = makeBlockLattice( 7, 5, 9, 0.1f );
	NodeState nodes = test::restNodes( lattice );
	const Material material = materialOf( GetParam() );
	const auto matcher = makeClusterMatcher( lattice, material, nodes );
	const MatchStep step{ kStep, 1.0f, 10.0f, 0.0f, 0.0f };
	EXPECT_LT( largest( changeOf( *matcher, nodes, step ), nodes.count ) * kStep, 1e-6 ); // at rest, m

	// Rotated by 170 degrees at once: no history helps.
	const Eigen::Quaterniond turn( Eigen::AngleAxisd( 2.967, Vec3d( 1, -2, 3 ).normalized() ) );
	matcher->reset( nodes, turn );
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.set( i, ( turn * nodes.x0.get( i ).cast<double>() + Vec3d( 0.3, -0.2, 0.5 ) ).cast<float>() );
	}
	EXPECT_LT( largest( changeOf( *matcher, nodes, step ), nodes.count ) * kStep, 1e-6 );

	std::vector<float> q( 4 * std::size_t( nodes.count ) );
	matcher->nodeRotations( nodes, q.data() );
	for ( int i = 0; i < nodes.count; ++i )
	{
		EXPECT_GT( std::abs( Eigen::Map<Eigen::Vector4f>( q.data() + 4 * i ).cast<double>().dot( turn.coeffs() ) ), 1.0 - 1e-6 );
	}
}

TEST_P( Clusters, KeepBothMomentaInFreeFlight )
{
	const auto body = test::makeBlock( 6, 5, 7, 0.1f, materialOf( GetParam() ) );
	NodeState& nodes = body->nodes();
	test::Seeded random( 3 );
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3 x = nodes.x.get( i );
		nodes.v.set( i, Vec3( 1, 2, -1 ) + Vec3( 1, 2, 3 ).cross( x ) + Vec3( 0.5f * x.x(), -0.7f * x.y(), x.x() * x.y() ) );
		nodes.x.set( i, x + random.inBox( 0.02f ) );
	}
	const BodySums before = body->sums();
	for ( int k = 0; k < 600; ++k )
	{
		ASSERT_EQ( test::substep( *body, kStep, 0.5f ), BodyHealth::Good );
	}
	const BodySums after = body->sums();
	EXPECT_LT( ( after.momentum - before.momentum ).norm() / before.momentum.norm(), 1e-5 );
	EXPECT_LT( ( after.spin - before.spin ).norm() / before.spin.norm(), 1e-4 );
	EXPECT_LT( after.kineticEnergy, before.kineticEnergy * 1.5 ); // the initial stretch adds a little
}

TEST_P( Clusters, ComeBackFromAnything )
{
	const std::function<Vec3( const Vec3& )> mangles[] = {
		[]( const Vec3& x ) { return Vec3( x.x(), 0.0f, x.z() ); },
		[]( const Vec3& x ) { return Vec3( x.x(), -x.y(), x.z() ); },
		[]( const Vec3& x ) { return Vec3( x.x(), -0.25f * x.y(), x.z() ); },
		[]( const Vec3& ) { return Vec3( 0, 0, 0 ); },
		[]( const Vec3& x ) { return Vec3( 3.0f * x.x(), 0.0f, 0.0f ); },
	};
	for ( const auto& mangle : mangles )
	{
		const auto body = test::makeBlock( 6, 4, 4, 1.0f / 6.0f, materialOf( GetParam() ) );
		NodeState& nodes = body->nodes();
		for ( int i = 0; i < nodes.count; ++i )
		{
			nodes.x.set( i, mangle( nodes.x.get( i ) ) );
		}
		for ( int k = 0; k < 1800; ++k )
		{
			ASSERT_EQ( test::substep( *body, kStep, 0.3f ), BodyHealth::Good );
		}
		EXPECT_EQ( test::invertedFraction( *body ), 0.0f );
		EXPECT_LT( test::shapeError( *body ), 2e-3 ) << "mangle " << &mangle - mangles;
	}
}

TEST_P( Clusters, ComputeTheSameBitsOnAnyThreadCount )
{
	const Lattice lattice = makeBlockLattice( 13, 11, 17, 0.1f );
	std::vector<Vec3Array> results;
	for ( int threads : { 1, 2, 5 } )
	{
		NodeState nodes = test::restNodes( lattice );
		const auto matcher = makeClusterMatcher( lattice, materialOf( GetParam(), 5 ), nodes );
		const std::unique_ptr<TaskRunner> runner = createThreadPool( threads );
		test::Seeded random( 9 );
		for ( int i = 0; i < nodes.count; ++i )
		{
			nodes.x.set( i, nodes.x0.get( i ) + random.inBox( 0.05f ) );
		}
		for ( int k = 0; k < 3; ++k )
		{
			matcher->accelerate( nodes, MatchStep{ kStep, 0.7f, 10.0f, 1.0f, 0.1f }, runner.get() );
		}
		results.push_back( nodes.v );
	}
	for ( const Vec3Array& other : results )
	{
		EXPECT_TRUE( other.x == results[0].x && other.y == results[0].y && other.z == results[0].z );
	}
}

TEST( SingleCluster, ReachesItsRigidGoalInOneStiffStep )
{
	Material material = materialOf( { Method::SingleCluster, ClusterMode::Rigid, 0.0f } );
	material.damping = 0.0f;
	material.wobbleDamping = 0.0f;
	const auto body = test::makeBlock( 6, 4, 5, 0.1f, material );
	NodeState& nodes = body->nodes();
	test::Seeded random( 4 );
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.set( i, nodes.x.get( i ) + random.inBox( 0.05f ) );
	}
	EXPECT_GT( test::shapeError( *body ), 0.02 );
	test::substep( *body, kStep, 1.0f );
	EXPECT_LT( test::shapeError( *body ), 1e-6 );
}

/// Distance of the goals from a deformed shape when the fit may follow it, rms in cells: 0 for a mode that can follow it completely.
double unfollowed( ClusterMode mode, const std::function<Vec3( const Vec3& )>& deform )
{
	const Lattice lattice = makeBlockLattice( 12, 4, 4, 0.1f );
	NodeState nodes = test::restNodes( lattice );
	const auto matcher = makeClusterMatcher( lattice, materialOf( { Method::SingleCluster, mode, kLargestBeta } ), nodes );
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.set( i, deform( nodes.x0.get( i ) ) );
	}
	const Vec3Array change = changeOf( *matcher, nodes, MatchStep{ kStep, 1.0f, 0.0f, 0.0f, 0.0f } );
	double sum = 0.0;
	for ( int i = 0; i < nodes.count; ++i )
	{
		sum += change.get( i ).squaredNorm() * double( kStep ) * kStep;
	}
	return std::sqrt( sum / nodes.count ) / lattice.cellSize;
}

TEST( Modes, QuadraticFollowsBendingAndTwistingWhereLinearCannot )
{
	// A parabola, a twist and a saddle: of second order, so that the quadratic mode represents them exactly and resists with 1 - beta of
	// them.
	const auto bend = []( const Vec3& x ) { return Vec3( x.x() - 0.3f * x.x() * x.y(), x.y() + 0.15f * x.x() * x.x(), x.z() ); };
	const auto twist = []( const Vec3& x ) { return Vec3( x.x(), x.y() - 0.4f * x.x() * x.z(), x.z() + 0.4f * x.x() * x.y() ); };
	for ( const auto& deform : { std::function<Vec3( const Vec3& )>( bend ), std::function<Vec3( const Vec3& )>( twist ) } )
	{
		const double rigid = unfollowed( ClusterMode::Rigid, deform );
		const double linear = unfollowed( ClusterMode::Linear, deform );
		const double quadratic = unfollowed( ClusterMode::Quadratic, deform );
		std::printf( "left behind, cells: rigid %.4f, linear %.4f, quadratic %.4f\n", rigid, linear, quadratic );
		EXPECT_LT( quadratic, 0.08 * rigid ); // 1 - beta = 0.05, and the effect of the floor on thin directions
		EXPECT_GT( linear, 0.5 * rigid );
	}
}

TEST( Modes, LinearFollowsAStretchThatKeepsTheVolume )
{
	const auto shear = []( const Vec3& x ) { return Vec3( x.x() + 0.3f * x.y(), x.y(), x.z() ); };
	EXPECT_LT( unfollowed( ClusterMode::Linear, shear ), 0.06 * unfollowed( ClusterMode::Rigid, shear ) );

	// Uniform growth is not followed: A / cbrt( det A ) restores the rest volume.
	const auto grow = []( const Vec3& x ) { return Vec3( 1.2f * x ); };
	EXPECT_NEAR( unfollowed( ClusterMode::Linear, grow ) / unfollowed( ClusterMode::Rigid, grow ), 1.0, 1e-3 );
}

/// Displacement of the free end of a bar held at the other end under a weight, at rest, m.
double give( const Material& material, const Vec3& gravity )
{
	const auto body = test::makeBlock( 12, 4, 4, 0.05f, material );
	NodeState& nodes = body->nodes();
	const float left = nodes.x0.x[0], right = nodes.x0.x[nodes.count - 1];
	for ( int i = 0; i < nodes.count; ++i )
	{
		body->setPinned( i, nodes.x0.x[i] < left + 0.075f );
	}
	for ( int k = 0; k < 4000; ++k )
	{
		test::substep( *body, kStep, 0.5f, gravity );
	}
	EXPECT_LT( body->sums().kineticEnergy, 1e-5 * body->sums().mass );
	Vec3 sum = Vec3::Zero();
	int count = 0;
	for ( int i = 0; i < nodes.count; ++i )
	{
		if ( nodes.x0.x[i] > right - 0.025f )
		{
			sum += nodes.worldPosition( i ).cast<float>() - nodes.x0.get( i );
			++count;
		}
		EXPECT_FALSE( nodes.freedom[i] == 0.0f && nodes.v.get( i ).norm() > 0.0f ); // pinned nodes stay
	}
	return double( sum.dot( gravity.normalized() ) ) / count;
}

TEST( Modes, LargerBetaIsSofter )
{
	// Linear clusters deform under a pull; under bending only quadratic ones do.
	for ( ClusterMode mode : { ClusterMode::Linear, ClusterMode::Quadratic } )
	{
		for ( Vec3 gravity : { Vec3( 2, 0, 0 ), Vec3( 0, -0.1f, 0 ) } )
		{
			const double stiff = give( materialOf( { Method::Clusters, mode, 0.0f } ), gravity );
			const double middle = give( materialOf( { Method::Clusters, mode, 0.5f } ), gravity );
			const double soft = give( materialOf( { Method::Clusters, mode, 0.8f } ), gravity );
			std::printf( "%s clusters, %s: end gives way by %.4f, %.4f, %.4f m at beta 0, 0.5, 0.8\n",
				mode == ClusterMode::Linear ? "linear" : "quadratic", gravity.x() > 0.0f ? "pull" : "bend", stiff, middle, soft );
			EXPECT_GT( stiff, 0.0 );
			if ( mode == ClusterMode::Quadratic || gravity.x() > 0.0f )
			{
				EXPECT_GT( middle, 1.3 * stiff );
				EXPECT_GT( soft, 1.3 * middle );
			}
		}
	}
}

TEST( ClusterSet, BoxesOverlapByHalfAndEveryLinkLiesInOne )
{
	for ( int edge : { 2, 3, 4, 5, 8 } )
	{
		const Lattice lattice = makeBlockLattice( 11, 6, 3, 0.1f );
		const ClusterSet set = makeBoxClusters( lattice, edge );
		for ( int i = 0; i < lattice.cellCount(); ++i )
		{
			ASSERT_GE( set.coverCount( i ), 1 );
			for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
			{
				const int j = int( lattice.linkTo[k] );
				bool isShared = false;
				for ( std::uint32_t a = set.coverStart[i]; a < set.coverStart[i + 1]; ++a )
				{
					for ( std::uint32_t b = set.coverStart[j]; b < set.coverStart[j + 1]; ++b )
					{
						isShared |= set.cover[a] == set.cover[b];
					}
				}
				ASSERT_TRUE( isShared ) << "edge " << edge << ": cells " << i << " and " << j;
			}
		}
	}
	const ClusterSet row = makeBoxClusters( makeBlockLattice( 8, 1, 1, 0.1f ), 4 );
	ASSERT_EQ( row.count(), 3 ); // 0-3, 2-5, 4-7
	EXPECT_EQ( row.member, ( std::vector<std::uint32_t>{ 0, 1, 2, 3, 2, 3, 4, 5, 4, 5, 6, 7 } ) );
}

/// A row of cells without the links between the two cells at `cut` and `cut + 1`.
Lattice cutRow( int cells, int cut )
{
	Lattice lattice = makeBlockLattice( cells, 1, 1, 0.1f );
	test::keepLinks( lattice, [cut]( std::uint32_t i, std::uint32_t j ) { return int( std::min( i, j ) ) != cut; } );
	return lattice;
}

TEST( ClusterSet, ABoxIsCutWhereTheMaterialIs )
{
	const Lattice lattice = cutRow( 4, 1 );
	const ClusterSet set = makeBoxClusters( lattice, 4 );
	ASSERT_EQ( set.count(), 2 );
	EXPECT_EQ( set.member, ( std::vector<std::uint32_t>{ 0, 1, 2, 3 } ) );
	EXPECT_EQ( set.start, ( std::vector<std::uint32_t>{ 0, 2, 4 } ) );

	// The two halves do not affect each other.
	NodeState nodes = test::restNodes( lattice );
	const auto matcher = makeClusterMatcher( lattice, materialOf( { Method::Clusters, ClusterMode::Rigid, 0.0f } ), nodes );
	nodes.x.set( 2, nodes.x.get( 2 ) + Vec3( 0, 1, 0 ) );
	nodes.x.set( 3, nodes.x.get( 3 ) + Vec3( 0, 1, 0 ) );
	EXPECT_LT( largest( changeOf( *matcher, nodes, MatchStep{ kStep, 1.0f, 0.0f, 0.0f, 0.0f } ), nodes.count ) * kStep, 1e-6 );
}

TEST( RaisedInverse, InvertsWhatHasAnInverseAndRaisesWhatHasNone )
{
	test::Seeded random( 8 );
	Moment9 m = Moment9::Zero();
	for ( int k = 0; k < 5; ++k ) // rank 5
	{
		Eigen::Matrix<double, 9, 1> a;
		for ( int i = 0; i < 9; ++i )
		{
			a[i] = random.uniform( -1, 1 );
		}
		m += a * a.transpose();
	}
	const Moment9 full = m + Moment9( Moment9::Identity() );
	EXPECT_LT( ( raisedInverse( full, 1e-6 ) * full - Moment9::Identity() ).norm(), 1e-12 );

	const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver( Eigen::MatrixXd( raisedInverse( m, 1e-3 ) ) );
	const double top = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>( Eigen::MatrixXd( m ) ).eigenvalues()[8];
	EXPECT_NEAR( solver.eigenvalues()[8] * 1e-3 * top, 1.0, 1e-9 );
	EXPECT_EQ( raisedInverse( Moment9::Zero(), 1e-3 ), Moment9( Moment9::Zero() ) );
}

} // namespace
} // namespace pliant
