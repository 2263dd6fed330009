// A snapshot as a chunk of a .bullet file. Bullet's importer skips chunks whose codes it does not know.

#include "pliant/io/snapshot.h"
#include "world/io/snapshot_format.h"

#include <LinearMath/btSerializer.h>

#include <algorithm>

namespace pliant {

namespace {

constexpr int kChunkCode = BT_MAKE_ID( 'P', 'L', 'N', 'T' );
/// Bullet's readers take chunks to begin at multiples of this, bytes.
constexpr std::size_t kChunkUnit = 16;

/// Passes everything on to a serializer, and adds one chunk at the end: the world's `serialize` both begins and ends the file.
class AddingSerializer : public btSerializer
{
public:
	AddingSerializer( btSerializer& to, const std::vector<std::byte>& bytes ) : m_to( to ), m_bytes( bytes ) {}

	void finishSerialization() override
	{
		const std::size_t length = ( m_bytes.size() + kChunkUnit - 1 ) / kChunkUnit * kChunkUnit;
		btChunk* const chunk = m_to.allocate( 1, int( length ) );
		std::memset( chunk->m_oldPtr, 0, length );
		std::memcpy( chunk->m_oldPtr, m_bytes.data(), m_bytes.size() );
		m_to.finalizeChunk( chunk, "char", kChunkCode, const_cast<std::byte*>( m_bytes.data() ) );
		m_to.finishSerialization();
	}

	const unsigned char* getBufferPointer() const override { return m_to.getBufferPointer(); }
	int getCurrentBufferSize() const override { return m_to.getCurrentBufferSize(); }
	btChunk* allocate( std::size_t size, int count ) override { return m_to.allocate( size, count ); }
	void finalizeChunk( btChunk* chunk, const char* type, int code, void* pointer ) override
	{
		m_to.finalizeChunk( chunk, type, code, pointer );
	}
	void* findPointer( void* pointer ) override { return m_to.findPointer( pointer ); }
	void* getUniquePointer( void* pointer ) override { return m_to.getUniquePointer( pointer ); }
	void startSerialization() override { m_to.startSerialization(); }
	const char* findNameForPointer( const void* pointer ) const override { return m_to.findNameForPointer( pointer ); }
	void registerNameForPointer( const void* pointer, const char* name ) override { m_to.registerNameForPointer( pointer, name ); }
	void serializeName( const char* name ) override { m_to.serializeName( name ); }
	int getSerializationFlags() const override { return m_to.getSerializationFlags(); }
	void setSerializationFlags( int flags ) override { m_to.setSerializationFlags( flags ); }
	int getNumChunks() const override { return m_to.getNumChunks(); }
	const btChunk* getChunk( int index ) const override { return m_to.getChunk( index ); }

private:
	btSerializer& m_to;
	const std::vector<std::byte>& m_bytes;
};

constexpr std::size_t kFileHeader = 12; // "BULLET", precision, size of pointers, order of bytes, version

int numberAt( BytesView file, std::size_t at )
{
	int number = 0;
	std::memcpy( &number, file.data + at, sizeof( number ) );
	return number;
}

} // namespace

Status saveBulletFile( SoftBodyHost& world, btSerializer& serializer, const SaveSettings& settings )
{
	std::vector<std::byte> bytes;
	if ( Status status = saveWorld( world, bytes, settings ); !status.ok() )
	{
		return status;
	}
	AddingSerializer adding( serializer, bytes );
	world.bulletWorld().serialize( &adding );
	return {};
}

Result<BytesView> snapshotInBulletFile( BytesView file )
{
	using Answer = Result<BytesView>;
	if ( !file.data || file.size < kFileHeader || std::memcmp( file.data, "BULLET", 6 ) != 0 )
	{
		return Answer::failure( ResultCode::BadSnapshot, "The data is no .bullet file." );
	}
	if ( file.data[8] != std::byte( 'v' ) )
	{
		return Answer::failure( ResultCode::BadSnapshot, "The .bullet file was written with the bytes of numbers in the other order." );
	}
	// A chunk begins with its code, its length, a pointer and two numbers.
	const std::size_t header = 4 * sizeof( int ) + ( file.data[7] == std::byte( '-' ) ? 8 : 4 );
	std::size_t at = kFileHeader;
	while ( file.size - at >= header )
	{
		const int code = numberAt( file, at ), length = numberAt( file, at + sizeof( int ) );
		at += header;
		if ( length < 0 || std::size_t( length ) > file.size - at )
		{
			break;
		}
		if ( code == kChunkCode )
		{
			const BytesView chunk( file.data + at, std::size_t( length ) );
			return Answer::success( BytesView( chunk.data, std::min( chunk.size, snapshotSize( chunk ) ) ) );
		}
		at += std::size_t( length );
	}
	return Answer::failure( ResultCode::BadSnapshot, "The .bullet file has no soft bodies." );
}

} // namespace pliant
