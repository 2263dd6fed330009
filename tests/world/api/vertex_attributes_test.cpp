// Sources of drawn vertices, tangents, and further render meshes: whole, bent and broken.

#include "lattice/test_meshes.h"
#include "support/renderer_buffers.h"
#include "world/levels/adaptive_bodies.h"

#include <pliant/render/render_mesh.h>
#include <pliant/render/vertex_attributes.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace pliant::test {
namespace {

/// A sphere with texture coordinates: seen along an axis, mirrored on its back.
struct Globe
{
	Mesh mesh = makeBumpySphere( 0.5, 0.1, 24, 48 );
	std::vector<float> texture, colours;

	Globe()
	{
		for ( std::size_t v = 0; v < mesh.vertexCount(); ++v )
		{
			const Vec3 p = pointOf( v );
			texture.push_back( p.x() + 0.2f * p.z() );
			texture.push_back( p.y() + 0.3f * p.x() );
			colours.insert( colours.end(), { p.x(), 2.0f * p.y(), p.x() + p.z() } );
		}
	}
	Vec3 pointOf( std::size_t v ) const { return Eigen::Map<const Vec3>( mesh.positions.data() + 3 * v ); }
	MeshView view() const
	{
		MeshView view = mesh.view();
		view.textureCoordinates = texture.data();
		return view;
	}
	std::shared_ptr<const BodyTemplate> shape( int cells = 300 ) const
	{
		LatticeSettings settings;
		settings.targetCells = cells;
		return BodyTemplate::build( view(), settings ).value;
	}
};

/// Cuts a body into two parts and lets them fall.
void cutInTwo( TestWorld& test, SoftBody& body )
{
	body.cutPlane( body.massCentre(), btVector3( 1, btScalar( 0.3 ), 0 ) );
	test.run( 3 );
	EXPECT_EQ( test.world.softBodyCount(), 2 );
}

TEST( VertexSources, AreTheInputsOwnVerticesAsLongAsNothingBreaks )
{
	const Globe globe;
	TestWorld test;
	SoftBody* const body = test.addSoft( globe.shape(), at( 0, 0, 0 ) );
	const VertexSourceView whole = vertexSources( *body );
	EXPECT_EQ( whole.sources, nullptr );
	EXPECT_EQ( whole.vertexCount, int( globe.mesh.vertexCount() ) );
	std::vector<float> colours( globe.colours.size() );
	EXPECT_TRUE( interpolateAttribute( whole, globe.colours.data(), 3, nullptr, colours.data() ).ok() );
	EXPECT_EQ( colours, globe.colours );
}

// Pieces, and a body that stays in one piece; requested before the break, after it, and after the skin was drawn without.
TEST( VertexSources, GiveTheTextureCoordinatesThatAreDrawn )
{
	const Globe globe;
	for ( const int when : { 0, 1, 2 } )
	{
		TestWorld test;
		test.world.setGravity( btVector3( 0, 0, 0 ) );
		SoftBody* const body = test.addSoft( globe.shape(), at( 0, 0, 0 ) );
		body->surface();
		if ( when == 0 )
		{
			EXPECT_EQ( vertexSources( *body ).sources, nullptr );
		}
		EXPECT_GT( body->cutPlane( body->massCentre() + btVector3( btScalar( 0.4 ), 0, 0 ), btVector3( 0, 1, 0 ), btScalar( 0.2 ) ), 0 );
		test.run( 1 );
		int added = 0, inside = 0;
		for ( int frame = 0; frame < 2; ++frame )
		{
			for ( int k = 0; k < test.world.softBodyCount(); ++k )
			{
				const SoftBody& piece = *test.world.softBody( k );
				if ( when == 2 )
				{
					EXPECT_NE( piece.surface().triangleSource, nullptr );
				}
				const VertexSourceView sources = vertexSources( piece );
				const SurfaceView view = piece.surface();
				ASSERT_EQ( sources.vertexCount, view.vertexCount );
				EXPECT_EQ( sources.topologyVersion, view.topologyVersion );
				const float marked[2] = { -9, -7 };
				std::vector<float> texture( 2 * std::size_t( view.vertexCount ) );
				EXPECT_TRUE( interpolateAttribute( sources, globe.texture.data(), 2, marked, texture.data() ).ok() );
				for ( int v = 0; v < view.vertexCount; ++v )
				{
					const bool isInside = sources.sources[v].vertex[0] == VertexSource::kInside;
					inside += isInside ? 1 : 0;
					added += !isInside && sources.sources[v].weight[0] < 1.0f ? 1 : 0;
					for ( int c = 0; c < 2; ++c )
					{
						EXPECT_NEAR( texture[std::size_t( 2 * v + c )], isInside ? marked[c] : view.textureCoordinates[2 * v + c], 1e-5f );
					}
				}
			}
			if ( frame == 0 )
			{
				cutInTwo( test, *body );
			}
		}
		EXPECT_GT( added, 0 );
		EXPECT_GT( inside, 0 );
	}
}

TEST( VertexSources, RefuseNullAndNoComponents )
{
	float one = 1.0f;
	const VertexSourceView none;
	EXPECT_EQ( interpolateAttribute( none, nullptr, 1, nullptr, &one ).code, ResultCode::BadArgument );
	EXPECT_EQ( interpolateAttribute( none, &one, 1, nullptr, nullptr ).code, ResultCode::BadArgument );
	EXPECT_EQ( interpolateAttribute( none, &one, 0, nullptr, &one ).code, ResultCode::BadArgument );
	EXPECT_TRUE( interpolateAttribute( none, &one, 1, nullptr, &one ).ok() );
}

/// Checks unit length and the right angle; returns the median of the angles to the direction in which u grows on the drawn triangles, over
/// the vertices at which these agree, rad.
double angleToTexture( const SoftBody& body )
{
	const TangentView view = tangents( body );
	const SurfaceView surface = body.surface();
	EXPECT_EQ( view.vertexCount, surface.vertexCount );
	EXPECT_EQ( view.frame, surface.frame );
	const auto at = [&]( std::uint32_t v ) { return Vec3( Eigen::Map<const Vec3>( surface.positions + 3 * v ) ); };
	const auto normalAt = [&]( std::uint32_t v ) { return Vec3( Eigen::Map<const Vec3>( surface.normals + 3 * v ) ); };
	const auto tangentAt = [&]( std::uint32_t v ) { return Vec3( Eigen::Map<const Vec3>( view.tangents + 4 * v ) ); };
	std::vector<double> angles;
	std::size_t turned = 0; // corners whose handedness differs from their triangle's
	for ( std::uint32_t v = 0; v < std::uint32_t( surface.vertexCount ); ++v )
	{
		EXPECT_NEAR( tangentAt( v ).norm(), 1.0f, 1e-4f );
		EXPECT_NEAR( tangentAt( v ).dot( normalAt( v ) ), 0.0f, 1e-4f );
		EXPECT_EQ( std::abs( view.tangents[4 * v + 3] ), 1.0f );
	}
	for ( int t = 0; t < surface.triangleCount; ++t )
	{
		const std::uint32_t* const c = surface.indices + 3 * t;
		const float *const a = surface.textureCoordinates + 2 * c[0], *const b = surface.textureCoordinates + 2 * c[1],
						   *const d = surface.textureCoordinates + 2 * c[2];
		const float det = ( b[0] - a[0] ) * ( d[1] - a[1] ) - ( d[0] - a[0] ) * ( b[1] - a[1] );
		const Vec3 e = at( c[1] ) - at( c[0] ), f = at( c[2] ) - at( c[0] );
		if ( e.cross( f ).norm() < 1e-5f || std::abs( det ) < 0.3f * e.cross( f ).norm() )
		{
			continue; // slivers, and triangles whose texture has no area
		}
		const Vec3 along = ( ( d[1] - a[1] ) * e - ( b[1] - a[1] ) * f ) / det;
		const Vec3 face = e.cross( f ).normalized();
		for ( int k = 0; k < 3 && det != 0.0f; ++k )
		{
			if ( normalAt( c[k] ).dot( face ) > 0.97f )
			{
				turned += view.tangents[4 * c[k] + 3] * det < 0.0f ? 1 : 0;
				const Vec3 normal = normalAt( c[k] ), level = along - normal * normal.dot( along );
				angles.push_back( std::acos( std::clamp( double( level.normalized().dot( tangentAt( c[k] ) ) ), -1.0, 1.0 ) ) );
			}
		}
	}
	EXPECT_GT( angles.size(), 100u );
	EXPECT_LT( turned, angles.size() / 50 );
	std::sort( angles.begin(), angles.end() );
	std::printf( "tangents off their triangles: median %.2g, 95 %% %.2g rad, of %zu\n", angles[angles.size() / 2],
		angles[angles.size() * 95 / 100], angles.size() );
	return angles[angles.size() / 2];
}

TEST( Tangents, FollowTheTextureWhereverTheBodyBendsAndBreaks )
{
	const Globe globe;
	TestWorld test;
	test.addFloor();
	SoftBody* const body = test.addSoft( globe.shape(), at( 0, btScalar( 0.7 ), 0 ), stiff( 2e4f ) );
	EXPECT_LT( angleToTexture( *body ), 0.03 );
	EXPECT_TRUE( body->setVelocities( btVector3( 0, -3, 0 ), btVector3( 2, 5, 1 ) ).ok() );
	test.run( 12 );
	EXPECT_LT( angleToTexture( *body ), 0.15 );
	cutInTwo( test, *body );
	EXPECT_LT( angleToTexture( *test.world.softBody( 0 ) ), 0.25 );
	EXPECT_LT( angleToTexture( *test.world.softBody( 1 ) ), 0.25 );
}

TEST( Tangents, AreThoseOfTheMeshWhereItHasSome )
{
	const Globe globe;
	std::vector<float> given;
	for ( std::size_t v = 0; v < globe.mesh.vertexCount(); ++v )
	{
		given.insert( given.end(), { 0.0f, 0.0f, 1.0f, v % 2 == 0 ? 1.0f : -1.0f } );
	}
	LatticeSettings settings;
	settings.targetCells = 100;
	MeshView view = globe.mesh.view();
	EXPECT_TRUE( BodyTemplate::build( view, settings ).ok() );
	view.tangents = given.data();
	TestWorld test;
	const SoftBody* const body = test.addSoft( BodyTemplate::build( view, settings ).value, at( 0, 0, 0 ) );
	const TangentView rest = restTangents( *body );
	ASSERT_EQ( rest.vertexCount, int( globe.mesh.vertexCount() ) );
	EXPECT_TRUE( std::equal( given.begin(), given.end(), rest.tangents ) );
	EXPECT_EQ( tangents( *body ).tangents[4 * 7 + 3], -1.0f );
	given[9] = std::numeric_limits<float>::infinity();
	EXPECT_EQ( BodyTemplate::build( view, settings ).status.code, ResultCode::NonFiniteVertex );
}

TEST( Tangents, AreNoneWithoutATexture )
{
	TestWorld test;
	const SoftBody* const body = test.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0, 0 ) );
	EXPECT_EQ( tangents( *body ).tangents, nullptr );
	EXPECT_EQ( restTangents( *body ).vertexCount, 0 );
}

