// The implicit substep of bodies with levels of detail: the operator of their regions, and conservation while nodes are split and merged.

#include "body/implicit/implicit_motion.h"
#include "body/implicit_levels_case.h"
#include "support/solve_alone.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace pliant {
namespace {

using namespace implicit_case;

/// Returns - m dv of one explicit step of alpha from the rest positions displaced by `move`, in units of mass and displacement: minus the
/// directional derivative of the elastic force.
std::vector<float> forceOf( Rates& r, const std::vector<float>& move )
{
	NodeState& nodes = r.body.nodes();
	const NodeState before = nodes;
	const std::size_t padded = std::size_t( nodes.padded );
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.set(
			i, nodes.x.get( i ) + Vec3( move[std::size_t( i )], move[padded + std::size_t( i )], move[2 * padded + std::size_t( i )] ) );
		nodes.v.set( i, Vec3::Zero() );
	}
	r.matcher.reset( nodes, Eigen::Quaterniond::Identity() );
	r.matcher.accelerate( nodes, Rates::matchStep(), nullptr );
	const std::vector<float> force = r.field( [&]( int i ) { return Vec3( -nodes.mass[i] * nodes.v.get( i ) ); } );
	nodes = before;
	return force;
}

TEST( ImplicitLevels, TheirOperatorIsSymmetricLeavesRigidMotionsAndBoundsTheForcesDerivative )
{
	const std::vector<Rule> all = rules();
	for ( std::size_t which = 0; which < 2 * all.size(); ++which )
	{
		const Rule& rule = all[which / 2];
		Material soft = material( 1.0f );
		soft.volumeKeeping = which % 2 == 0 ? 0.0f : 2.0f;
		auto body = make( 12, 8, 8, soft, rule.settings );
		splitHalf( *body );
		EXPECT_GT( body->levels()->nodesOnLevel()[2] * body->levels()->nodesOnLevel()[1] * body->levels()->nodesOnLevel()[0], 0 )
			<< rule.name;
		Rates r( *body );
		test::Seeded random( 5 );
		const auto noise = [&] { return r.field( [&]( int ) { return random.inBox( 1.0f ); } ); };
		const auto masses = [&]( const std::vector<float>& v ) { return r( v, 0.0f ); };
		double most = 0.0, least = 1.0;
		for ( int k = 0; k < 5; ++k )
		{
			const std::vector<float> a = noise(), b = noise(), ka = r( a, 100.0f ), kb = r( b, 100.0f );
			EXPECT_NEAR( product( b, ka ), product( a, kb ), 3e-5 * std::sqrt( product( a, ka ) * product( b, kb ) ) ) << rule.name;
			// v . A v with the stiffness 1, without the masses' part, against v . f of a small displacement.
			std::vector<float> small = a;
			for ( float& value : small )
			{
				value *= 1e-4f;
			}
			const double force = product( small, forceOf( r, small ) ),
						 own = product( small, r( small, 1.0f ) ) - product( small, masses( small ) );
			most = std::max( most, force / own );
			least = std::min( least, force / own );
		}
		std::printf( "%s: the force's derivative is %.3f to %.3f of the operator\n", rule.name, least, most );
		EXPECT_LT( most, 1.0 + 2e-3 ) << rule.name;
		EXPECT_GT( least, 0.4 ) << rule.name; // noise is mostly what eta releases
		const std::vector<float> turn = r.field(
			[&]( int i ) { return Vec3( Vec3( 1, 2, -1 ) + Vec3( 0.5f, -1.0f, 2.0f ).cross( body->nodes().x.get( i ) ) ); } );
		const std::vector<float> free = masses( turn ), stiff = r( turn, 3000.0f );
		double off = 0.0;
		for ( std::size_t k = 0; k < turn.size(); ++k )
		{
			off = std::max( off, std::abs( double( stiff[k] - free[k] ) ) );
		}
		EXPECT_LT( off, 1e-2 * std::sqrt( product( free, free ) / double( body->nodeCount() ) ) ) << rule.name;
	}
}

