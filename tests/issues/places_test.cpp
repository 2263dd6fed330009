// Far from the origin and between clamps a body is what it is at home.

#include "world/test_world.h"

#include <cstdio>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

/// How a cube of .5 m lies on the floor, m.
struct Lying
{
	btVector3 extent;
	btScalar volume; ///< a share of what it was
};

Lying lying( const btVector3& centre, Elasticity elasticity, bool onPlane )
{
	TestWorld t;
	onPlane ? t.addPlane( centre.y() ) : t.addBox( 0, btVector3( 4, 1, 4 ), btTransform( btQuaternion::getIdentity(), centre - btVector3( 0, 1, 0 ) ) );
	Material material = test::stiff( 1e5f );
	material.elasticity = elasticity;
	SoftBody* cube = t.addSoft( block( 5, 5, 5, 0.1f ), btTransform( btQuaternion::getIdentity(), centre + btVector3( 0, btScalar( 0.75 ), 0 ) ), material );
	t.run( 300 );
	btVector3 low( 1e9f, 1e9f, 1e9f ), high = -low;
	for ( int i = 0; i < cube->nodeCount(); ++i )
	{
		const btVector3 place = cube->nodePosition( i ) - centre;
		low.setMin( place );
		high.setMax( place );
	}
	const btVector3 extent = high - low + btVector3( btScalar( 0.1 ), btScalar( 0.1 ), btScalar( 0.1 ) );
	return { extent, extent.x() * extent.y() * extent.z() / btScalar( 0.125 ) };
}

// An open world whose places are metres from its centre: 5 km out a cube of half a metre came to rest .41 m across.
TEST( Places, ACubeFiveKilometresOutIsAsLargeAsAtHome )
{
	const btScalar far = btScalar( 5000 ) * ( sizeof( btScalar ) == 4 ? 1 : 100 );
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		for ( const bool onPlane : { false, true } )
		{
			const Lying home = lying( btVector3( 0, 0, 0 ), elasticity, onPlane );
			for ( const btVector3& centre : { btVector3( 100, 26, -100 ), btVector3( far, 0, 0 ), btVector3( far, far, -far ) } )
			{
				const Lying away = lying( centre, elasticity, onPlane );
				std::printf( "%8.0f m out, %s, %s: %.4f %.4f %.4f (home %.4f %.4f %.4f), volume %.3f (%.3f)\n", double( centre.length() ), elasticity == Elasticity::Explicit ? "explicit" : "implicit",
					onPlane ? "plane" : "box", double( away.extent.x() ), double( away.extent.y() ), double( away.extent.z() ), double( home.extent.x() ), double( home.extent.y() ),
					double( home.extent.z() ), double( away.volume ), double( home.volume ) );
				for ( int axis = 0; axis < 3; ++axis )
				{
					EXPECT_NEAR( away.extent[axis], home.extent[axis], 0.005 );
				}
			}
		}
	}
}

} // namespace
} // namespace pliant
