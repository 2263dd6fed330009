// The skin as tables and node transforms (SoftBody::gpuSurface): a renderer that fills its buffers from the view and evaluates the shader
// draws the result of `surface`. Whole, bent, plastic, cracking, broken, and with changing levels.

#include "lattice/test_meshes.h"
#include "support/renderer_buffers.h"
#include "world/levels/adaptive_bodies.h"

#include <pliant/render/gpu_surface.h>

#include <gtest/gtest.h>

#include <map>
#include <optional>

namespace pliant::test {
namespace {

constexpr double kPositionBound = 1e-4; // cells
constexpr double kDegree = 0.017453292519943295;

std::shared_ptr<const BodyTemplate> bumpySphere( int cells, int rings )
{
	const Mesh mesh = makeBumpySphere( 0.5, 0.1, rings, 2 * rings );
	LatticeSettings settings;
	settings.targetCells = cells;
	return BodyTemplate::build( mesh.view(), settings ).value;
}

/// Two worlds with the same bodies: one test reads the skins, the other the tables.
struct Twins
{
	TestWorld onCpu, onGpu;
	std::map<const SoftBody*, RendererBuffers> buffers;
	double worstPosition = 0.0, worstAngle = 0.0; ///< cells; rad
	std::size_t sent = 0;                         ///< bytes by events in the last frame
	int brokenVertices = 0, mixedVertices = 0, offsetFrames = 0, unsound = 0, vertices = 0;