// The template's own mesh as a further render mesh is drawn like the body's own skin, whole and broken, by the CPU and by tables.
TEST( RenderMesh, OfTheSameMeshIsTheSameSkin )
{
	const Globe globe;
	TestWorld test;
	test.addFloor();
	const auto shape = globe.shape();
	SoftBody* const body = test.addSoft( shape, at( 0, btScalar( 0.7 ), 0 ), stiff( 2e4f ) );
	body->setSurfaceTolerance( 0 );
	const auto mesh = RenderMesh::bind( shape, globe.view() );
	ASSERT_TRUE( mesh.ok() ) << mesh.status.sentence;
	EXPECT_EQ( mesh.value->vertexCount(), shape->vertexCount() );
	EXPECT_EQ( mesh.value->triangleCount(), shape->triangleCount() );
	EXPECT_EQ( &mesh.value->bodyTemplate(), shape.get() );
	std::map<const SoftBody*, std::unique_ptr<RenderSkin>> skins;
	std::map<const SoftBody*, RendererBuffers> buffers;
	for ( int frame = 0; frame < 16; ++frame )
	{
		test.run( 1 );
		if ( frame == 8 )
		{
			cutInTwo( test, *body );
		}
		for ( int k = 0; k < test.world.softBodyCount(); ++k )
		{
			const SoftBody& piece = *test.world.softBody( k );
			std::unique_ptr<RenderSkin>& skin = skins[&piece];
			skin = skin ? std::move( skin ) : std::move( RenderSkin::create( mesh.value ).value );
			const SurfaceView wanted = piece.surface(), drawn = skin->surface( piece );
			RendererBuffers& onGpu = buffers[&piece];
			onGpu.draw( skin->gpuSurface( piece ) );
			EXPECT_EQ( skin->surface( piece ).frame, drawn.frame );
			ASSERT_EQ( trianglesOf( drawn ).size(), trianglesOf( wanted ).size() ) << frame;
			ASSERT_EQ( int( onGpu.positions.size() ), drawn.vertexCount );
			for ( int v = 0; v < drawn.vertexCount; ++v )
			{
				const Float3 at = { drawn.positions[3 * v], drawn.positions[3 * v + 1], drawn.positions[3 * v + 2] };
				ASSERT_LT( lengthOf( onGpu.positions[std::size_t( v )] - at ), 1e-5f );
			}
			const auto a = trianglesOf( drawn ), b = trianglesOf( wanted );
			for ( std::size_t t = 0; t < a.size(); ++t )
			{
				for ( std::size_t c = 0; c < a[t].size(); ++c )
				{
					ASSERT_NEAR( a[t][c], b[t][c], 1e-4f );
				}
			}
			EXPECT_EQ( skin->vertexSources( piece ).vertexCount, drawn.vertexCount );
			EXPECT_EQ( skin->vertexSources( piece ).sources == nullptr, test.world.softBodyCount() == 1 );
		}
	}
}

