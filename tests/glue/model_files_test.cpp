// Model files: written files are read back unchanged, and no file, however damaged, crashes the reader.

#include "third_party_glue/assimp_mesh.h"
#include "third_party_glue/off_reader.h"
#include "third_party_glue/ply_reader.h"
#include "third_party_glue/primitives.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <thread>

using namespace pliant_glue;
namespace fs = std::filesystem;

namespace {

/// A folder for each test, deleted afterwards.
class ModelFiles : public ::testing::Test
{
protected:
	void SetUp() override
	{
		const ::testing::TestInfo* test = ::testing::UnitTest::GetInstance()->current_test_info();
		std::string name = std::string( test->test_suite_name() ) + "-" + test->name();
		std::replace( name.begin(), name.end(), '/', '-' );
		m_folder = fs::temp_directory_path() / ( "pliant-" + name + "-" + std::to_string( std::random_device()() ) );
		fs::create_directories( m_folder );
	}
	void TearDown() override { fs::remove_all( m_folder ); }

	std::string path( const std::string& name ) const { return ( m_folder / name ).string(); }

	std::string write( const std::string& name, const std::string& bytes ) const
	{
		std::ofstream( path( name ), std::ios::binary ) << bytes;
		return path( name );
	}

	static std::string bytesOf( const std::string& file )
	{
		std::ostringstream text;
		text << std::ifstream( file, std::ios::binary ).rdbuf();
		return text.str();
	}

private:
	fs::path m_folder;
};

ModelMesh ball( const std::string& name, float x )
{
	Primitive shape = unitSphere( 2 );
	ModelMesh mesh;
	mesh.name = name;
	mesh.positions = std::move( shape.positions );
	mesh.normals = std::move( shape.normals );
	mesh.indices = std::move( shape.indices );
	for ( std::size_t i = 0; i < mesh.positions.size(); i += 3 )
	{
		mesh.textureCoordinates.insert( mesh.textureCoordinates.end(), { mesh.positions[i] + 0.5f, mesh.positions[i + 1] + 0.5f } );
		mesh.positions[i] += x;
	}
	return mesh;
}

/// Signed volume by the divergence theorem: right only when no triangle is lost, doubled or turned over.
double volume( const ModelMesh& mesh )
{
	double sum = 0;
	for ( std::size_t t = 0; t < mesh.indices.size(); t += 3 )
	{
		const float* a = &mesh.positions[3 * mesh.indices[t]];
		const float* b = &mesh.positions[3 * mesh.indices[t + 1]];
		const float* c = &mesh.positions[3 * mesh.indices[t + 2]];
		sum += double( a[0] ) * ( double( b[1] ) * c[2] - double( b[2] ) * c[1] ) +
			double( a[1] ) * ( double( b[2] ) * c[0] - double( b[0] ) * c[2] ) +
			double( a[2] ) * ( double( b[0] ) * c[1] - double( b[1] ) * c[0] );
	}
	return sum / 6;
}

const char* const kCubeOff = "OFF # a cube of edge 1\n"
							 "# two comment lines\n"
							 "8 6 12\n"
							 "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
							 "# in the middle of the vertices\n"
							 "0 0 1\n1 0 1\n1 1 1\n0 1 1\n"
							 "4 3 2 1 0 # first face\n"
							 "# between faces\n"
							 "4 4 5 6 7 255 0 0\n"
							 "4 0 1 5 4\n"
							 "# and again\n"
							 "4 2 3 7 6\n4 1 2 6 5\n4 0 4 7 3\n";

class RoundTrip : public ModelFiles, public ::testing::WithParamInterface<const char*>
{};

TEST_P( RoundTrip, KeepsTrianglesAndVolume )
{
	const ModelMesh out = ball( "ball", 0.0f );
	const std::string file = path( std::string( "ball." ) + GetParam() );
	const FileStatus written = writeModel( file, { out } );
	ASSERT_TRUE( written.ok() ) << written.sentence;

	const ReadResult in = readModel( file );
	ASSERT_TRUE( in.ok() ) << in.status.sentence;
	EXPECT_EQ( in.mesh.triangleCount(), out.triangleCount() );
	EXPECT_EQ( in.mesh.submeshOfTriangle.size(), out.triangleCount() );
	EXPECT_EQ( in.mesh.name, "ball" );
	EXPECT_GT( volume( out ), 0.5 );
	EXPECT_NEAR( volume( in.mesh ), volume( out ), 1e-4 );
}

TEST_P( RoundTrip, KeepsSeveralMeshes )
{
	const std::string file = path( std::string( "two." ) + GetParam() );
	const FileStatus written = writeModel( file, { ball( "left", -2.0f ), ball( "right", 2.0f ) } );
	ASSERT_TRUE( written.ok() ) << written.sentence;
	const ReadResult in = readModel( file );
	ASSERT_TRUE( in.ok() ) << in.status.sentence;
	EXPECT_EQ( in.mesh.triangleCount(), 2 * ball( "one", 0 ).triangleCount() );
	EXPECT_NEAR( volume( in.mesh ), 2 * volume( ball( "one", 0 ) ), 1e-3 );
	const std::string format = GetParam();
	if ( format != "ply" && format != "stl" ) // these formats have a single mesh
	{
		ASSERT_EQ( in.mesh.submeshNames.size(), 2u );
		EXPECT_NE( in.mesh.submeshNames[0], in.mesh.submeshNames[1] );
		EXPECT_EQ( in.mesh.submeshOfTriangle.front(), 0u );
		EXPECT_EQ( in.mesh.submeshOfTriangle.back(), 1u );
	}
}

TEST_P( RoundTrip, TruncatedAnywhereIsReadOrRefused )
{
	const std::string file = path( std::string( "whole." ) + GetParam() );
	ASSERT_TRUE( writeModel( file, { ball( "ball", 0 ) } ).ok() );
	const std::string bytes = bytesOf( file );
	int refused = 0;
	for ( int eighth = 0; eighth < 8; ++eighth )
	{
		const std::string cut = write( std::string( "cut." ) + GetParam(), bytes.substr( 0, bytes.size() * std::size_t( eighth ) / 8 ) );
		const ReadResult in = readModel( cut );
		refused += in.ok() ? 0 : 1;
		EXPECT_EQ( in.ok(), in.status.sentence.empty() );
		for ( const std::uint32_t index : in.mesh.indices )
		{
			ASSERT_LT( index, in.mesh.vertexCount() );
		}
	}
	EXPECT_GE( refused, 1 ); // at the least the empty file
}

INSTANTIATE_TEST_SUITE_P( Formats, RoundTrip, ::testing::Values( "obj", "ply", "glb", "gltf", "stl" ) );

TEST_F( ModelFiles, TextureCoordinatesSurviveObj )
{
	ASSERT_TRUE( writeModel( path( "uv.obj" ), { ball( "ball", 0 ) } ).ok() );
	const ReadResult in = readModel( path( "uv.obj" ) );
	ASSERT_TRUE( in.ok() ) << in.status.sentence;
	ASSERT_EQ( in.mesh.textureCoordinates.size(), in.mesh.vertexCount() * 2 );
	for ( std::size_t i = 0; i < in.mesh.vertexCount(); ++i )
	{
		EXPECT_NEAR( in.mesh.textureCoordinates[i * 2], in.mesh.positions[i * 3] + 0.5f, 1e-4f );
	}
}

TEST_F( ModelFiles, OffKeepsEveryFaceBesideComments )
{
	const ReadResult in = readModel( write( "cube.off", kCubeOff ) );
	ASSERT_TRUE( in.ok() ) << in.status.sentence;
	EXPECT_EQ( in.mesh.vertexCount(), 8u );
	EXPECT_EQ( in.mesh.triangleCount(), 12u );
	EXPECT_NEAR( volume( in.mesh ), 1.0, 1e-6 );
}

TEST( Off, ReadsColoursNormalsAndTexture )
{
	const ReadResult colours = readOff( "COFF 3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 255\n0 1 0 0 0 255 255\n3 0 1 2\n" );
	ASSERT_TRUE( colours.ok() ) << colours.status.sentence;
	EXPECT_EQ( colours.mesh.positions, ( std::vector<float>{ 0, 0, 0, 1, 0, 0, 0, 1, 0 } ) );

	const ReadResult all = readOff(
		"STCNOFF\r\n3 1 3\r\n0 0 0 0 0 1 9 9 9 .25 .5\r\n1 0 0 0 0 1 9 9 9 1 0\r\n0 1 0 0 0 1 9 9 9 0 1\r\n3 0 1 2\r\n" );
	ASSERT_TRUE( all.ok() ) << all.status.sentence;
	EXPECT_EQ( all.mesh.normals, ( std::vector<float>{ 0, 0, 1, 0, 0, 1, 0, 0, 1 } ) );
	EXPECT_EQ( all.mesh.textureCoordinates, ( std::vector<float>{ .25f, .5f, 1, 0, 0, 1 } ) );
}

TEST( Off, RefusesWhatIsNotThere )
{
	const char* const wrong[] = { "", "OFF", "OFF\n", "OFF\n3", "OFF\n-3 1 0\n0 0 0\n", "PLY\n3 1 0\n", "4OFF\n3 1 0\n", "OFF BINARY\n",
		"# only\n#comments\n", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n",
		"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n", "OFF\n3 1 0\n0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n",
		"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n999999999999 0 1 2\n", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n",
		"OFF\n1000000000 1000000000 0\n0 0 0\n", "OFF\n99999999999999999999999 1 0\n" };
	for ( const char* text : wrong )
	{
		const ReadResult in = readOff( text );
		EXPECT_FALSE( in.ok() ) << text;
		EXPECT_FALSE( in.status.sentence.empty() ) << text;
	}
}

TEST( Ply, ReadsTextAndBothByteOrders )
{
	const std::string elements =
		"comment made by hand\nelement vertex 3\nproperty float x\nproperty double y\nproperty short z\nproperty uchar red\n"
		"element face 1\nproperty list uchar int vertex_indices\nproperty list char float weights\nend_header\n";
	const std::vector<float> expected = { 0, 0, 0, 1, 0, -2, 0, 1, 3 };
	const ReadResult text = readPly( "ply\r\nformat ascii 1.0\r\n" + elements + "0 0 0 255\n1 0 -2 255\n0 +1 3e0 255\n3 0 1 2 1 .5\n" );
	ASSERT_TRUE( text.ok() ) << text.status.sentence;
	EXPECT_EQ( text.mesh.positions, expected );
	EXPECT_EQ( text.mesh.indices, ( std::vector<std::uint32_t>{ 0, 1, 2 } ) );

	for ( const bool isBig : { false, true } )
	{
		std::string bytes;
		const auto put = [&]( auto value ) {
			char raw[sizeof( value )];
			std::memcpy( raw, &value, sizeof( value ) ); // little-endian, the byte order of every machine that runs these tests
			bytes += isBig ? std::string( std::reverse_iterator( raw + sizeof( value ) ), std::reverse_iterator( raw ) )
						   : std::string( raw, sizeof( value ) );
		};
		for ( std::size_t i = 0; i < 9; i += 3 )
		{
			put( expected[i] );
			put( double( expected[i + 1] ) );
			put( std::int16_t( expected[i + 2] ) );
			put( std::uint8_t( 255 ) );
		}
		put( std::uint8_t( 3 ) );
		for ( const std::int32_t corner : { 0, 1, 2 } )
		{
			put( corner );
		}
		put( std::int8_t( 1 ) );
		put( 0.5f );
		std::string header = "ply\nformat ";
		header += isBig ? "binary_big_endian" : "binary_little_endian";
		header += " 1.0\n";
		const ReadResult binary = readPly( header + elements + bytes );
		ASSERT_TRUE( binary.ok() ) << binary.status.sentence;
		EXPECT_EQ( binary.mesh.positions, expected );
		EXPECT_EQ( binary.mesh.indices, ( std::vector<std::uint32_t>{ 0, 1, 2 } ) );
		EXPECT_FALSE( readPly( header + elements + bytes.substr( 0, bytes.size() - 1 ) ).ok() );
	}
}

/// A few bytes of a valid file changed or removed.
std::string damage( const std::string& good, std::mt19937& random )
{
	std::string bytes = good;
	for ( unsigned k = 0; k < 1 + random() % 8 && !bytes.empty(); ++k )
	{
		const std::size_t at = random() % ( random() % 3 == 0 ? std::min<std::size_t>( bytes.size(), 300 ) : bytes.size() );
		switch ( random() % 3 )
		{
			case 0: bytes[at] = char( random() & 0xff ); break;
			case 1: bytes[at] = "0123456789-."[random() % 12]; break;
			default: bytes.erase( at, 1 + random() % 5 ); break;
		}
	}
	return bytes;
}

TEST_F( ModelFiles, DamagedPlyAndOffAreReadOrRefused )
{
	ASSERT_TRUE( writeModel( path( "ball.ply" ), { ball( "ball", 0 ) } ).ok() );
	const std::string ply = bytesOf( path( "ball.ply" ) );
	ASSERT_TRUE( readPly( ply ).ok() );
	std::mt19937 random( 11 );
	int good = 0;
	for ( int i = 0; i < 4000; ++i )
	{
		const bool isPly = i % 2 == 0;
		const ReadResult in = isPly ? readPly( damage( ply, random ) ) : readOff( damage( kCubeOff, random ) );
		good += in.ok() ? 1 : 0;
		ASSERT_EQ( in.ok(), in.status.sentence.empty() );
		for ( const std::uint32_t index : in.mesh.indices )
		{
			ASSERT_TRUE( !in.ok() || index < in.mesh.vertexCount() );
		}
	}
	EXPECT_GT( good, 0 );
	EXPECT_LT( good, 4000 );
}

TEST_F( ModelFiles, MissingEmptyAndFolder )
{
	EXPECT_EQ( readModel( path( "nowhere.obj" ) ).status.code, FileCode::NotFound );
	EXPECT_EQ( readModel( write( "empty.obj", "" ) ).status.code, FileCode::Unreadable );
	fs::create_directories( path( "folder.obj" ) );
	EXPECT_EQ( readModel( path( "folder.obj" ) ).status.code, FileCode::Unreadable );
	const ReadResult missing = readModel( path( "nowhere.obj" ) );
	EXPECT_NE( missing.status.sentence.find( "nowhere.obj" ), std::string::npos );
}

TEST_F( ModelFiles, GarbageUnderEveryName )
{
	std::mt19937 random( 7 );
	std::string bytes( 20000, '\0' );
	for ( char& byte : bytes )
	{
		byte = char( random() & 0xff );
	}
	for ( const char* ending : { "obj", "ply", "stl", "glb", "gltf", "off", "fbx", "dae", "3ds", "blend", "x", "raw", "nothing" } )
	{
		const ReadResult in = readModel( write( std::string( "garbage." ) + ending, bytes ) );
		EXPECT_FALSE( in.ok() && !in.mesh.indices.empty() &&
			std::any_of( in.mesh.positions.begin(), in.mesh.positions.end(), []( float x ) { return !std::isfinite( x ); } ) )
			<< ending;
		EXPECT_EQ( in.ok(), in.status.sentence.empty() ) << ending;
	}
}

TEST_F( ModelFiles, HeaderThatPromisesAGigabyteIsRefusedAtOnce )
{
	const auto begin = std::chrono::steady_clock::now();
	const std::string ply =
		"ply\nformat binary_little_endian 1.0\nelement vertex 90000000\nproperty float x\nproperty float y\nproperty float z\n"
		"element face 1\nproperty list uchar int vertex_indices\nend_header\n";
	EXPECT_FALSE( readModel( write( "promise.ply", ply + std::string( 100, '\1' ) ) ).ok() );
	EXPECT_FALSE( readModel( write( "promise.off", "OFF\n90000000 90000000 0\n0 0 0\n" ) ).ok() );
	std::string stl( 84, '\0' );
	stl[80] = stl[81] = stl[82] = '\xff';
	EXPECT_FALSE( readModel( write( "promise.stl", stl + std::string( 50, '\0' ) ) ).ok() );
	std::string glb = "glTF";
	for ( const unsigned word : { 2u, 0x3fffffffu, 0x3ffffff0u, 0x4e4f534au } )
	{
		for ( int byte = 0; byte < 4; ++byte )
		{
			glb += char( word >> ( 8 * byte ) & 0xff );
		}
	}
	EXPECT_FALSE( readModel( write( "promise.glb", glb + "{}" ) ).ok() );
	EXPECT_LT( std::chrono::duration<double>( std::chrono::steady_clock::now() - begin ).count(), 2.0 );
}

TEST_F( ModelFiles, LimitsHold )
{
	ASSERT_TRUE( writeModel( path( "ball.obj" ), { ball( "ball", 0 ) } ).ok() );
	ReadLimits limits;
	limits.fileBytes = 1000;
	EXPECT_EQ( readModel( path( "ball.obj" ), limits ).status.code, FileCode::TooLarge );
	limits = {};
	limits.vertices = 50;
	EXPECT_EQ( readModel( path( "ball.obj" ), limits ).status.code, FileCode::TooLarge );
	EXPECT_EQ( readModel( write( "cube.off", kCubeOff ), { 1000, 7, 1.0 } ).status.code, FileCode::TooLarge );
}

TEST_F( ModelFiles, TimeLimitHolds )
{
	// Reading it takes far longer than a thousandth of a second.
	std::ostringstream text;
	for ( int i = 0; i < 40000; ++i )
	{
		text << "v " << i << " " << i % 7 << " " << i % 11 << "\n";
	}
	for ( int i = 1; i + 2 < 40000; ++i )
	{
		text << "f " << i << " " << i + 1 << " " << i + 2 << "\n";
	}
	ReadLimits limits;
	limits.seconds = 0.001;
	const std::string file = write( "long.obj", text.str() );
	const auto begin = std::chrono::steady_clock::now();
	const ReadResult in = readModel( file, limits );
	EXPECT_EQ( in.status.code, FileCode::TimeLimit ) << in.status.sentence;
	EXPECT_LT( std::chrono::duration<double>( std::chrono::steady_clock::now() - begin ).count(), 1.0 );
	// The abandoned read needs the file's folder and assimp's statics until it ends.
	std::this_thread::sleep_for( std::chrono::milliseconds( 700 ) );
}

TEST_F( ModelFiles, NumbersThatAreNone )
{
	EXPECT_FALSE( readModel( write( "nan.off", "OFF\n3 1 0\nnan 0 0\n1 0 0\n0 1 0\n3 0 1 2\n" ) ).ok() );
	EXPECT_FALSE( readModel( write( "inf.obj", "v inf 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n" ) ).ok() );
}

TEST_F( ModelFiles, WritingSaysWhyNot )
{
	const std::vector<ModelMesh> good = { ball( "ball", 0 ) };
	EXPECT_EQ( writeModel( path( "ball.docx" ), good ).code, FileCode::NotWritten );
	EXPECT_EQ( writeModel( path( "no/such/folder/ball.obj" ), good ).code, FileCode::NotWritten );
	EXPECT_EQ( writeModel( path( "ball.obj" ), {} ).code, FileCode::NotWritten );
	ModelMesh wild = ball( "wild", 0 );
	wild.indices[5] = 1000000;
	EXPECT_EQ( writeModel( path( "ball.obj" ), { wild } ).code, FileCode::NotWritten );
	EXPECT_FALSE( fs::exists( path( "ball.obj" ) ) );
}

} // namespace