	template <class Fill>
	explicit Twins( Fill&& fill )
	{
		for ( TestWorld* test : { &onCpu, &onGpu } )
		{
			fill( *test );
			for ( const auto& body : test->soft )
			{
				body->setSurfaceTolerance( 0 );
			}
		}
		compare();
	}
	template <class Change>
	void both( Change&& change )
	{
		change( onCpu );
		change( onGpu );
	}
	void step()
	{
		onCpu.run( 1 );
		onGpu.run( 1 );
		compare();
	}
	void compare()
	{
		ASSERT_EQ( onCpu.world.softBodyCount(), onGpu.world.softBodyCount() );
		sent = 0;
		for ( int k = 0; k < onCpu.world.softBodyCount(); ++k )
		{
			compare( *onCpu.world.softBody( k ), *onGpu.world.softBody( k ) );
		}
	}
	void compare( const SoftBody& cpu, const SoftBody& gpu )
	{
		const SurfaceView wanted = cpu.surface();
		const GpuSurfaceView view = gpu.gpuSurface();
		RendererBuffers& drawn = buffers[&gpu];
		drawn.draw( view );
		sent += drawn.sentByEvents;
		EXPECT_EQ( gpu.impl().skin.frame, 0u ) << "it was skinned on the CPU too";
		EXPECT_TRUE( gpu.impl().skin.positions[0].empty() && gpu.impl().skin.positions[1].empty() );
		ASSERT_EQ( int( drawn.positions.size() ), wanted.vertexCount );
		ASSERT_EQ( int( drawn.indices.size() ), 3 * wanted.triangleCount );
		ASSERT_TRUE( std::equal( drawn.indices.begin(), drawn.indices.end(), wanted.indices ) );
		EXPECT_EQ( view.origin, wanted.origin );
		EXPECT_EQ( view.topologyVersion, wanted.topologyVersion );
		const float cell = cpu.bodyTemplate().cellSize();
		for ( int v = 0; v < wanted.vertexCount; ++v )
		{
			const Float3 at = { wanted.positions[3 * v], wanted.positions[3 * v + 1], wanted.positions[3 * v + 2] };
			const Float3 normal = { wanted.normals[3 * v], wanted.normals[3 * v + 1], wanted.normals[3 * v + 2] };
			worstPosition = std::max( worstPosition, double( lengthOf( drawn.positions[std::size_t( v )] - at ) / cell ) );
			mixedVertices += drawn.isMixed( std::uint32_t( v ) ) ? 1 : 0;
			// Where rounding of positions determines the orientation of triangles, any normal is accepted.
			const bool isSound = drawn.isMixed( std::uint32_t( v ) ) ||
				drawn.normalErrorAt( std::uint32_t( v ), 4e-6f * cell ) < 0.5f * float( kDegree );
			unsound += isSound ? 0 : 1;
			if ( isSound )
			{
				const double angle = 2.0 *
					std::asin( std::min( 1.0, 0.5 * double( lengthOf( drawn.normals[std::size_t( v )] - normal ) ) ) );
				worstAngle = std::max( worstAngle, angle );
			}
		}
		vertices += wanted.vertexCount;
		brokenVertices += view.triangleSource ? wanted.vertexCount : 0;
		offsetFrames += view.offsets.count > 0 ? 1 : 0;
	}
	void expectEqual() const
	{
		EXPECT_LE( worstPosition, kPositionBound );
		EXPECT_LE( worstAngle, kDegree );
		EXPECT_LE( unsound, 0.06 * vertices );
		std::printf( "worst vertex %.2g cells, worst normal %.2g degrees; %d of %d vertices on slivers\n", worstPosition,
			worstAngle / kDegree, unsound, vertices );
	}
};

TEST( GpuSurface, DrawsABodyThatFallsAndBends )
{
	Twins twins( []( TestWorld& test ) {
		test.addFloor();
		Material soft = stiff( 2e4f );
		soft.yieldStrain = 0.05f;
		for ( int k = 0; k < 2; ++k )
		{
			const btTransform where( btQuaternion( btVector3( 1, 2, 0 ).normalized(), btScalar( 0.3 ) ), btVector3( 2 * k, 1, 0 ) );
			SoftBody* const body = test.addSoft( bumpySphere( 200, 24 ), where, k == 0 ? stiff( 2e4f ) : soft );
			EXPECT_TRUE( body->setVelocities( btVector3( 0, -4, 0 ), btVector3( 3, 2, 1 ) ).ok() );
		}
	} );
	EXPECT_GT( twins.sent, 0u );
	for ( int frame = 0; frame < 40; ++frame )
	{
		twins.step();
		EXPECT_EQ( twins.sent, 0u ) << "nothing broke";
	}
	twins.expectEqual();
}

TEST( GpuSurface, DrawsWhatBreaks )
{
	Twins twins( []( TestWorld& test ) {
		test.addFloor();
		for ( int k = 0; k < 2; ++k )
		{
			SoftBody* const body = k == 0 ? test.addSoft( bumpySphere( 300, 24 ), at( 0, 1, 0 ), stiff( 3e4f ) )
										  : test.addSoft( block( 4, 4, 6, 0.1f ), at( 3, 1, 0 ), stiff( 3e4f ) );
			Fracture fracture;
			fracture.rule = BreakRule::Distance;
			fracture.breakStrain = 0.04f;
			EXPECT_TRUE( body->setFracture( fracture ).ok() );
			EXPECT_TRUE( body->setVelocities( btVector3( 0, -6, 0 ), btVector3( 0, 8, 2 ) ).ok() );
		}
	} );
	for ( int frame = 0; frame < 40; ++frame )
	{
		twins.step();
	}
	EXPECT_GT( twins.onGpu.world.softBodyCount(), 4 );
	EXPECT_GT( twins.mixedVertices, 0 ) << "no vertex lies within an intact panel";
	twins.expectEqual();
}

// A body that stays in one piece: tables change with its cracks alone.
TEST( GpuSurface, DrawsACrackThatGrows )
{
	Twins twins( []( TestWorld& test ) {
		test.world.setGravity( btVector3( 0, 0, 0 ) );
		SoftBody* const body = test.addSoft( bumpySphere( 1500, 80 ), at( 0, 0, 0 ) );
		EXPECT_TRUE( body->prepareCracks().ok() );
		EXPECT_TRUE( body->setVelocities( btVector3( 0, 0, 0 ), btVector3( 0, 2, 0 ) ).ok() );
	} );
	for ( int frame = 0; frame < 12; ++frame )
	{
		const bool cuts = frame % 3 == 0;
		if ( cuts )
		{
			const btVector3 point( btScalar( 0.42 ), btScalar( 0.06 * frame - 0.2 ), 0 );
			twins.both( [&]( TestWorld& test ) {
				EXPECT_GT( test.soft[0]->cutPlane( test.soft[0]->massCentre() + point, btVector3( 0, 1, 0 ), btScalar( 0.1 ) ), 0 );
			} );
		}
		twins.step();
		EXPECT_EQ( twins.onGpu.world.softBodyCount(), 1 );
		EXPECT_EQ( twins.sent > 0, cuts ) << frame;
	}
	twins.expectEqual();
}

TEST( GpuSurface, FollowsChangesOfLevelsWithoutAJump )
{
	Twins twins( []( TestWorld& test ) {
		test.addFloor();
		SoftBody* const body = test.addSoft( bumpySphere( 1200, 32 ), at( 0, btScalar( 0.9 ), 0 ), stiff( 2e4f ), levels( 2 ) );
		EXPECT_TRUE( body->setVelocities( btVector3( 0, -3, 0 ), btVector3( 1, 0, 2 ) ).ok() );
		Fracture fracture;
		fracture.rule = BreakRule::Distance;
		fracture.breakStrain = 0.3f;
		EXPECT_TRUE( body->setFracture( fracture ).ok() );
	} );
	const unsigned levelsBefore = twins.onGpu.soft[0]->levelVersion();
	for ( int frame = 0; frame < 50; ++frame )
	{
		if ( frame == 3 )
		{
			twins.both( []( TestWorld& test ) { test.soft[0]->requestRefinement( btVector3( 0, 0, 0 ), btVector3( 1, 2, 1 ) ); } );
		}
		if ( frame == 30 )
		{
			twins.both( []( TestWorld& test ) { test.soft[0]->cutPlane( test.soft[0]->massCentre(), btVector3( 0, 1, 0 ) ); } );
		}
		twins.step();
	}
	EXPECT_NE( twins.onGpu.soft[0]->levelVersion(), levelsBefore );
	EXPECT_GT( twins.offsetFrames, 0 ) << "no change of levels left an offset";
	EXPECT_GT( twins.onGpu.world.softBodyCount(), 1 );
	twins.expectEqual();
}

TEST( GpuSurface, SharesTheTablesOfATemplate )
{
	TestWorld test;
	const auto shape = bumpySphere( 100, 12 );
	const GpuSurfaceView a = test.addSoft( shape, at( 0, 0, 0 ) )->gpuSurface(), b = test.addSoft( shape, at( 3, 0, 0 ) )->gpuSurface();
	EXPECT_EQ( a.vertices.data, b.vertices.data );
	EXPECT_EQ( a.influences.data, b.influences.data );
	EXPECT_EQ( a.corners.data, b.corners.data );
	EXPECT_EQ( a.indices.data, shape->indices() );
	EXPECT_EQ( a.nodeOfCell.count, 0 );
	EXPECT_EQ( a.offsets.count, 0 );
	EXPECT_EQ( a.mixes.count, 0 );
	EXPECT_EQ( a.nodeCount, test.soft[0]->nodeCount() );
}

TEST( GpuSurface, IsTheSameFrameUntilSomethingMoves )
{
	TestWorld test;
	SoftBody* const body = test.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0, 0 ) );
	const unsigned frame = body->gpuSurface().frame;
	EXPECT_EQ( body->gpuSurface().frame, frame );
	test.run( 1 );
	EXPECT_NE( body->gpuSurface().frame, frame );
}

TEST( GpuSurface, IsEmptyWithoutASkin )
{
	LatticeSettings settings;
	settings.targetCells = 30;
	settings.skinning = Skinning::None;
	const Mesh mesh = makeBumpySphere( 0.5, 0.1, 8, 16 );
	TestWorld test;
	SoftBody* const body = test.addSoft( BodyTemplate::build( mesh.view(), settings ).value, at( 0, 0, 0 ) );
	const GpuSurfaceView view = body->gpuSurface();
	EXPECT_EQ( view.nodeTransforms, nullptr );
	EXPECT_EQ( view.vertices.count, 0 );
	EXPECT_EQ( view.indices.data, nullptr );
	EXPECT_EQ( view.frame, 0u );
	EXPECT_FALSE( body->impl().skin.gpu );
}

} // namespace
} // namespace pliant::test
