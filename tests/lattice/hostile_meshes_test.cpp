// Each hostile mesh gives a valid lattice or a clear error, within 256 MB and a bounded time. The benchmark buildHostileMesh of
// pliant_bench measures the times; the limit below only detects a search whose time has become quadratic.

#include "hostile_meshes.h"
#include "lattice_checks.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <new>

#if defined( __has_feature )
	#if __has_feature( address_sanitizer ) || __has_feature( thread_sanitizer )
		#define PLIANT_TEST_SANITIZED
	#endif
#endif
#if defined( __SANITIZE_ADDRESS__ ) || defined( __SANITIZE_THREAD__ )
	#define PLIANT_TEST_SANITIZED
#endif

namespace {

// For this test: counts every byte that operator new returns, and can fail on demand. Sanitizers have their own operator new.
std::atomic<std::size_t> g_live = 0;
std::atomic<std::size_t> g_peak = 0;
std::atomic<long> g_allocationsLeft = -1;

#ifdef PLIANT_TEST_SANITIZED
constexpr bool kCounts = false;
constexpr double kSecondsAllowed = 30.0;
#else
	#ifdef NDEBUG
constexpr double kSecondsAllowed = 8.0;
	#else
constexpr double kSecondsAllowed = 15.0;
	#endif
constexpr bool kCounts = true;
#endif

constexpr std::size_t kBytesAllowed = std::size_t( 256 ) << 20;

} // namespace

#ifndef PLIANT_TEST_SANITIZED

namespace {

constexpr std::size_t kHeader = 64;

void* allocate( std::size_t size, std::size_t alignment )
{
	if ( g_allocationsLeft >= 0 && g_allocationsLeft-- == 0 )
	{
		g_allocationsLeft = 0;
		throw std::bad_alloc();
	}
	const std::size_t head = std::max( kHeader, alignment );
	char* block = static_cast<char*>( std::aligned_alloc( head, ( size + head + head - 1 ) / head * head ) );
	if ( !block )
	{
		throw std::bad_alloc();
	}
	char* given = block + head;
	std::size_t* note = reinterpret_cast<std::size_t*>( given ) - 2;
	note[0] = size;
	note[1] = head;
	const std::size_t live = g_live += size;
	std::size_t peak = g_peak;
	while ( peak < live && !g_peak.compare_exchange_weak( peak, live ) )
	{}
	return given;
}

void release( void* given )
{
	if ( given )
	{
		const std::size_t* note = static_cast<std::size_t*>( given ) - 2;
		g_live -= note[0];
		std::free( static_cast<char*>( given ) - note[1] );
	}
}

} // namespace

void* operator new( std::size_t size )
{
	return allocate( size, kHeader );
}
void* operator new( std::size_t size, std::align_val_t alignment )
{
	return allocate( size, std::size_t( alignment ) );
}
void operator delete( void* given ) noexcept
{
	release( given );
}
void operator delete( void* given, std::size_t ) noexcept
{
	release( given );
}
void operator delete( void* given, std::align_val_t ) noexcept
{
	release( given );
}
void operator delete( void* given, std::size_t, std::align_val_t ) noexcept
{
	release( given );
}

#endif

