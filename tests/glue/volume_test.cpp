// Grey images: files are read as they were written, and damaged files are refused; the surface made from an image is closed. Also the blade
// of the mouse.

#include "demos/liver.h"
#include "demos/mouse_blade.h"
#include "support/test_world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <utility>

using namespace pliant_glue;

namespace {

constexpr std::size_t kHeader = 256;

std::string header( const std::string& lines )
{
	const std::string end = "##}\n";
	std::string text = "#INRIMAGE-4#{\n" + lines;
	return text + std::string( kHeader - text.size() - end.size(), '\n' ) + end;
}

std::string fourByThreeByTwo()
{
	std::string file = header(
		"XDIM=4\nYDIM=3\nZDIM=2\nVDIM=1\nTYPE=unsigned fixed\nPIXSIZE=8 bits\nSCALE=2**0\nCPU=decm\nVX=0.5\nVY=0.75\nVZ=2\n" );
	for ( int i = 0; i < 24; ++i )
	{
		file.push_back( char( 200 + i ) );
	}
	return file;
}

TEST( GreyVolumes, AreReadAsWritten )
{
	const VolumeResult read = readInr( fourByThreeByTwo() );
	ASSERT_TRUE( read.ok() ) << read.status.sentence;
	EXPECT_EQ( read.volume.size, ( std::array<int, 3>{ 4, 3, 2 } ) );
	EXPECT_EQ( read.volume.spacing, ( std::array<float, 3>{ 0.5f, 0.75f, 2.0f } ) );
	EXPECT_EQ( read.volume.at( 3, 1, 1 ), 200 + 12 + 4 + 3 );
}

TEST( GreyVolumes, ThatAreDamagedAreRefusedWithASentence )
{
	const std::string whole = fourByThreeByTwo();
	for ( std::size_t length = 0; length < whole.size(); ++length )
	{
		const VolumeResult read = readInr( std::string_view( whole ).substr( 0, length ) );
		EXPECT_FALSE( read.ok() ) << length;
		EXPECT_FALSE( read.status.sentence.empty() );
	}
	const std::pair<std::string, std::string> changes[] = { { "XDIM=4", "XDIM=0" }, { "YDIM=3", "YDIM=-" }, { "8 bits", "9 bits" },
		{ "VDIM=1", "VDIM=3" }, { "VX=0.5", "VX=0.0" }, { "unsigned", "unsigneD" }, { "XDIM=4", "XDIM=5" } };
	for ( const auto& [from, to] : changes )
	{
		std::string changed = whole;
		changed.replace( changed.find( from ), from.size(), to );
		EXPECT_EQ( readInr( changed ).status.code, FileCode::Unreadable ) << to;
	}
	ReadLimits small;
	small.fileBytes = 23;
	EXPECT_EQ( readInr( whole, small ).status.code, FileCode::TooLarge );
	EXPECT_EQ( readVolume( "/nowhere/at/all.inr" ).status.code, FileCode::NotFound );
}

/// Volume of a mesh in which every edge has two triangles; NaN if it is open.
double volumeInside( const ModelMesh& mesh )
{
	std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
	double sum = 0;
	for ( std::size_t t = 0; t < mesh.indices.size(); t += 3 )
	{
		const float *a = &mesh.positions[3 * mesh.indices[t]], *b = &mesh.positions[3 * mesh.indices[t + 1]],
					*c = &mesh.positions[3 * mesh.indices[t + 2]];
		sum += double( a[0] ) * ( double( b[1] ) * c[2] - double( b[2] ) * c[1] ) +
			double( a[1] ) * ( double( b[2] ) * c[0] - double( b[0] ) * c[2] ) +
			double( a[2] ) * ( double( b[0] ) * c[1] - double( b[1] ) * c[0] );
		for ( std::size_t k = 0; k < 3; ++k )
		{
			edges[{ mesh.indices[t + k], mesh.indices[t + ( k + 1 ) % 3] }] += 1;
		}
	}
	for ( const auto& [edge, count] : edges )
	{
		const auto back = edges.find( { edge.second, edge.first } );
		if ( count != 1 || back == edges.end() )
		{
			return std::nan( "" );
		}
	}
	return sum / 6;
}

TEST( GreyVolumes, HaveAClosedSurfaceOfTheirVolume )
{
	// A ball of radius 20 that reaches the image's border, in voxels of 1 x 1 x 2.
	GreyVolume ball;
	ball.size = { 40, 40, 20 };
	ball.spacing = { 1, 1, 2 };
	for ( int i = 0; i < 40 * 40 * 20; ++i )
	{
		const double x = i % 40 - 19.5, y = i / 40 % 40 - 19.5, z = 2 * ( i / 1600 - 9.5 );
		ball.values.push_back( x * x + y * y + z * z < 400 ? 84 : 0 );
	}
	// A surface of radius R that is smoothed over sigma moves inward by sigma^2 / R; two passes of 1 : 2 : 1, box-shaped samples, and
	// linear interpolation between them make sigma^2 ( 1 + 1/12 + 1/6 ) samples squared.
	const double shrunk = 1.0 - 3.0 * 1.25 * 2.5 * 2.5 / 400.0;
	EXPECT_NEAR( volumeInside( pliant_demos::surfaceOfVolume( ball, 2.5f ) ) / ( 4.0 / 3 * 3.14159265 * 8000 ), shrunk, 0.01 );
	EXPECT_GT( volumeInside( pliant_demos::makeLiverLike() ), 1e-3 );
}

TEST( MouseBlade, CutsWhatLiesBetweenTwoRaysAndNotWhatLiesBeforeTheFirst )
{
	pliant::test::WorldOf<pliant::SoftBodyWorld> scene;
	scene.world.setGravity( btVector3( 0, 0, 0 ) );
	const auto body = pliant::SoftBody::create( pliant::test::cubeTemplate( 1.0f, 6 ), btTransform::getIdentity() );
	ASSERT_TRUE( body.ok() );
	scene.world.addSoftBody( body.value.get() );
	pliant_demos::MouseBlade blade( scene.world );
	const btVector3 eye( 0, btScalar( 0.01 ), 5 );
	const auto towards = [&]( btScalar x ) { return ( btVector3( x, btScalar( 0.01 ), 0 ) - eye ).normalized(); };
	EXPECT_EQ( blade.move( eye, towards( -1 ) ), 0 );
	EXPECT_GT( blade.move( eye, towards( 0 ) ), 0 );
	blade.lift();
	EXPECT_EQ( blade.move( eye, towards( 1 ) ), 0 );
	EXPECT_GT( blade.move( eye, towards( btScalar( -0.1 ) ) ), 0 );
	scene.world.stepSimulation( btScalar( 1 ) / 60, 0 );
	EXPECT_EQ( scene.world.softBodyCount(), 2 );
	scene.world.removeSoftBody( body.value.get() );
}

} // namespace
