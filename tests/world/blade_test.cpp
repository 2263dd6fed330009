// Cuts are drawn where the blade went, not along the cells it went through. Steinemann et al. 2008, section 7.

#include "test_world.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::stiff;
using test::TestWorld;

constexpr float kCell = 0.1f;

struct Drawn
{
	double area = 0.0;   ///< of the cut, m^2
	double volume = 0.0;
	double open = 0.0;   ///< length of the sum of all triangles' areas
	double farthest = 0.0; ///< of the cut's triangles from where it should be, m
};

/// `away`: of a place in the world from the blade's surface, m.
Drawn measure( const SoftBody& body, const std::function<double( const btVector3& )>& away )
{
	const SurfaceView view = body.surface();
	Drawn drawn;
	btVector3 sum( 0, 0, 0 );
	for ( int t = 0; t < view.triangleCount; ++t )
	{
		btVector3 corner[3];
		for ( int k = 0; k < 3; ++k )
		{
			const float* p = view.positions + 3 * std::size_t( view.indices[3 * t + k] );
			corner[k] = btVector3( p[0], p[1], p[2] );
		}
		const btVector3 area = ( corner[1] - corner[0] ).cross( corner[2] - corner[0] ) / 2;
		sum += area;
		drawn.volume += double( corner[0].dot( area ) ) / 3.0;
		if ( view.triangleSource && view.triangleSource[t] == SurfaceView::kInside )
		{
			drawn.area += double( area.length() );
			for ( const btVector3& p : corner )
			{
				drawn.farthest = std::max( drawn.farthest, std::abs( away( view.origin + p ) ) );
			}
		}
	}
	drawn.open = double( sum.length() );
	return drawn;
}

// The stairs that a slanted cut takes through the cells are half as much again as the cut itself.
TEST( Blade, ASlantedPlaneIsDrawnAsOnePlane )
{
	const btVector3 normal = btVector3( 1, btScalar( 0.5 ), btScalar( 0.3 ) ).normalized(), middle( btScalar( 0.013 ), 1, 0 );
	const auto away = [&]( const btVector3& p ) { return double( normal.dot( p - middle ) ); };
	for ( const bool looks : { false, true } )
	{
		TestWorld test;
		test.world.setGravity( btVector3( 0, 0, 0 ) );
		SoftBody* soft = test.addSoft( block( 10, 4, 4, kCell ), at( 0, 1, 0 ), stiff( 1e5f ) );
		looks ? void( soft->surface() ) : void();
		ASSERT_GT( soft->cutPlane( middle, normal ), 0 );
		test.run( 1 );
		ASSERT_EQ( test.world.softBodyCount(), 2 );
		const double section = 0.16 / double( normal.x() ), halves[2] = { 0.16 * 0.513, 0.16 * 0.487 };
		double volume = 0.0, areas[2] = {};
		for ( int i = 0; i < 2; ++i )
		{
			const Drawn drawn = measure( *test.world.softBody( i ), away );
			std::printf( "cut %.5f m^2 (%.5f), volume %.5f m^3, %.4f cells from the plane\n", drawn.area, section, drawn.volume, drawn.farthest / kCell );
			EXPECT_LT( drawn.farthest, 1e-3 * kCell );
			EXPECT_NEAR( drawn.area, section, 1e-3 * section ); // the stairs: 1.55 of it
			EXPECT_LT( drawn.open, 1e-5 * section );
			EXPECT_NEAR( drawn.volume, drawn.volume > 0.08 ? halves[0] : halves[1], 1e-3 * 0.08 );
			volume += drawn.volume;
			areas[i] = drawn.area;
		}
		EXPECT_NEAR( volume, 0.16, 1e-4 * 0.16 );
		EXPECT_NEAR( areas[0], areas[1], 1e-5 * section );
	}
}