// The regions of a plate are anisotropic: stretched along each axis, their force is bounded by the largest stretch and not by the mean.
TEST( ImplicitLevels, TheirOperatorBoundsStretchAlongEachAxis )
{
	const Eigen::Vector3i sizes[3] = { { 12, 8, 8 }, { 12, 12, 3 }, { 16, 3, 3 } };
	for ( int which = 0; which < 6; ++which )
	{
		const Eigen::Vector3i& size = sizes[which / 2];
		Material soft = material( 1.0f );
		soft.volumeKeeping = which % 2 == 0 ? 0.0f : kLargestVolumeKeeping;
		auto body = make( size.x(), size.y(), size.z(), soft, levels( 2 ) );
		Rates r( *body );
		for ( int axis = 0; axis < 3; ++axis )
		{
			const std::vector<float> move = r.field( [&]( int i ) {
				Vec3 value = Vec3::Zero();
				value[axis] = 1e-3f * body->nodes().x0.get( i )[axis];
				return value;
			} );
			const double force = product( move, forceOf( r, move ) ),
						 own = product( move, r( move, 1.0f ) ) - product( move, r( move, 0.0f ) );
			std::printf( "%d x %d x %d along %d: %.3e of %.3e\n", size.x(), size.y(), size.z(), axis, force, own );
			EXPECT_LE( force, ( 1.0 + 2e-3 ) * own ); // a plate of one big node has no stiffness across itself
			EXPECT_GE( force, 0.6 * own );
		}
	}
}

TEST( ImplicitLevels, FollowAChangeOfLevels )
{
	const auto push = []( Body& body ) { body.pushImplicitly( kStep, 30.0f, Vec3::Zero(), nullptr ); };
	auto changed = make( 12, 8, 8, material( 30.0f ), levels( 2 ) ), fresh = make( 12, 8, 8, material( 30.0f ), levels( 2 ) );
	push( *changed );
	splitHalf( *changed );
	splitHalf( *fresh );
	push( *changed );
	push( *fresh );
	ASSERT_EQ( changed->nodeCount(), fresh->nodeCount() );
	const std::size_t size = std::size_t( fresh->implicit()->size() );
	AlignedArray<float> v( size ), ofChanged( size ), ofFresh( size );
	test::Seeded random( 3 );
	for ( float& value : v )
	{
		value = random.uniform( -1, 1 );
	}
	changed->implicit()->apply( v.data(), ofChanged.data(), nullptr );
	fresh->implicit()->apply( v.data(), ofFresh.data(), nullptr );
	for ( int i = 0; i < fresh->nodeCount(); ++i )
	{
		EXPECT_EQ( changed->implicit()->diagonal( i ), fresh->implicit()->diagonal( i ) );
		EXPECT_NEAR( ofChanged[std::size_t( i )], ofFresh[std::size_t( i )], 1e-3f * std::abs( ofFresh[std::size_t( i )] ) + 1e-2f );
	}
}

TEST( ImplicitLevels, OfFinestCellsAloneAreTheUniformBody )
{
	auto fine = make( 6, 5, 4, material( 30.0f ), levels( 1 ) );
	std::vector<std::uint32_t> split;
	for ( int i = 0; i < fine->nodeCount(); ++i )
	{
		if ( fine->levels()->levelOf( i ) > 0 )
		{
			split.push_back( fine->levels()->cut().node[std::size_t( i )] );
		}
	}
	fine->changeLevels( split, {} );
	auto uniform = test::makeBlock( 6, 5, 4, 0.1f, material( 30.0f ) );
	ASSERT_EQ( fine->nodeCount(), uniform->nodeCount() );
	for ( int k = 0; k < 20; ++k )
	{
		for ( Body* body : { fine.get(), uniform.get() } )
		{
			for ( int i = 0; i < body->nodeCount() && k == 0; ++i )
			{
				body->nodes().x.set( i, body->nodes().x0.get( i ).cwiseProduct( Vec3( 1.2f, 0.9f, 1.0f ) ) );
			}
			body->pushImplicitly( kStep, planStiffness( body->material(), 0.1f, kStep, 1 ).alpha, Vec3::Zero(), nullptr );
			test::solveAlone( *body );
			EXPECT_EQ( body->integrate( kStep ), BodyHealth::Good );
		}
	}
	// Nodes are ordered differently, so sums round differently: positions agree, but not to the bit.
	double apart = 0.0;
	for ( int i = 0; i < fine->nodeCount(); ++i )
	{
		double nearest = HUGE_VAL;
		int twin = -1;
		for ( int j = 0; j < uniform->nodeCount(); ++j )
		{
			const double distance = double( ( fine->nodes().x0.get( i ) - uniform->nodes().x0.get( j ) ).norm() );
			twin = distance < nearest ? j : twin;
			nearest = std::min( nearest, distance );
		}
		apart = std::max( apart, ( fine->nodes().worldPosition( i ) - uniform->nodes().worldPosition( twin ) ).norm() );
	}
	EXPECT_LT( apart, 1e-5 );
}

TEST( ImplicitLevels, GiveTheSameBitsOnEveryInstructionSet )
{
	for ( const Rule& rule : rules() )
	{
		auto body = make( 12, 8, 8, material( 1.0f ), rule.settings );
		splitHalf( *body );
		std::vector<float> once;
		for ( const KernelTarget target : { KernelTarget::Baseline, KernelTarget::Avx2, KernelTarget::Avx512 } )
		{
			if ( const Kernels* kernels = findKernels( target ) )
			{
				Rates r( *body, *kernels );
				test::Seeded random( 5 );
				const std::vector<float> got = r( r.field( [&]( int ) { return random.inBox( 1.0f ); } ), 30.0f );
				once = once.empty() ? got : once;
				EXPECT_EQ( got, once ) << rule.name << " " << kernels->name;
			}
		}
	}
}

