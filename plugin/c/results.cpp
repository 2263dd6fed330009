#include "c/call.h"

#include "c/handles.h"
#include "pliant/build.h"
#include "pliant/version.h"

#include <string>

namespace pliant::c {

namespace {

thread_local std::string lastSentence;
thread_local bool hasLostSentence = false; ///< there was no memory for it

// The values are the same on both faces.
static_assert( int( ResultCode::Ok ) == PLIANT_OK && int( ResultCode::EmptyMesh ) == PLIANT_EMPTY_MESH &&
	int( ResultCode::NonFiniteVertex ) == PLIANT_NON_FINITE_VERTEX && int( ResultCode::IndexOutOfRange ) == PLIANT_INDEX_OUT_OF_RANGE &&
	int( ResultCode::ExtentOutOfRange ) == PLIANT_EXTENT_OUT_OF_RANGE && int( ResultCode::ZeroVolume ) == PLIANT_ZERO_VOLUME &&
	int( ResultCode::TooManyTriangles ) == PLIANT_TOO_MANY_TRIANGLES && int( ResultCode::TooManyCells ) == PLIANT_TOO_MANY_CELLS &&
	int( ResultCode::OutOfMemory ) == PLIANT_OUT_OF_MEMORY && int( ResultCode::Cancelled ) == PLIANT_CANCELLED &&
	int( ResultCode::BadSettings ) == PLIANT_BAD_SETTINGS && int( ResultCode::BadMaterial ) == PLIANT_BAD_MATERIAL &&
	int( ResultCode::BadArgument ) == PLIANT_BAD_ARGUMENT && int( ResultCode::TooFolded ) == PLIANT_TOO_FOLDED &&
	int( ResultCode::BadSnapshot ) == PLIANT_BAD_SNAPSHOT );
static_assert( int( Feature::Fracture ) == PLIANT_FEATURE_FRACTURE && int( Feature::Levels ) == PLIANT_FEATURE_LEVELS &&
	int( Feature::Plasticity ) == PLIANT_FEATURE_PLASTICITY && int( Feature::Surface ) == PLIANT_FEATURE_SURFACE &&
	int( Feature::FarLevels ) == PLIANT_FEATURE_FAR_LEVELS && int( Feature::Clusters ) == PLIANT_FEATURE_CLUSTERS &&
	int( Feature::SelfCollision ) == PLIANT_FEATURE_SELF_COLLISION && kFeatureCount == PLIANT_FEATURE_SELF_COLLISION + 1 );

} // namespace

pliant_result refuse( pliant_result code, const char* sentence ) noexcept
{
	try
	{
		lastSentence = sentence;
		hasLostSentence = false;
	}
	catch ( ... )
	{
		hasLostSentence = true;
	}
	return code;
}

pliant_result resultOf( const Status& status ) noexcept
{
	return status.ok() ? PLIANT_OK : refuse( pliant_result( status.code ), status.sentence.c_str() );
}

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

const char* pliant_last_error( void )
{
	return hasLostSentence ? "Memory did not suffice." : lastSentence.c_str();
}

const char* pliant_result_name( pliant_result result )
{
	return result == PLIANT_NO_SUCH_OBJECT ? "NoSuchObject" : toString( ResultCode( result ) );
}

uint32_t pliant_version( void )
{
	return PLIANT_VERSION_MAJOR << 16 | PLIANT_VERSION_MINOR << 8 | PLIANT_VERSION_PATCH;
}

int32_t pliant_has_feature( int32_t feature )
{
	return hasFeature( Feature( feature ) ) ? 1 : 0;
}

int32_t pliant_bullet_scalar_size( void )
{
	return int32_t( sizeof( btScalar ) );
}

pliant_result pliant_buffer_create( pliant_buffer** buffer )
{
	return call( [&]() {
		requirePointers( buffer );
		*buffer = new pliant_buffer;
	} );
}

const void* pliant_buffer_data( const pliant_buffer* buffer )
{
	return buffer && !buffer->bytes.empty() ? buffer->bytes.data() : nullptr;
}

uint64_t pliant_buffer_size( const pliant_buffer* buffer )
{
	return buffer ? buffer->bytes.size() : 0;
}

void pliant_buffer_destroy( pliant_buffer* buffer )
{
	delete buffer;
}
