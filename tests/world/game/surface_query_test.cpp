// Queries about the surface and the volume of a body.

#include "world/game/hollow_box.h"
#include "world/test_world.h"

#include <pliant/game/queries.h>

#include <limits>

namespace pliant::test {

namespace {

std::shared_ptr<const BodyTemplate> undrawnCube()
{
	const std::vector<float> corners = { -0.5f, -0.5f, -0.5f, 0.5f, -0.5f, -0.5f, -0.5f, 0.5f, -0.5f, 0.5f, 0.5f, -0.5f, -0.5f, -0.5f, 0.5f,
		0.5f, -0.5f, 0.5f, -0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f };
	static const std::uint32_t indices[36] = {
		0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
	MeshView mesh;
	mesh.positions = corners.data();
	mesh.vertexCount = 8;
	mesh.indices = indices;
	mesh.triangleCount = 12;
	LatticeSettings settings;
	settings.cellSize = 0.25f;
	settings.skinning = Skinning::None;
	return BodyTemplate::build( mesh, settings ).value;
}

} // namespace

TEST( SurfaceQuery, OfACubeKnowsPointsVolumeAndArea )
{
	for ( const bool isDrawn : { true, false } )
	{
		TestWorld t;
		SoftBody* cube = t.addSoft( isDrawn ? block( 4, 4, 4, 0.25f ) : undrawnCube(), at( 100, 20, -30 ) );
		const SurfaceQuery query( *cube );
		EXPECT_EQ( query.isDrawn(), isDrawn );
		EXPECT_NEAR( query.volume(), 1, 1e-4 );
		EXPECT_NEAR( query.area(), 6, 1e-3 );
		const NearestPoint above = query.nearest( btVector3( 100.1f, 22, -30 ) );
		EXPECT_NEAR( above.distance, 1.5, 1e-4 );
		EXPECT_NEAR( above.point.y(), 20.5, 1e-4 );
		EXPECT_NEAR( above.point.x(), 100.1, 1e-4 );
		EXPECT_GT( above.normal.y(), 0.999 );
		EXPECT_EQ( above.triangle >= 0, isDrawn );
		ASSERT_GE( above.node, 0 );
		EXPECT_GT( cube->nodePosition( above.node ).y(), 20.2 );
		const NearestPoint within = query.nearest( btVector3( 100.4f, 20, -30 ) );
		EXPECT_NEAR( within.distance, -0.1, 1e-4 );
		EXPECT_GT( within.normal.x(), 0.999 );
		const NearestPoint corner = query.nearest( btVector3( 101, 21, -29 ) );
		EXPECT_NEAR( corner.distance, 0.866, 1e-3 );
		EXPECT_NEAR( corner.normal.x(), 0.577, 1e-3 );
		const NearestPoint on = query.nearest( btVector3( 100, 20.5f, -30 ) );
		EXPECT_NEAR( on.distance, 0, 1e-5 );
		EXPECT_GT( on.normal.y(), 0.999 );
		EXPECT_TRUE( query.isInside( btVector3( 100, 20, -30 ) ) );
		EXPECT_TRUE( query.isInside( btVector3( 100.49f, 20.49f, -30.49f ) ) );
		EXPECT_FALSE( query.isInside( btVector3( 100.51f, 20, -30 ) ) );
		EXPECT_TRUE( query.touchesSphere( btVector3( 101, 20, -30 ), btScalar( 0.51 ) ) );
		EXPECT_FALSE( query.touchesSphere( btVector3( 101, 20, -30 ), btScalar( 0.49 ) ) );
		EXPECT_TRUE( query.touchesSphere( btVector3( 100, 20, -30 ), 0 ) ) << "inside";
	}
}

TEST( SurfaceQuery, FollowsTheShapeAndStaysAsItWas )
{
	TestWorld t;
	t.addFloor();
	SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.25f ), at( 0, 0.5f, 0 ), stiff( 2e5f ) );
	const SurfaceQuery before( *cube );
	t.addBox( 1500, btVector3( 0.6f, 0.1f, 0.6f ), at( 0, 1.1f, 0 ) );
	t.run( 120 );
	const SurfaceQuery after( *cube );
	EXPECT_NEAR( before.nearest( btVector3( 0, 3, 0 ) ).distance, 2, 1e-3 );
	EXPECT_GT( after.nearest( btVector3( 0, 3, 0 ) ).distance, 2.02 ) << "squeezed by the load";
	EXPECT_LT( after.volume(), 1.02 );
	EXPECT_FALSE( after.isInside( btVector3( 0, 0.99f, 0 ) ) );
	EXPECT_TRUE( after.isInside( btVector3( 0, 0.5f, 0 ) ) );
}

TEST( SurfaceQuery, TheCavityIsNotInside )
{
	TestWorld t;
	SoftBody* hollow = t.addSoft( hollowBox( 1, 0.125f ), at( 0, 0, 0 ) );
	const SurfaceQuery query( *hollow );
	EXPECT_NEAR( query.volume(), 1 - 0.75 * 0.75 * 0.75, 0.01 );
	EXPECT_FALSE( query.isInside( btVector3( 0, 0, 0 ) ) );
	EXPECT_TRUE( query.isInside( btVector3( 0, 0.44f, 0 ) ) );
	const NearestPoint wall = query.nearest( btVector3( 0, 0.3f, 0 ) );
	EXPECT_NEAR( wall.distance, 0.075, 0.01 );
	EXPECT_LT( wall.normal.y(), -0.9 ) << "out of the material";
}

TEST( SurfaceQuery, OfPiecesIsClosedByTheFacesOfTheCrack )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.25f ), at( 0, 0, 0 ) );
	EXPECT_GT( cube->cutPlane( btVector3( 0, 0, 0 ), btVector3( 1, 0, 0 ) ), 0 );
	t.run( 2 );
	ASSERT_EQ( t.world.softBodyCount(), 2 );
	SoftBody* left = t.world.softBody( 0 )->massCentre().x() < 0 ? t.world.softBody( 0 ) : t.world.softBody( 1 );
	ASSERT_TRUE( left->teleport( at( -1, 0, 0 ) ).ok() );
	const SurfaceQuery piece( *left );
	EXPECT_NEAR( piece.volume(), 0.5, 0.02 );
	EXPECT_TRUE( piece.isInside( btVector3( -1.25f, 0, 0 ) ) );
	EXPECT_FALSE( piece.isInside( btVector3( -0.75f, 0, 0 ) ) );
	EXPECT_NEAR( piece.nearest( btVector3( -0.5f, 0, 0 ) ).distance, 0.5, 0.03 );
}

TEST( SurfaceQuery, BadNumbersFindNothing )
{
	const btScalar bad = std::numeric_limits<btScalar>::quiet_NaN();
	TestWorld t;
	SoftBody* cube = t.addSoft( block( 2, 2, 2, 0.25f ), at( 0, 0, 0 ) );
	const SurfaceQuery query( *cube );
	EXPECT_EQ( query.nearest( btVector3( bad, 0, 0 ) ).node, -1 );
	EXPECT_FALSE( query.isInside( btVector3( 0, bad, 0 ) ) );
	EXPECT_FALSE( query.touchesSphere( btVector3( 0, 0, bad ), 1 ) );
	EXPECT_FALSE( query.touchesSphere( btVector3( 0, 0, 0 ), bad ) );
	EXPECT_FALSE( query.touchesSphere( btVector3( 0, 0, 0 ), -1 ) );
}

} // namespace pliant::test
