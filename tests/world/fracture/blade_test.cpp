// Cuts are drawn along the blade's surface, not along the faces of the cut cells. Steinemann et al. 2008, section 7.

#include "test_meshes.h"
#include "world/test_world.h"

#include <pliant/render/vertex_attributes.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <set>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::stiff;
using test::TestWorld;

constexpr float kCell = 0.1f;

struct Drawn
{
	double area = 0.0; ///< of the cut, m^2
	double volume = 0.0;
	double open = 0.0;     ///< length of the sum of all triangles' area vectors
	double farthest = 0.0; ///< largest distance of the cut's triangles from the blade's surface, m
};

/// `away`: distance of a world position from the blade's surface, m.
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

// The stair-stepped faces of the cells along a slanted cut have one and a half times the area of the cut.
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
			std::printf( "cut %.5f m^2 (%.5f), volume %.5f m^3, %.4f cells from the plane\n", drawn.area, section, drawn.volume,
				drawn.farthest / kCell );
			EXPECT_LT( drawn.farthest, 1e-3 * kCell );
			EXPECT_NEAR( drawn.area, section, 1e-3 * section ); // the stairs would be 1.55 of it
			EXPECT_LT( drawn.open, 1e-5 * section );
			EXPECT_NEAR( drawn.volume, drawn.volume > 0.08 ? halves[0] : halves[1], 1e-3 * 0.08 );
			volume += drawn.volume;
			areas[i] = drawn.area;
		}
		EXPECT_NEAR( volume, 0.16, 1e-4 * 0.16 );
		EXPECT_NEAR( areas[0], areas[1], 1e-5 * section );
	}
}

/// A block of 8 x 4 x 4 cells about the origin, with three vertices per cell along its edges.
std::shared_ptr<const BodyTemplate> fineBlock()
{
	constexpr int kCells[3] = { 8, 4, 4 }, kFine = 3;
	std::vector<float> positions;
	std::vector<std::uint32_t> indices;
	for ( int side = 0; side < 6; ++side )
	{
		const int axis = side / 2, u = ( axis + 1 ) % 3, v = ( axis + 2 ) % 3, nu = kFine * kCells[u], nv = kFine * kCells[v];
		const std::uint32_t first = std::uint32_t( positions.size() / 3 );
		for ( int k = 0; k < ( nu + 1 ) * ( nv + 1 ); ++k )
		{
			float at[3];
			at[axis] = ( side % 2 == 0 ? -0.5f : 0.5f ) * kCell * float( kCells[axis] );
			at[u] = kCell * ( float( k % ( nu + 1 ) ) / kFine - 0.5f * float( kCells[u] ) );
			at[v] = kCell * ( float( k / ( nu + 1 ) ) / kFine - 0.5f * float( kCells[v] ) );
			positions.insert( positions.end(), at, at + 3 );
		}
		for ( int k = 0; k < nu * nv; ++k )
		{
			const std::uint32_t a = first + std::uint32_t( k / nu * ( nu + 1 ) + k % nu ), b = a + 1, c = a + std::uint32_t( nu ) + 1,
								d = c + 1;
			const std::uint32_t out[6] = { a, b, d, a, d, c }, in[6] = { a, d, b, a, c, d };
			indices.insert( indices.end(), side % 2 != 0 ? out : in, ( side % 2 != 0 ? out : in ) + 6 );
		}
	}
	LatticeSettings settings;
	settings.cellSize = kCell;
	return BodyTemplate::build( MeshView{ positions.data(), positions.size() / 3, 3, indices.data(), indices.size() / 3 }, settings ).value;
}

// Where triangles are smaller than cells, vertices beyond the blade are moved back to it, so that neither half protrudes from its cut.
TEST( Blade, NothingProtrudesFromACutHoweverFineTheMesh )
{
	const btVector3 normal = btVector3( 1, btScalar( 0.5 ), btScalar( 0.3 ) ).normalized(), middle( btScalar( 0.013 ), 1, 0 );
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* soft = test.addSoft( fineBlock(), at( 0, 1, 0 ), stiff( 1e5f ) );
	ASSERT_GT( soft->cutPlane( middle, normal ), 0 );
	test.run( 1 );
	ASSERT_EQ( test.world.softBodyCount(), 2 );
	for ( int i = 0; i < 2; ++i )
	{
		const SoftBody& half = *test.world.softBody( i );
		const SurfaceView view = half.surface();
		const btScalar side = normal.dot( half.massCentre() - middle ) < 0 ? btScalar( -1 ) : btScalar( 1 );
		btScalar out = 0;
		for ( int k = 0; k < 3 * view.triangleCount; ++k )
		{
			const float* p = view.positions + 3 * std::size_t( view.indices[k] );
			out = btMin( out, side * normal.dot( view.origin + btVector3( p[0], p[1], p[2] ) - middle ) );
		}
		std::printf( "%.4f cells beyond the plane\n", double( -out ) / kCell );
		EXPECT_GT( out, btScalar( -0.01 ) * kCell );
	}
}