// A coarse mesh and a part of a body that has no skin of its own.
TEST( RenderMesh, DrawsOtherMeshesOfABodyAndItsPieces )
{
	const Globe globe;
	LatticeSettings settings;
	settings.targetCells = 300;
	settings.skinning = Skinning::None;
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	const auto shape = BodyTemplate::build( globe.view(), settings ).value;
	SoftBody* const body = test.addSoft( shape, at( 1, 2, 3 ) );
	const Mesh coarse = makeBumpySphere( 0.5, 0.1, 8, 16 );
	const auto mesh = RenderMesh::bind( shape, coarse.view() );
	ASSERT_TRUE( mesh.ok() );
	const auto skin = RenderSkin::create( mesh.value );
	ASSERT_TRUE( skin.ok() );
	const SurfaceView whole = skin.value->surface( *body );
	EXPECT_EQ( whole.vertexCount, int( coarse.vertexCount() ) );
	for ( int v = 0; v < whole.vertexCount; ++v )
	{
		const Vec3 at = Eigen::Map<const Vec3>( whole.positions + 3 * v ) + toVec3( whole.origin ) - Vec3( 1, 2, 3 );
		EXPECT_LT( ( at - Eigen::Map<const Vec3>( coarse.positions.data() + 3 * v ) ).norm(), 1e-4f );
	}
	cutInTwo( test, *body );
	int triangles = 0;
	for ( int k = 0; k < 2; ++k )
	{
		const auto own = RenderSkin::create( mesh.value );
		const SurfaceView piece = own.value->surface( *test.world.softBody( k ) );
		EXPECT_GT( piece.vertexCount, 0 );
		ASSERT_NE( piece.triangleSource, nullptr );
		triangles += piece.triangleCount;
	}
	EXPECT_GT( triangles, coarse.triangleCount() );
}