namespace pliant::test {

namespace {

class Hostile : public testing::TestWithParam<HostileMesh>
{};

TEST_P( Hostile, GivesABodyOrAClearError )
{
	const HostileMesh& hostile = GetParam();
	const Mesh mesh = hostile.make();
	LatticeSettings settings;
	settings.cellSize = hostile.cellSize;
	settings.shell = hostile.shell;

	g_peak = g_live.load();
	const std::size_t before = g_live;
	// Processor time, because the build runs on this thread alone and a busy machine must not fail the test.
	const std::clock_t start = std::clock();
	const Result<LatticeBuild> result = buildLattice( mesh.view(), settings );
	const double seconds = double( std::clock() - start ) / CLOCKS_PER_SEC;
	const std::size_t bytes = g_peak - before;

	EXPECT_STREQ( toString( result.status.code ), toString( hostile.expected ) ) << result.status.sentence;
	EXPECT_EQ( result.ok(), result.status.sentence.empty() );
	EXPECT_LT( seconds, kSecondsAllowed );
	EXPECT_LT( bytes, kBytesAllowed );
	RecordProperty( "milliseconds", int( 1000.0 * seconds ) );
	RecordProperty( "kilobytes", int( bytes >> 10 ) );
	if ( result.ok() )
	{
		const Status valid = validate( result.value.lattice );
		EXPECT_TRUE( valid.ok() ) << valid.sentence;
		EXPECT_GE( result.value.lattice.cellCount(), 1 );
		EXPECT_LE( result.value.lattice.cellCount(), settings.maxCells );
		EXPECT_EQ( result.value.weldedVertex.size(), mesh.vertexCount() );
	}
	else
	{
		EXPECT_EQ( result.value.lattice.cellCount(), 0 );
	}
	std::printf( "%-45s %-17s %7.1f ms %8.1f MB %7d cells\n", hostile.name.c_str(), toString( result.status.code ), 1000.0 * seconds,
		double( bytes ) / ( 1 << 20 ), result.value.lattice.cellCount() );
}

INSTANTIATE_TEST_SUITE_P( Corpus, Hostile, testing::ValuesIn( hostileMeshes() ), []( const testing::TestParamInfo<HostileMesh>& hostile ) {
	std::string name = hostile.param.name;
	std::replace_if(
		name.begin(), name.end(), []( char c ) { return !std::isalnum( static_cast<unsigned char>( c ) ); }, '_' );
	return name;
} );

TEST( HostileViews, MissingArraysAreRefused )
{
	const Mesh mesh = makeBox( { 0, 0, 0 }, { 1, 1, 1 } );
	MeshView view = mesh.view();
	view.positions = nullptr;
	EXPECT_EQ( buildLattice( view, {} ).status.code, ResultCode::BadArgument );
	view = mesh.view();
	view.indices = nullptr;
	EXPECT_EQ( buildLattice( view, {} ).status.code, ResultCode::BadArgument );
	view = mesh.view();
	view.positionStride = 2;
	EXPECT_EQ( buildLattice( view, {} ).status.code, ResultCode::BadArgument );
	// More triangles than the array has: refused by their number, before any is read.
	view = mesh.view();
	view.triangleCount = std::size_t( 1 ) << 60;
	EXPECT_EQ( buildLattice( view, {} ).status.code, ResultCode::TooManyTriangles );
	view = mesh.view();
	view.vertexCount = std::size_t( 1 ) << 60;
	EXPECT_EQ( buildLattice( view, {} ).status.code, ResultCode::TooManyTriangles );
	EXPECT_EQ( buildLattice( MeshView(), {} ).status.code, ResultCode::EmptyMesh );
}

TEST( HostileViews, StrideIsKept )
{
	const Mesh mesh = makeBox( { 0, 0, 0 }, { 1, 1, 1 } );
	std::vector<float> wide( 5 * mesh.vertexCount(), 1e9f );
	for ( std::size_t i = 0; i < mesh.vertexCount(); ++i )
	{
		std::copy_n( &mesh.positions[3 * i], 3, &wide[5 * i] );
	}
	MeshView view = mesh.view();
	view.positions = wide.data();
	view.positionStride = 5;
	const Result<LatticeBuild> result = buildLattice( view, cellsOf( 0.25f ) );
	ASSERT_TRUE( result.ok() );
	EXPECT_EQ( result.value.lattice.cellCount(), 64 );
}

TEST( Memory, RunningOutAtAnyAllocationIsAnAnswer )
{
	if ( !kCounts )
	{
		GTEST_SKIP() << "the sanitizer has its own operator new";
	}
	const Mesh mesh = without( makeSphere( 1.0, 8, 12 ), []( std::size_t t ) { return t < 3; } );
	const std::size_t before = g_live;
	int refused = 0;
	for ( long n = 0; n < 2000; n += 1 + n / 20 )
	{
		g_allocationsLeft = n;
		{
			const Result<LatticeBuild> result = [&]() {
				try
				{
					return buildLattice( mesh.view(), cellsOf( 0.25f ) );
				}
				catch ( const std::bad_alloc& )
				{
					g_allocationsLeft = -1;
					ADD_FAILURE() << "an exception got out at allocation " << n;
					return Result<LatticeBuild>();
				}
			}();
			g_allocationsLeft = -1;
			refused += result.status.code == ResultCode::OutOfMemory;
			EXPECT_TRUE( result.ok() || result.status.code == ResultCode::OutOfMemory ) << n;
		}
		EXPECT_EQ( g_live, before ) << "leak at allocation " << n;
	}
	EXPECT_GT( refused, 10 );
}

} // namespace

} // namespace pliant::test
