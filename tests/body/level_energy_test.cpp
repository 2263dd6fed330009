// Limits on the change of a body's energy by a change of levels, part by part. Whole impacts: RandomImpacts.SplitsByStrainAddNoEnergy.

#include "body/body.h"
#include "body/levels/level_nodes.h"
#include "body/levels/levels.h"
#include "matching/step/lattice_matcher.h"
#include "support/explicit_material.h"
#include "support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

namespace pliant {
namespace {

/// An isolated lump of big nodes.
struct Lump
{
	explicit Lump( const Material& of = {} ) :
		material( of ), lattice( test::makeBlobLattice( 18, 0.05f, 6 ) ), base( buildLevelBase( lattice, material, settings() ) ),
		levels( base, lattice, material, settings(), everywhere, firstCut( base->octree, settings() ) ),
		matcher( lattice, material, levels.tables() )
	{
		levels.fillNodes( nodes, material.density );
	}

	static Adaptivity settings()
	{
		Adaptivity wanted;
		wanted.coarseLevels = 2;
		return wanted;
	}

	void splitAll()
	{
		std::vector<std::uint32_t> split;
		for ( int i = 0; i < levels.cut().count(); ++i )
		{
			if ( levels.levelOf( i ) > 0 )
			{
				split.push_back( levels.cut().node[std::size_t( i )] );
			}
		}
		levels.change( nodes, matcher, material, split, {} );
	}

	/// Moves each node to the image of its rest position under `to`.
	template <class Map>
	void bend( const Map& to )
	{
		for ( int i = 0; i < nodes.count; ++i )
		{
			nodes.x.set( i, to( nodes.x0.get( i ) ) );
		}
		matcher.accelerate( nodes, MatchStep{ 0.01f, 0.0f }, nullptr ); // finds rotations, moves nothing
	}

	std::vector<std::uint32_t> all() const
	{
		std::vector<std::uint32_t> numbers( std::size_t( nodes.count ) );
		std::iota( numbers.begin(), numbers.end(), 0u );
		return numbers;
	}