TEST( Blade, ASphereIsDrawnRound )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* soft = test.addSoft( block( 10, 10, 10, kCell ), at( 0, 1, 0 ), stiff( 1e5f ) );
	const btVector3 centre( btScalar( 0.03 ), btScalar( 1.02 ), btScalar( -0.01 ) );
	const double radius = 0.33;
	ASSERT_GT( soft->cutSphere( centre, btScalar( radius ) ), 0 );
	test.run( 1 );
	ASSERT_EQ( test.world.softBodyCount(), 2 );
	for ( int i = 0; i < 2; ++i )
	{
		const Drawn drawn = measure( *test.world.softBody( i ), [&]( const btVector3& p ) { return double( ( p - centre ).length() ) - radius; } );
		const double whole = 4.0 * SIMD_PI * radius * radius;
		std::printf( "cut %.4f m^2 (%.4f), %.3f cells from the sphere\n", drawn.area, whole, drawn.farthest / kCell );
		EXPECT_LT( drawn.farthest, 0.15 * kCell );
		EXPECT_NEAR( drawn.area, whole, 0.05 * whole );
	}
}

// What is cut while it is bent has its cut where the blade was then.
TEST( Blade, ASaggingBodyIsCutWhereTheBladeIs )
{
	TestWorld test;
	test.addFloor();
	SoftBody* soft = test.addSoft( block( 6, 10, 6, kCell ), at( 0, btScalar( 0.55 ), 0 ), stiff( 6e4f ) );
	test.run( 240 );
	const btVector3 normal = btVector3( btScalar( 0.4 ), 1, btScalar( 0.2 ) ).normalized(), middle = soft->massCentre();
	ASSERT_GT( soft->cutPlane( middle, normal ), 0 );
	test.run( 1 );
	ASSERT_EQ( test.world.softBodyCount(), 2 );
	for ( int i = 0; i < 2; ++i )
	{
		const Drawn drawn = measure( *test.world.softBody( i ), [&]( const btVector3& p ) { return double( normal.dot( p - middle ) ); } );
		std::printf( "%.3f cells from the plane\n", drawn.farthest / kCell );
		EXPECT_LT( drawn.farthest, 0.15 * kCell );
	}
}

// A blade's way in several strokes, two cuts across each other: whoever looks at every frame sees what one sees who looks at the end.
TEST( Blade, IsDrawnTheSameHoweverOftenItIsLookedAt )
{
	std::vector<std::vector<std::array<float, 10>>> drawn[2];
	for ( const bool looks : { false, true } )
	{
		TestWorld test;
		test.world.setGravity( btVector3( 0, 0, 0 ) );
		SoftBody* soft = test.addSoft( block( 8, 6, 6, kCell ), at( 0, 1, 0 ), stiff( 1e5f ) );
		for ( int frame = 0; frame < 24; ++frame )
		{
			for ( int i = 0; i < test.world.softBodyCount(); ++i )
			{
				looks ? void( test.world.softBody( i )->surface() ) : void();
				const btScalar y0 = btScalar( 1.4 - 0.04 * frame ), y1 = y0 - btScalar( 0.06 ), lean = btScalar( 0.3 );
				test.world.softBody( i )->cutSweep( btVector3( lean * ( y0 - 1 ), y0, -1 ), btVector3( lean * ( y0 - 1 ), y0, 1 ),
					btVector3( lean * ( y1 - 1 ), y1, -1 ), btVector3( lean * ( y1 - 1 ), y1, 1 ) );
			}
			if ( frame == 12 )
			{
				soft->cutPlane( btVector3( 0, 1, 0 ), btVector3( btScalar( 0.2 ), 0, 1 ) );
			}
			test.run( 1 );
		}
		ASSERT_GE( test.world.softBodyCount(), 4 );
		for ( int i = 0; i < test.world.softBodyCount(); ++i )
		{
			drawn[looks ? 1 : 0].push_back( test::trianglesOf( test.world.softBody( i )->surface() ) );
		}
	}
	EXPECT_EQ( drawn[0], drawn[1] );
}

} // namespace
} // namespace pliant
