// Typical models of games: leaves, ribbons, capes, boxes without a lid, a hull full of holes, a fin as thin as paper on a solid body. Each
// must become a body that carries all of its drawn surface, rests on a floor, and can be cut.

#include "support/explicit_material.h"
#include "world/test_world.h"

#include "lattice/lattice.h"
#include "test_meshes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

namespace pliant::test {

namespace {

struct ThinModel
{
	std::string name;
	std::function<Mesh()> make;
	int mostParts = 1; ///< connected parts of the lattice
};

/// The unit square in the plane z = 0, n x n quads.
Mesh sheetOf( int n )
{
	Mesh mesh;
	for ( int i = 0; i <= n; ++i )
	{
		for ( int j = 0; j <= n; ++j )
		{
			mesh.addVertex( double( i ) / n, double( j ) / n, 0.0 );
		}
	}
	const std::uint32_t row = std::uint32_t( n + 1 );
	for ( std::uint32_t i = 0; i < std::uint32_t( n ); ++i )
	{
		for ( std::uint32_t j = 0; j < std::uint32_t( n ); ++j )
		{
			mesh.addQuad( i * row + j, ( i + 1 ) * row + j, ( i + 1 ) * row + j + 1, i * row + j + 1 );
		}
	}
	return mesh;
}

template <class F>
Mesh bent( Mesh mesh, F&& map )
{
	for ( std::size_t i = 0; i < mesh.positions.size(); i += 3 )
	{
		const Point p = map( double( mesh.positions[i] ), double( mesh.positions[i + 1] ), double( mesh.positions[i + 2] ) );
		std::copy( p.begin(), p.end(), mesh.positions.begin() + std::ptrdiff_t( i ) );
	}
	return mesh;
}

/// Curved, pointed at its ends, and drawn from both sides with separate vertices, like a plant's leaf.
Mesh leaf()
{
	const Mesh side = bent( sheetOf( 12 ), []( double u, double v, double ) {
		return Point{ u - 0.5, ( v - 0.5 ) * 0.6 * std::sin( 3.14159 * u ), 0.3 * u * u };
	} );
	return joined( side, flipped( side ) );
}

Mesh ribbon()
{
	return bent( sheetOf( 24 ), []( double u, double v, double ) {
		const double turn = 9.0 * u;
		return Point{ 0.3 * std::cos( turn ), u - 0.5 + 0.02 * v, 0.3 * std::sin( turn ) };
	} );
}

Mesh finBesideCube()
{
	return joined( makeBox( { -0.25, -0.25, -0.25 }, { 0.25, 0.25, 0.25 } ), makeBox( { 0.24, -0.2, -0.001 }, { 0.9, 0.2, 0.001 } ) );
}

/// 10 000 triangles, every tenth of them missing.
Mesh hullOfHoles()
{
	return without( makeSphere( 0.5, 50, 102 ), []( std::size_t t ) { return t % 10 == 3; } );
}

std::vector<ThinModel> thinModels()
{
	return { { "OpenBox",
				 []() {
					 return without( makeBox( { -0.5, -0.3, -0.4 }, { 0.5, 0.3, 0.4 }, 8 ), []( std::size_t t ) { return t < 128; } );
				 } },
		{ "Sheet", []() { return sheetOf( 10 ); } }, { "SlantedSheet", []() { return rotated( sheetOf( 1 ), 0.6 ); } },
		{ "Leaf", []() { return leaf(); }, 4 }, // its bent middle encloses a thin inside, which its tips are not linked to
		{ "Ribbon", []() { return ribbon(); } },
		{ "Triangle",
			[]() {
				Mesh mesh = sheetOf( 1 );
				mesh.indices.resize( 3 );
				return mesh;
			} },
		{ "PressedFlat",
			[]() {
				return makeBox( { 0, 0, 0 }, { 1, 1, 0 } );
			} },
		{ "FinBesideCube", []() { return finBesideCube(); } }, { "HullOfHoles", []() { return hullOfHoles(); } } };
}

class ThinModels : public testing::TestWithParam<ThinModel>
{};

std::shared_ptr<const BodyTemplate> templateOf( const Mesh& mesh, Shell shell = Shell::WhereNeeded )
{
	LatticeSettings settings;
	settings.targetCells = 500;
	settings.shell = shell;
	const auto made = BodyTemplate::build( mesh.view(), settings );
	EXPECT_TRUE( made.ok() ) << made.status.sentence;
	return made.value;
}

float lowestDrawn( const SoftBody& body, const Mesh& mesh )
{
	const SurfaceView view = body.surface();
	float low = 1e9f;
	for ( const std::uint32_t vertex : mesh.indices )
	{
		low = std::min( low, view.positions[3 * std::size_t( vertex ) + 1] );
	}
	return low + float( view.origin.y() );
}

TEST_P( ThinModels, CarryTheirWholeSurface )
{
	const Mesh mesh = GetParam().make();
	const auto shape = templateOf( mesh );
	ASSERT_NE( shape, nullptr );
	EXPECT_NEAR( shape->cellCount(), 500, 250 );
	EXPECT_LE( shape->report().components, GetParam().mostParts );
	TestWorld scene;
	const SoftBody* body = scene.addSoft( shape, btTransform::getIdentity() );
	const SurfaceView view = body->surface();
	btScalar farthest = 0;
	for ( const std::uint32_t vertex : mesh.indices )
	{
		const float* p = view.positions + 3 * std::size_t( vertex );
		btScalar nearest = SIMD_INFINITY;
		for ( int node = 0; node < body->nodeCount(); ++node )
		{
			nearest = btMin(
				nearest, body->nodePosition( node ).distance( view.origin + btVector3( p[0], p[1], p[2] ) ) - body->nodeRadius( node ) );
		}
		farthest = btMax( farthest, nearest );
	}
	EXPECT_LE( farthest, 1.01f * shape->cellSize() ); // a thread's radius is rounded to a radius step
}

TEST_P( ThinModels, FallAndLieOnTheFloor )
{
	const Mesh mesh = GetParam().make();
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		TestWorld scene;
		scene.addFloor();
		Material material = test::explicitMaterial();
		material.elasticity = elasticity;
		SoftBody* body = scene.addSoft( templateOf( mesh ), at( 0, 0, 0 ), material );
		EXPECT_TRUE( body->teleport( at( 0, btScalar( 0.1 ) - lowestDrawn( *body, mesh ), 0 ) ).ok() );
		scene.run( 150 );
		EXPECT_GT( lowestDrawn( *body, mesh ), -body->bodyTemplate().cellSize() ) << int( elasticity );
		EXPECT_LT( lowestDrawn( *body, mesh ), 2 * body->bodyTemplate().cellSize() ) << int( elasticity );
		EXPECT_LT( body->linearVelocity().length(), 0.3f ) << int( elasticity );
		EXPECT_LT( body->massCentre().length(), 2 ) << int( elasticity );
	}
}

// Cutting requests the crack surface: an open surface has no inside to show, but the pieces exist.
TEST_P( ThinModels, AreCutInTwo )
{
	const Mesh mesh = GetParam().make();
	TestWorld scene;
	scene.addFloor();
	SoftBody* body = scene.addSoft( templateOf( mesh ), at( 0, 1, 0 ) );
	Fracture fracture;
	fracture.rule = BreakRule::Distance;
	EXPECT_TRUE( body->setFracture( fracture ).ok() );
	EXPECT_GT( body->cutPlane( body->massCentre() + btVector3( btScalar( 0.013 ), 0, 0 ), btVector3( 1, 0, 0 ) ), 0 );
	scene.run( 30 );
	EXPECT_GT( body->fractureVersion(), 0u );
	EXPECT_GE( scene.world.getNumCollisionObjects(), 3 );
	const SurfaceView view = body->surface();
	ASSERT_NE( view.positions, nullptr );
	for ( int i = 0; i < 3 * view.vertexCount; ++i )
	{
		ASSERT_TRUE( std::isfinite( view.positions[i] ) );
	}
}

INSTANTIATE_TEST_SUITE_P( Shapes, ThinModels, testing::ValuesIn( thinModels() ),
	[]( const testing::TestParamInfo<ThinModel>& model ) { return model.param.name; } );

// A hollow and a solid ball of the same mesh, by the setting.
TEST( ThinModels, HollowWhereAsked )
{
	const Mesh ball = makeSphere( 0.5, 24, 48 );
	const auto full = templateOf( ball ), hollow = templateOf( ball, Shell::Always );
	EXPECT_EQ( full->report().shellCells, 0 );
	EXPECT_EQ( hollow->report().shellCells, hollow->cellCount() );
	EXPECT_LT( hollow->cellSize(), full->cellSize() );
	EXPECT_EQ( hollow->report().components, 1 );
	const Lattice& lattice = hollow->lattice();
	for ( const Vec3& centre : lattice.restCentre )
	{
		EXPECT_GT( centre.norm(), 0.5f - lattice.cellSize );
	}
}

} // namespace

} // namespace pliant::test