	Material material = test::explicitMaterial();
	Lattice lattice;
	std::shared_ptr<const LevelBase> base;
	std::vector<float> everywhere;
	Levels levels;
	LatticeMatcher matcher;
	NodeState nodes;
};

Vec3 bent( const Vec3& p )
{
	const float turn = 1.5f * p.x();
	return Vec3( p.x(), p.y() * std::cos( turn ) - p.z() * std::sin( turn ),
		p.y() * std::sin( turn ) + 1.1f * p.z() * std::cos( turn ) + 0.4f * p.x() * p.x() );
}

Material withoutVolume()
{
	Material material = test::explicitMaterial();
	material.damping = 0.0f;
	material.volumeKeeping = 0.0f;
	return material;
}

/// dU / dt = - power for any motion of the nodes.
TEST( LevelEnergy, ItsChangeIsTheWorkOfTheForces )
{
	Lump lump( withoutVolume() );
	lump.splitAll(); // nodes of levels 0 and 1
	lump.bend( bent );
	std::mt19937 random( 3 );
	const auto number = [&random] { return float( random() ) / 2147483648.0f - 1.0f; };
	for ( int round = 0; round < 10; ++round )
	{
		for ( int i = 0; i < lump.nodes.count; ++i )
		{
			lump.nodes.v.set( i, Vec3( number(), number(), number() ) );
		}
		const auto springsAt = [&lump]( float seconds ) {
			NodeState moved = lump.nodes;
			for ( int i = 0; i < moved.count; ++i )
			{
				moved.x.set( i, moved.x.get( i ) + seconds * moved.v.get( i ) );
			}
			return lump.matcher.workOf( moved, lump.all() ).springs;
		};
		constexpr float kSeconds = 1e-3f;
		const double power = lump.matcher.workOf( lump.nodes, lump.all() ).power;
		const double rate = ( springsAt( kSeconds ) - springsAt( -kSeconds ) ) / ( 2.0 * kSeconds );
		EXPECT_NEAR( rate, -power, 0.01 * std::abs( power ) ) << round;
	}
}

/// H = K + U + h / 2 f.v of an oscillating body: of a soft one from its regions alone, and of one so stiff that it follows its rigid fit.
TEST( LevelEnergy, IsConservedByExplicitSteps )
{
	const auto lattice = std::make_shared<const Lattice>( test::makeBlobLattice( 18, 0.05f, 6 ) );
	for ( const float youngsModulus : { 2e4f, 1e6f, 1e8f } )
	{
		Material material = withoutVolume();
		material.youngsModulus = youngsModulus;
		material.wobbleDamping = 0.0f;
		const std::unique_ptr<Body> body = std::move( Body::create( lattice, material, {}, nullptr, Lump::settings() ).value );
		std::mt19937 random( 5 );
		const auto number = [&random] { return float( random() ) / 2147483648.0f - 1.0f; };
		for ( int i = 0; i < body->nodeCount(); ++i )
		{
			body->nodes().v.set( i, Vec3( number(), number(), number() ) );
		}
		constexpr float kEnergyStep = 1.0f / 960.0f;
		const float alpha = planStiffness( body->material(), lattice->cellSize, kEnergyStep, 1 ).alpha;
		const double first = body->sums().kineticEnergy; // unstrained
		double low = HUGE_VAL, high = 0.0, least = HUGE_VAL, lowPlain = HUGE_VAL, highPlain = 0.0;
		for ( int step = 0; step < 200; ++step )
		{
			body->accelerateTowardGoals( kEnergyStep, alpha, nullptr );
			body->integrate( kEnergyStep );
			const LevelEnergy held = body->storedEnergy();
			const double energy = body->joules( held, kEnergyStep, alpha );
			low = std::min( low, energy );
			high = std::max( high, energy );
			least = std::min( least, held.motion );
			LevelEnergy plain = held;
			plain.power = plain.deviationPower = 0.0;
			lowPlain = std::min( lowPlain, body->joules( plain, kEnergyStep, alpha ) );
			highPlain = std::max( highPlain, body->joules( plain, kEnergyStep, alpha ) );
		}
		std::printf( "E %g, alpha %.3f: H from %.4f to %.4f of the first, K + U from %.2f to %.2f, K down to %.3f\n",
			double( youngsModulus ), double( alpha ), low / first, high / first, lowPlain / first, highPlain / first, least / first );
		EXPECT_GT( low, 0.999 * first );
		EXPECT_LT( high, 1.001 * first );
		EXPECT_LT( least, 0.8 * first );
	}
}

/// Children placed by their own parent's F alone would be inconsistent with their neighbours, which adds energy.
TEST( LevelEnergy, ChildrenInABentBodyAreConsistent )
{
	Lump lump;
	lump.bend( bent );
	const NodeState before = lump.nodes;
	std::vector<float> f( 9 * std::size_t( before.padded ) );
	NodeState readable = before;
	lump.matcher.deformations( readable, f.data() );
	lump.splitAll();

	NodeState naive = lump.nodes;
	std::vector<Vec3d> centre( std::size_t( before.count ), Vec3d::Zero() );
	std::vector<double> mass( std::size_t( before.count ), 0.0 );
	for ( int i = 0; i < naive.count; ++i )
	{
		const int parent = int( lump.levels.lastChange().source[std::size_t( i )] );
		const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> of( f.data() + 9 * std::size_t( parent ) );
		naive.x.set( i, before.x.get( parent ) + of * ( naive.x0.get( i ) - before.x0.get( parent ) ) );
		centre[std::size_t( parent )] += double( naive.mass[i] ) * lump.nodes.x.get( i ).cast<double>();
		mass[std::size_t( parent )] += double( naive.mass[i] );
	}
	for ( int i = 0; i < before.count; ++i )
	{
		EXPECT_LT( ( centre[std::size_t( i )] / mass[std::size_t( i )] - before.x.get( i ).cast<double>() ).norm(), 1e-6 );
	}
	const auto offsetsOf = [&lump]( NodeState& nodes ) {
		std::vector<float> odds( 3 * std::size_t( nodes.count ) );
		lump.matcher.offsetsOf( nodes, lump.all(), odds.data() );
		return std::sqrt( std::inner_product( odds.begin(), odds.end(), odds.begin(), 0.0 ) / nodes.count );
	};
	const double eased = offsetsOf( lump.nodes ), left = offsetsOf( naive );
	std::vector<std::uint32_t> few;
	for ( std::uint32_t i = 0; i < std::uint32_t( naive.count ); i += 150 )
	{
		few.push_back( i );
	}
	std::vector<float> ofAll( 3 * std::size_t( naive.count ) ), ofFew( 3 * few.size() );
	lump.matcher.offsetsOf( naive, lump.all(), ofAll.data() );
	lump.matcher.offsetsOf( naive, few, ofFew.data() );
	for ( std::size_t k = 0; k < 3 * few.size(); ++k )
	{
		EXPECT_NEAR( ofFew[k], ofAll[3 * few[k / 3] + k % 3], 1e-8f ); // rotations have been iterated between the two
	}
	std::printf( "at odds by %.2e m, by %.2e where their parents have them\n", eased, left );
	EXPECT_LT( eased, 0.7 * left );
}

TEST( LevelEnergy, OnlyInternalMotionIsRemoved )
{
	Lump lump;
	std::mt19937 random( 9 );
	const auto number = [&random] { return double( random() ) / 2147483648.0 - 1.0; };
	NodeState& nodes = lump.nodes;
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.set( i, nodes.x0.get( i ) );
		nodes.v.set( i,
			( Vec3d( 1, 2, 3 ) + Vec3d( 3, 1, -2 ).cross( nodes.x.get( i ).cast<double>() ) + Vec3d( number(), number(), number() ) )
				.cast<float>() );
	}
	const auto sums = [&nodes] {
		Eigen::Matrix<double, 7, 1> sum = Eigen::Matrix<double, 7, 1>::Zero();
		for ( int i = 0; i < nodes.count; ++i )
		{
			const double m = double( nodes.mass[i] );
			const Vec3d x = nodes.x.get( i ).cast<double>(), v = nodes.v.get( i ).cast<double>();
			sum.head<3>() += m * v;
			sum.segment<3>( 3 ) += m * x.cross( v );
			sum[6] += 0.5 * m * v.squaredNorm();
		}
		return sum;
	};
	const auto before = sums();
	EXPECT_DOUBLE_EQ( removeInternalMotion( nodes, 2.0 ), 2.0 );
	const auto after = sums();
	EXPECT_LT( ( after - before ).head<3>().norm(), 1e-5 * before.head<3>().norm() );
	EXPECT_LT( ( after - before ).segment<3>( 3 ).norm(), 1e-5 * before.segment<3>( 3 ).norm() );
	EXPECT_NEAR( before[6] - after[6], 2.0, 1e-3 );
	// More than is available: the rest is rigid motion, and nothing more can be removed.
	const double rest = removeInternalMotion( nodes, 1e9 );
	EXPECT_GT( rest, 0.0 );
	EXPECT_LT( removeInternalMotion( nodes, 1e9 ), 1e-6 * rest );
	nodes.freedom[0] = 0.0f;
	nodes.v.set( 0, Vec3( 5, 6, 7 ) );
	removeInternalMotion( nodes, 1e9 );
	EXPECT_EQ( nodes.v.get( 0 ), Vec3( 5, 6, 7 ) );
}

} // namespace
} // namespace pliant
