// A skin that is rotated instead of recomputed agrees with the recomputed one, however slowly its body bends.

#include "surface/skin/rigid_skin.h"
#include "surface/skin_case.h"

#include "pliant/task_runner.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pliant {
namespace {

using test::SkinCase;
using Change = RigidSkin::Change;

constexpr double kCell = 0.2;
constexpr double kTolerance = 0.01 * kCell; // m

/// A skin as a body draws it: computed in full where necessary, otherwise rotated.
struct Shown
{
	SkinCase it{ test::makeGlob( 1.0, 24 ), kCell };
	RigidSkin rigid;
	std::vector<float> positions, normals, fullPositions, fullNormals;
	int bent = 0, still = 0, moved = 0;

	void show()
	{
		const Change change = rigid.classify( it.nodes, it.rotations.data(), nullptr, kTolerance, kCell );
		it.skinIt();
		if ( change == Change::Bent )
		{
			++bent;
			rigid.keep( it.nodes, it.rotations.data(), nullptr, false );
			positions = fullPositions = it.positions;
			normals = fullNormals = it.normals;
			return;
		}
		++( change == Change::Still ? still : moved );
		if ( change == Change::Moved )
		{
			rigid.turn( fullPositions, fullNormals, positions, normals );
		}
	}
	/// Distance from the skin computed in full, m.
	double offBy() const
	{
		double most = 0.0;
		for ( std::size_t v = 0; v < positions.size() / 3; ++v )
		{
			most = std::max( most, double( ( Eigen::Map<const Vec3>( positions.data() + 3 * v ) - it.position( int( v ) ) ).norm() ) );
		}
		return most;
	}
	double normalsOffBy() const
	{
		double most = 0.0;
		for ( std::size_t v = 0; v < normals.size() / 3; ++v )
		{
			most = std::max( most, double( ( Eigen::Map<const Vec3>( normals.data() + 3 * v ) - it.normal( int( v ) ) ).norm() ) );
		}
		return most;
	}
};

Eigen::Matrix3f turned( float angle )
{
	return Eigen::AngleAxisf( angle, Vec3( 1, -2, 0.5f ).normalized() ).toRotationMatrix();
}

TEST( RigidSkin, IsTurnedToWhereSkinningInFullPutsIt )
{
	Shown skin;
	skin.it.affine( turned( 0.4f ) * Eigen::Vector3f( 1.1f, 0.95f, 1.0f ).asDiagonal().toDenseMatrix() );
	for ( int i = 0; i < skin.it.nodes.count; ++i )
	{
		Eigen::Map<Eigen::Vector4f>( skin.it.rotations.data() + 4 * i ) = Eigen::Quaternionf( turned( 0.4f ) ).coeffs();
	}
	const std::vector<float> rotations = skin.it.rotations;
	const Vec3Array positions = skin.it.nodes.x;
	skin.show();
	for ( int k = 1; k < 40; ++k )
	{
		const Eigen::Quaternionf q( turned( 0.15f * float( k ) ) );
		for ( int i = 0; i < skin.it.nodes.count; ++i )
		{
			skin.it.nodes.x.set( i, q * positions.get( i ) + Vec3( 0.1f, 0.02f, -0.03f ) * float( k ) );
			Eigen::Map<Eigen::Vector4f>(
				skin.it.rotations.data() + 4 * i ) = ( q * Eigen::Quaternionf( rotations.data() + 4 * i ) ).coeffs();
		}
		skin.show();
		EXPECT_LT( skin.offBy(), 4e-6 ) << k;
		EXPECT_LT( skin.normalsOffBy(), 5e-3 ) << k; // the effect of rounding on recomputed normals of slivers
	}
	EXPECT_EQ( skin.bent, 1 );
	EXPECT_EQ( skin.moved, 39 );
}

TEST( RigidSkin, IsTheSameOnAnyNumberOfThreadsAndToTheLastVertex )
{
	Shown skin;
	skin.show();
	skin.it.affine( turned( 0.7f ), Vec3( 0.3f, 0.1f, -0.2f ) );
	ASSERT_EQ( skin.rigid.classify( skin.it.nodes, skin.it.rotations.data(), nullptr, kTolerance, kCell ), Change::Moved );
	const auto pool = createThreadPool( 4 );
	for ( std::size_t vertices : { 1u, 2u, 3u, 4u, 5u, 8191u, 20003u } )
	{
		std::vector<float> from( 3 * vertices ), directions( 3 * vertices ), place, direction, placeOfMany, directionOfMany;
		for ( std::size_t k = 0; k < from.size(); ++k )
		{
			from[k] = std::sin( float( k ) );
			directions[k] = std::cos( float( k ) );
		}
		skin.rigid.turn( from, directions, place, direction );
		skin.rigid.turn( from, directions, placeOfMany, directionOfMany, pool.get() );
		EXPECT_EQ( place, placeOfMany );
		EXPECT_EQ( direction, directionOfMany );
		const Vec3 last = turned( 0.7f ) * Eigen::Map<const Vec3>( from.data() + 3 * ( vertices - 1 ) ) + Vec3( 0.3f, 0.1f, -0.2f );
		EXPECT_LT( ( last - Eigen::Map<const Vec3>( place.data() + 3 * ( vertices - 1 ) ) ).norm(), 2e-6f ) << vertices;
	}
}

TEST( RigidSkin, OfManySmallMovesStaysNearWhatItWouldBe )
{
	Shown skin;
	for ( int frame = 0; frame < 400; ++frame )
	{
		// A bend and a sway, both far below the tolerance in each frame.
		const float bend = 2e-4f * float( frame ), sway = 1e-5f * float( frame );
		skin.it.deform( [&]( const Vec3& x ) { return Vec3( x.x() + sway, x.y() + 0.5f * bend * x.x() * x.x(), x.z() ); },
			[&]( const Vec3& x ) { return Eigen::Matrix3f( Eigen::AngleAxisf( bend * x.x(), Vec3::UnitZ() ) ); } );
		skin.show();
		EXPECT_LE( skin.offBy(), kTolerance ) << frame;
	}
	EXPECT_GT( skin.bent, 4 );
	EXPECT_LT( skin.bent, 100 );
	EXPECT_GT( skin.still, 200 );
}

TEST( RigidSkin, WithoutToleranceIsMadeInFull )
{
	Shown skin;
	skin.show();
	EXPECT_EQ( skin.rigid.classify( skin.it.nodes, skin.it.rotations.data(), nullptr, kTolerance, kCell ), Change::Still );
	EXPECT_EQ( skin.rigid.classify( skin.it.nodes, skin.it.rotations.data(), nullptr, 0.0, kCell ), Change::Bent );
	skin.rigid.forget();
	EXPECT_EQ( skin.rigid.classify( skin.it.nodes, skin.it.rotations.data(), nullptr, kTolerance, kCell ), Change::Bent );
}

// A number that is not finite is no rigid motion.
TEST( RigidSkin, OfABrokenNumberIsMadeInFull )
{
	Shown skin;
	skin.show();
	skin.it.nodes.x.set( 3, Vec3::Constant( std::nanf( "" ) ) );
	EXPECT_EQ( skin.rigid.classify( skin.it.nodes, skin.it.rotations.data(), nullptr, kTolerance, kCell ), Change::Bent );
}

// A rod that rotates about itself leaves its nodes at their positions.
TEST( RigidSkin, OfARodFollowsHowItsNodesAreTurned )
{
	for ( const bool hasGradients : { false, true } )
	{
		Shown skin;
		for ( int i = 0; i < skin.it.nodes.count; ++i )
		{
			skin.it.nodes.x.set( i, Vec3( 0.1f * float( i ), 0, 0 ) );
		}
		skin.rigid.keep( skin.it.nodes, skin.it.rotations.data(), nullptr, hasGradients );
		skin.it.turnNodes( []( const Vec3& ) { return Eigen::Matrix3f( Eigen::AngleAxisf( 0.3f, Vec3::UnitX() ) ); } );
		ASSERT_EQ( skin.rigid.classify( skin.it.nodes, skin.it.rotations.data(), nullptr, kTolerance, kCell ), Change::Moved );
		std::vector<float> to, normal;
		skin.rigid.turn( { 0.0f, 1.0f, 0.0f }, { 0.0f, 0.0f, 1.0f }, to, normal );
		EXPECT_NEAR( to[2], std::sin( 0.3f ), 1e-6f );
		EXPECT_NEAR( normal[1], -std::sin( 0.3f ), 1e-6f );
	}
}

// Rotation of a single node counts as bending, because rotations carry the skin.
TEST( RigidSkin, OfANodeThatTurnsIsMadeInFull )
{
	Shown skin;
	skin.show();
	Eigen::Map<Eigen::Vector4f>( skin.it.rotations.data() + 4 * 5 ) = Eigen::Quaternionf( turned( 0.01f ) ).coeffs();
	EXPECT_EQ( skin.rigid.classify( skin.it.nodes, skin.it.rotations.data(), nullptr, kTolerance, kCell ), Change::Bent );
	skin.rigid.keep( skin.it.nodes, skin.it.rotations.data(), nullptr, true );
	Eigen::Map<Eigen::Vector4f>( skin.it.rotations.data() + 4 * 5 ) = Eigen::Quaternionf( turned( 0.02f ) ).coeffs();
	EXPECT_EQ( skin.rigid.classify( skin.it.nodes, skin.it.rotations.data(), nullptr, kTolerance, kCell ), Change::Still )
		<< "places say what gradients are";
}

} // namespace
} // namespace pliant
