// The drawn surface as what touches a body meets it (LatticeSettings::contactSurface), beside the cells' own balls.

#include "test_world.h"

#include <cmath>
#include <cstdio>

namespace pliant {
namespace {

using test::at;
using test::TestWorld;

struct Corners
{
	std::vector<float> positions;
	std::vector<std::uint32_t> indices;

	std::shared_ptr<const BodyTemplate> build( float cell, bool isDrawn ) const
	{
		MeshView mesh;
		mesh.positions = positions.data();
		mesh.vertexCount = positions.size() / 3;
		mesh.indices = indices.data();
		mesh.triangleCount = indices.size() / 3;
		LatticeSettings settings;
		settings.cellSize = cell;
		settings.contactSurface = isDrawn;
		return BodyTemplate::build( mesh, settings ).value;
	}
};

Corners slab()
{
	Corners box;
	for ( int i = 0; i < 8; ++i )
	{
		box.positions.insert( box.positions.end(), { float( i & 1 ) - 0.5f, 0.5f * ( float( i >> 1 & 1 ) - 0.5f ), float( i >> 2 & 1 ) - 0.5f } );
	}
	box.indices = { 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
	return box;
}

Corners ball( double radius, int rings )
{
	Corners made;
	const int around = 2 * rings;
	for ( int i = 0; i <= rings; ++i )
	{
		for ( int k = 0; k < around; ++k )
		{
			const double down = SIMD_PI * i / rings, turn = SIMD_2_PI * k / around;
			for ( const double x : { std::sin( down ) * std::cos( turn ), std::cos( down ), std::sin( down ) * std::sin( turn ) } )
			{
				made.positions.push_back( float( radius * x ) );
			}
		}
	}
	for ( int i = 0; i < rings; ++i )
	{
		for ( int k = 0; k < around; ++k )
		{
			const auto corner = [&]( int ring, int step ) { return std::uint32_t( ring * around + ( k + step ) % around ); };
			made.indices.insert( made.indices.end(), { corner( i, 0 ), corner( i, 1 ), corner( i + 1, 0 ), corner( i, 1 ), corner( i + 1, 1 ), corner( i + 1, 0 ) } );
		}
	}
	return made;
}

Material implicit( float youngsModulus, float numericalDamping )
{
	Material material = test::stiff( youngsModulus );
	material.elasticity = Elasticity::Implicit;
	material.numericalDamping = numericalDamping;
	return material;
}

/// How many of nine marbles of 2 cm lie on the top face, cells of 10 cm, two seconds after they were let fall from 1 cm above it.
int marblesOnTop( bool isDrawn )
{
	TestWorld t;
	t.addPlane();
	SoftBody* const soft = t.addSoft( slab().build( 0.1f, isDrawn ), at( 0, btScalar( 0.25 ), 0 ), implicit( 5e5f, 1.0f ) );
	std::vector<btRigidBody*> marbles;
	for ( int k = 0; k < 9; ++k )
	{
		const btScalar x = btScalar( 0.1 ) * btScalar( k % 3 - 1 ) + btScalar( 0.013 ) * k, z = btScalar( 0.1 ) * btScalar( k / 3 - 1 ) + btScalar( 0.017 ) * k;
		marbles.push_back( t.add( btScalar( 0.05 ), new btSphereShape( btScalar( 0.02 ) ), at( x - btScalar( 0.1 ), btScalar( 0.53 ), z - btScalar( 0.1 ) ) ) );
	}
	t.run( 120 );
	int count = 0;
	for ( const btRigidBody* const marble : marbles )
	{
		const btScalar bottom = marble->getWorldTransform().getOrigin().y() - btScalar( 0.02 );
		count += std::abs( bottom - 0.5 ) < 0.01 ? 1 : 0; // a tenth of a cell
	}
	EXPECT_TRUE( soft->isHealthy() );
	return count;
}

// Smaller than the gap between four balls they fell through the whole body.
TEST( ContactSurface, CarriesMarblesSmallerThanTheGapsBetweenNodes )
{
	EXPECT_EQ( marblesOnTop( true ), 9 );
	EXPECT_EQ( marblesOnTop( false ), 0 );
}

/// Speed after four seconds of a ball that starts to slide at 2 m/s, friction 0.8; a rigid one's is 10 / 7.
double rolled( bool isDrawn )
{
	TestWorld t;
	t.addPlane()->setFriction( btScalar( 0.8 ) );
	SoftBody* const soft = t.addSoft( ball( 0.4, 40 ).build( 0.06f, isDrawn ), at( 0, btScalar( 0.4 ), 0 ), implicit( 1e6f, 0.0f ) );
	soft->setFriction( btScalar( 0.8 ) );
	soft->setActivationState( DISABLE_DEACTIVATION );
	soft->setVelocities( btVector3( 2, 0, 0 ), btVector3( 0, 0, 0 ) );
	t.run( 240 );
	return double( soft->linearVelocity().x() );
}

// On balls of half a cell it rolls over bumps, about a radius that ends at the nodes: of 1.43 m/s .89 were left.
TEST( ContactSurface, RollsFurtherThanBallsOfACell )
{
	const double drawn = rolled( true ), balls = rolled( false );
	std::printf( "rolls on at %.3f m/s, on its nodes' balls at %.3f\n", drawn, balls );
	EXPECT_GT( drawn, 0.88 * 10.0 / 7.0 );
	EXPECT_LT( balls, 0.75 * 10.0 / 7.0 );
}

} // namespace
} // namespace pliant
