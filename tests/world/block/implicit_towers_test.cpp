// Rigid boxes stacked on one soft body, at one step of 1/60 s: they stand and sleep, with an implicit body and with an automatic one.

#include "world/test_world.h"

#include <cmath>
#include <cstdio>
#include <random>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::kGravity;
using test::TestWorld;

constexpr double kEdge = 0.6; // of the soft cube, m

struct Storey
{
	double mass;         ///< kg
	btVector3 half;      ///< m
	double x = 0, z = 0; ///< offset from the centre, m
};

/// Returns the modulus at which a cube of that edge would tip under the storeys: c q sin q L = cos q L, q^2 = W / E I
/// (docs/design/implicit.md, Leaning).
double tippingModulus( const std::vector<Storey>& storeys )
{
	double weight = 0.0, moment = 0.0, y = 0.0;
	for ( const Storey& storey : storeys )
	{
		const double half = double( storey.half.y() );
		weight += kGravity * storey.mass;
		moment += kGravity * storey.mass * ( y + half );
		y += 2.0 * half;
	}
	const double above = moment / weight, inertia = kEdge * kEdge * kEdge * kEdge / 12.0;
	double low = 0.0, high = 0.5 * SIMD_PI / kEdge;
	for ( int k = 0; k < 60; ++k )
	{
		const double q = 0.5 * ( low + high );
		( above * q * std::sin( q * kEdge ) < std::cos( q * kEdge ) ? low : high ) = q;
	}
	return weight / ( inertia * low * low );
}

/// Expects the tower to stand six seconds after it was put down.
void expectStands( const std::vector<Storey>& storeys, double density, double youngsModulus, Elasticity elasticity, const char* what )
{
	TestWorld t;
	t.addFloor();
	Material material = test::stiff( float( youngsModulus ) );
	material.density = float( density );
	material.elasticity = elasticity;
	SoftBody* cube = t.addSoft( block( 6, 6, 6, float( kEdge / 6 ) ), at( 0, btScalar( kEdge / 2 ), 0 ), material );
	std::vector<btRigidBody*> boxes;
	double y = kEdge;
	for ( const Storey& storey : storeys )
	{
		const double half = double( storey.half.y() );
		y += 0.001 + half;
		boxes.push_back(
			t.addBox( btScalar( storey.mass ), storey.half, at( btScalar( storey.x ), btScalar( y ), btScalar( storey.z ) ) ) );
		y += half;
	}
	int frames = 0;
	for ( ; frames < 360 && cube->getActivationState() != ISLAND_SLEEPING; ++frames )
	{
		t.run( 1 );
		EXPECT_LE( t.world.stepReport().substeps, 1 ) << what;
	}
	double lean = 0.0;
	for ( std::size_t k = 0; k < boxes.size(); ++k )
	{
		const btTransform& transform = boxes[k]->getWorldTransform();
		lean = std::max( lean, double( btAcos( btMin( btScalar( 1 ), transform.getBasis()[1].y() ) ) ) * 180.0 / SIMD_PI );
		EXPECT_EQ( boxes[k]->getActivationState(), ISLAND_SLEEPING ) << what << ", box " << k;
		if ( k > 0 )
		{
			// Relative to the storey below only the height differs: neither sunk in nor moved sideways.
			const btVector3 up = boxes[k - 1]->getWorldTransform().invXform( transform.getOrigin() );
			EXPECT_NEAR( up.y(), storeys[k].half.y() + storeys[k - 1].half.y(), 2e-3 ) << what << ", box " << k;
			EXPECT_NEAR( up.x(), storeys[k].x - storeys[k - 1].x, 5e-3 ) << what << ", box " << k;
			EXPECT_NEAR( up.z(), storeys[k].z - storeys[k - 1].z, 5e-3 ) << what << ", box " << k;
		}
	}
	EXPECT_EQ( cube->getActivationState(), ISLAND_SLEEPING ) << what;
	EXPECT_LT( lean, 2.0 ) << what;
	std::printf( "%s: asleep after %d frames, leaning by %.2f degrees\n", what, frames, lean );
}

const char* nameOf( Elasticity elasticity )
{
	return elasticity == Elasticity::Implicit ? "implicit" : "automatic";
}

TEST( ImplicitTowers, OfThreeAndFiveLikeBoxesStand )
{
	for ( const Elasticity elasticity : { Elasticity::Implicit, Elasticity::Automatic } )
	{
		for ( const auto& [count, mass] : { std::pair( 3, 10.0 ), std::pair( 5, 10.0 ), std::pair( 3, 100.0 ) } )
		{
			const std::vector<Storey> storeys(
				std::size_t( count ), Storey{ mass, btVector3( btScalar( 0.3 ), btScalar( 0.15 ), btScalar( 0.3 ) ) } );
			char what[64];
			std::snprintf( what, sizeof( what ), "%s, %d of %.0f kg", nameOf( elasticity ), count, mass );
			expectStands( storeys, 1000.0 / 216.0, 8.0 * tippingModulus( storeys ), elasticity, what ); // on a cube of 1 kg
		}
	}
}

TEST( ImplicitTowers, OfAnyTwoToFiveBoxesStand )
{
	std::mt19937 random( 20 );
	const auto fraction = [&random] { return double( random() ) / 4294967296.0; };
	for ( int tower = 0; tower < 20; ++tower )
	{
		std::vector<Storey> storeys( std::size_t( 2 + tower % 4 ) );
		for ( Storey& storey : storeys )
		{
			storey.mass = 200.0 + 700.0 * fraction();
			storey.half = btVector3(
				btScalar( 0.2 + 0.1 * fraction() ), btScalar( 0.05 + 0.1 * fraction() ), btScalar( 0.2 + 0.1 * fraction() ) );
			storey.x = 0.06 * ( fraction() - 0.5 );
			storey.z = 0.06 * ( fraction() - 0.5 );
		}
		char what[64];
		const Elasticity elasticity = tower % 2 == 0 ? Elasticity::Implicit : Elasticity::Automatic;
		std::snprintf( what, sizeof( what ), "%s, tower %d of %d boxes", nameOf( elasticity ), tower, int( storeys.size() ) );
		expectStands( storeys, 1000.0, 8.0 * tippingModulus( storeys ), elasticity, what ); // on a cube of 216 kg
	}
}

} // namespace
} // namespace pliant