TEST( RenderMesh, RefusesBadInput )
{
	const Globe globe;
	const auto shape = globe.shape( 100 );
	EXPECT_EQ( RenderMesh::bind( nullptr, globe.view() ).status.code, ResultCode::BadArgument );
	EXPECT_EQ( RenderMesh::bind( shape, MeshView{} ).status.code, ResultCode::EmptyMesh );
	std::vector<std::uint32_t> indices = globe.mesh.indices;
	indices[5] = 1000000;
	MeshView view = globe.view();
	view.indices = indices.data();
	EXPECT_EQ( RenderMesh::bind( shape, view ).status.code, ResultCode::IndexOutOfRange );
	std::vector<float> positions = globe.mesh.positions;
	positions[4] = std::numeric_limits<float>::quiet_NaN();
	view = globe.view();
	view.positions = positions.data();
	EXPECT_EQ( RenderMesh::bind( shape, view ).status.code, ResultCode::NonFiniteVertex );
	EXPECT_EQ( RenderSkin::create( nullptr ).status.code, ResultCode::BadArgument );

	const auto skin = RenderSkin::create( RenderMesh::bind( shape, globe.view() ).value );
	TestWorld test;
	const SoftBody* const other = test.addSoft( globe.shape( 100 ), at( 0, 0, 0 ) );
	EXPECT_EQ( skin.value->surface( *other ).vertexCount, 0 ) << "of another template";
	EXPECT_EQ( skin.value->gpuSurface( *other ).vertices.count, 0 );
	EXPECT_EQ( skin.value->vertexSources( *other ).vertexCount, 0 );
}

} // namespace
} // namespace pliant::test