// A healed slit is not drawn: the vertices that were beyond the blade are back at their positions.
TEST( Blade, AHealedSlitIsDrawnIntact )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* soft = test.addSoft( fineBlock(), at( 0, 1, 0 ), stiff( 1e5f ) );
	const SurfaceView whole = soft->surface();
	const std::vector<float> before( whole.positions, whole.positions + 3 * whole.vertexCount );
	ASSERT_GT( soft->cutPlane(
				   btVector3( btScalar( 0.013 ), btScalar( 1.2 ), 0 ), btVector3( 1, btScalar( 0.5 ), btScalar( 0.3 ) ), btScalar( 0.25 ) ),
		0 );
	test.run( 1 );
	soft->surface();
	ASSERT_GT( soft->heal(), 0 );
	test.run( 1 );
	const SurfaceView healed = soft->surface();
	const VertexSourceView from = vertexSources( *soft ); // in another order
	ASSERT_EQ( from.vertexCount, healed.vertexCount );
	std::set<std::uint32_t> drawn;
	for ( std::size_t v = 0; v < std::size_t( healed.vertexCount ); ++v )
	{
		const VertexSource& source = from.sources[v];
		ASSERT_NE( source.vertex[0], VertexSource::kInside );
		for ( std::size_t k = 0; k < 3; ++k )
		{
			float place = 0.0f;
			for ( std::size_t i = 0; i < 3; ++i )
			{
				place += source.weight[i] * before[3 * std::size_t( source.vertex[i] ) + k];
			}
			ASSERT_NEAR( healed.positions[3 * v + k], place, 0.02f * kCell ) << v; // it has swung a little
		}
		source.weight[0] == 1.0f ? void( drawn.insert( source.vertex[0] ) ) : void();
	}
	EXPECT_EQ( 3 * drawn.size(), before.size() );
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
		const Drawn drawn = measure(
			*test.world.softBody( i ), [&]( const btVector3& p ) { return double( ( p - centre ).length() ) - radius; } );
		const double whole = 4.0 * SIMD_PI * radius * radius;
		std::printf( "cut %.4f m^2 (%.4f), %.3f cells from the sphere\n", drawn.area, whole, drawn.farthest / kCell );
		EXPECT_LT( drawn.farthest, 0.15 * kCell );
		EXPECT_NEAR( drawn.area, whole, 0.05 * whole );
	}
}

// A body that is cut while bent has its cut at the blade's position in the bent state.
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

// Several strokes, two cuts across each other: drawing every frame gives the same result as drawing only the last one.
TEST( Blade, DoesNotDependOnHowOftenTheBodyIsDrawn )
{
	std::vector<std::vector<std::array<float, 10>>> drawn[2];
	for ( const bool looks : { false, true } )
	{
		TestWorld test;
		test.world.setGravity( btVector3( 0, 0, 0 ) );
		SoftBody* soft = test.addSoft( block( 8, 6, 6, kCell ), at( 0, 1, 0 ), stiff( 1e5f ) );
		soft->setSurfaceTolerance( 0 ); // bit-identical
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

// A brush with sixteen bristles a cell has points with 119 cells around them. Its halves were drawn by the skin of the whole, whose nodes
// they do not have.
TEST( Blade, TheHalvesOfABrushAreDrawn )
{
	constexpr int kBristles = 20; // along an edge
	constexpr double kPitch = 2.0 / kBristles;
	test::Mesh brush = test::makeBox( { 0, 0, 0 }, { 2.0, 0.4, 2.0 } );
	for ( int i = 0; i < kBristles * kBristles; ++i )
	{
		const double x = kPitch * ( i % kBristles ), z = kPitch * ( i / kBristles );
		brush = test::joined(
			brush, test::makeBox( { x + 0.25 * kPitch, 0.2, z + 0.25 * kPitch }, { x + 0.75 * kPitch, 1.2, z + 0.75 * kPitch } ) );
	}
	LatticeSettings settings;
	settings.cellSize = 0.4f;
	const auto shape = BodyTemplate::build( brush.view(), settings ).value;
	ASSERT_NE( shape, nullptr );
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const body = t.addSoft( shape, at( 0, 0, 0 ) );
	t.run( 1 );
	const int whole = body->surface().vertexCount;
	ASSERT_GT( body->cutPlane( body->massCentre(), btVector3( 1, 0, 0 ), 100 ), 0 );
	t.run( 1 );
	ASSERT_EQ( t.world.softBodyCount(), 2 );
	for ( int k = 0; k < 2; ++k )
	{
		const SurfaceView view = t.world.softBody( k )->surface();
		EXPECT_GT( view.vertexCount, whole / 3 );
		EXPECT_NE( view.vertexCount, whole );
		for ( int i = 0; i < 3 * view.vertexCount; ++i )
		{
			ASSERT_LT( std::abs( view.positions[i] ), 3.0f );
		}
	}
}

} // namespace
} // namespace pliant
