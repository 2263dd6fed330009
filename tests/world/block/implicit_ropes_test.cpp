// Implicit rods and ropes of cells in one line, from soft to nearly rigid, with a step of 1/60 s. Hung by an end they swing; thrown and
// spun they land. No node is ever faster than the motion explains.

#include "world/test_world.h"

#include <cmath>
#include <cstdio>

namespace pliant {
namespace {

using test::TestWorld;

constexpr float kCell = 0.05f; // m

struct Rope
{
	int cells;
	float youngsModulus;
	int halfWidth;
	bool isThrown; ///< otherwise it hangs by its first cell
};

struct Course
{
	double fastest = 0.0, last = 0.0; ///< of all nodes in five seconds, m/s
	bool isHealthy = true;
};

Course follow( const Rope& rope )
{
	TestWorld t;
	t.addFloor();
	const double length = double( kCell ) * rope.cells;
	const btTransform where( btQuaternion( btVector3( btScalar( 0.3 ), btScalar( 0.2 ), 1 ).normalized(), btScalar( 0.5 ) ),
		btVector3( 0, btScalar( rope.isThrown ? 0.5 * length + 0.5 : length + 2 ), 0 ) );
	SoftBody* body = t.addSoft( test::block( rope.cells, 1, 1, kCell ), where, test::implicit( rope.youngsModulus, rope.halfWidth ) );
	if ( rope.isThrown )
	{
		EXPECT_TRUE( body->setVelocities( btVector3( 1, -20, 0 ), btVector3( 3, 20, 1 ) ).ok() );
	}
	else
	{
		EXPECT_TRUE( body->pinNode( 0 ).ok() );
	}
	Course course;
	for ( int frame = 0; frame < 300; ++frame )
	{
		t.run( 1 );
		course.last = 0.0;
		for ( int i = 0; i < body->nodeCount(); ++i )
		{
			course.last = std::max( course.last, double( body->nodeVelocity( i ).length() ) );
		}
		course.fastest = std::isfinite( course.last ) ? std::max( course.fastest, course.last ) : INFINITY;
	}
	course.isHealthy = body->isHealthy();
	return course;
}

// If rounding decided the inertias of thin regions, eight of these would fly apart.
TEST( ImplicitRopes, NeitherHangingNorThrownFlyApart )
{
	for ( const int cells : { 5, 20, 100 } )
	{
		for ( const float youngsModulus : { 1e4f, 1e6f, 1e8f } )
		{
			for ( const bool isThrown : { false, true } )
			{
				const Rope rope{ cells, youngsModulus, cells == 20 ? 2 : 1, isThrown };
				const double length = double( kCell ) * cells;
				// A hanging rope falls by at most twice its length, with a whip-like free end; a thrown one may concentrate its rotation in
				// one end and bounce upwards.
				const double limit = isThrown ? 20.0 + 21.0 * length + 10.0 : 2.0 * std::sqrt( 2.0 * test::kGravity * 2.0 * length ) + 1.0;
				const Course course = follow( rope );
				std::printf( "%3d cells, E %.0e, w %d, %s: at most %.1f m/s, %.2f after 5 s\n", cells, double( youngsModulus ),
					rope.halfWidth, isThrown ? "thrown" : "hung up", course.fastest, course.last );
				EXPECT_LT( course.fastest, limit ) << cells << " cells, E " << youngsModulus;
				EXPECT_TRUE( course.isHealthy ) << cells << " cells, E " << youngsModulus;
			}
		}
	}
}

} // namespace
} // namespace pliant