/// A bar of 16 cells, held at its top, some time after its release.
std::unique_ptr<Body> hung( const Adaptivity& settings, Elasticity elasticity )
{
	Material m = material( 1.0f );
	m.elasticity = elasticity;
	m.damping = 10.0f;
	m.wobbleDamping = 0.7f;
	m.youngsModulus = 1e6f;
	auto body = make( 4, 16, 4, m, settings );
	splitHalf( *body );
	for ( int i = 0; i < body->nodeCount(); ++i )
	{
		body->setPinned( i, body->nodes().x0.y[i] > 0.4f );
	}
	const bool isImplicit = elasticity == Elasticity::Implicit;
	const float h = isImplicit ? kStep : kStep / 10.0f;
	const float alpha = planStiffness( m, 0.1f, h, 1 ).alpha;
	const Vec3 gravity( 0, -9.81f, 0 );
	for ( int k = 0; k < int( 3.0f / h ); ++k )
	{
		if ( isImplicit )
		{
			body->pushImplicitly( h, alpha, gravity, nullptr );
			test::solveAlone( *body );
			body->integrate( h );
			continue;
		}
		test::substep( *body, h, alpha, gravity );
	}
	return body;
}

TEST( ImplicitLevels, HangAsTheyDoExplicitly )
{
	for ( const Rule& rule : rules() )
	{
		const auto explicitOne = hung( rule.settings, Elasticity::Explicit ), implicitOne = hung( rule.settings, Elasticity::Implicit );
		ASSERT_EQ( explicitOne->nodeCount(), implicitOne->nodeCount() );
		double sag = 0.0, apart = 0.0;
		for ( int i = 0; i < explicitOne->nodeCount(); ++i )
		{
			const Vec3d position = explicitOne->nodes().worldPosition( i );
			sag = std::max( sag, ( position - explicitOne->nodes().x0.get( i ).cast<double>() ).norm() );
			apart = std::max( apart, ( position - implicitOne->nodes().worldPosition( i ) ).norm() );
		}
		std::printf( "%s: sag %.5f m, nodes %.1e m apart\n", rule.name, sag, apart );
		EXPECT_GT( sag, 0.004 ) << rule.name;
		EXPECT_LT( apart, 0.005 * sag ) << rule.name;
	}
}

TEST( ImplicitLevels, KeepMomentumAndSpinInFreeFlightWhileNodesAreSplitAndMerged )
{
	for ( const float alpha : { 0.5f, 30.0f, 3000.0f } )
	{
		Adaptivity settings = levels( 2 );
		settings.refineStrain = 0.02f;
		settings.mergeDelay = 0.1f;
		Material m = material( alpha );
		m.numericalDamping = 0.0f; // undamped oscillation
		auto body = make( 12, 8, 8, m, settings );
		for ( int i = 0; i < body->nodeCount(); ++i )
		{
			body->nodes().x.set( i, body->nodes().x0.get( i ).cwiseProduct( Vec3( 1.1f, 0.9f, 1.0f ) ) );
			body->nodes().v.set( i, Vec3( 1, 2, -1 ) + Vec3( 0.5f, 2.0f, 1.0f ).cross( body->nodes().x.get( i ) ) );
		}
		const BodySums before = body->sums();
		int changes = 0, most = 0, least = 1 << 20;
		for ( int k = 0; k < 600; ++k )
		{
			body->openLevelBudget();
			changes += body->adaptLevels( kStep ) ? 1 : 0;
			most = std::max( most, body->nodeCount() );
			least = std::min( least, body->nodeCount() );
			body->pushImplicitly( kStep, planStiffness( body->material(), 0.1f, kStep, 1 ).alpha, Vec3::Zero(), nullptr );
			test::solveAlone( *body );
			ASSERT_EQ( body->integrate( kStep ), BodyHealth::Good );
		}
		const BodySums after = body->sums();
		const double momentum = ( after.momentum - before.momentum ).norm() / before.momentum.norm(),
					 spin = ( after.spin - before.spin ).norm() / before.spin.norm();
		std::printf(
			"alpha %6.1f: %d changes, %d to %d nodes, momentum %.1e, spin %.1e\n", double( alpha ), changes, least, most, momentum, spin );
		EXPECT_GT( changes, 1 );
		EXPECT_LT( momentum, 1e-5 );
		EXPECT_LT( spin, 1e-4 );
	}
}

} // namespace
} // namespace pliant
