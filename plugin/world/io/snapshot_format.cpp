#include "world/io/snapshot_format.h"

#include <LinearMath/btScalar.h>

#include <chrono>
#include <random>

namespace pliant {

namespace {

constexpr char kMagic[8] = { 'P', 'l', 'i', 'a', 'n', 't', 'S', 'n' };
/// Increases with every change of the stored format.
constexpr std::uint32_t kFormat = 14;

struct Header
{
	char magic[8] = {};
	std::uint32_t format = kFormat;
	std::uint16_t kind = 0;
	std::uint16_t scalarBytes = 0; ///< of Bullet's numbers; 0: there are none
	std::uint64_t size = 0;        ///< of the content
	std::uint64_t checksum = 0;    ///< of the content and of the fields above
	std::uint64_t origin = 0;      ///< the checksum, mixed with a number that only the writing process knows
};
static_assert( sizeof( Header ) == 40 );

std::uint64_t checksumOf( const Header& header, const std::byte* content )
{
	const std::uint64_t start = hashOf( reinterpret_cast<const std::byte*>( &header ), offsetof( Header, checksum ) );
	return hashOf( content, std::size_t( header.size ), start );
}

std::uint64_t originOf( std::uint64_t checksum )
{
	static const std::uint64_t key = [] {
		std::random_device random;
		const auto now = std::uint64_t( std::chrono::steady_clock::now().time_since_epoch().count() );
		return ( std::uint64_t( random() ) << 32 | random() ) ^ now;
	}();
	return hashOf( reinterpret_cast<const std::byte*>( &checksum ), sizeof( checksum ), key );
}

std::uint16_t scalarBytesOf( SnapshotKind kind )
{
	return kind == SnapshotKind::Template ? 0 : std::uint16_t( sizeof( btScalar ) );
}

/// The error in the frame; null: none.
const char* problemOf( const Header& header, BytesView bytes, SnapshotKind kind )
{
	if ( std::memcmp( header.magic, kMagic, sizeof( kMagic ) ) != 0 )
	{
		return "The data is no snapshot.";
	}
	if ( header.format > kFormat )
	{
		return "The snapshot comes from a newer version of the library.";
	}
	if ( header.format != kFormat )
	{
		return "The snapshot's version is unknown.";
	}
	if ( header.size != bytes.size - sizeof( Header ) )
	{
		return "The snapshot is cut off, or something follows it.";
	}
	if ( checksumOf( header, bytes.data + sizeof( Header ) ) != header.checksum )
	{
		return "The snapshot is damaged: its checksum does not match.";
	}
	if ( header.kind != std::uint16_t( kind ) )
	{
		return "The snapshot is of another kind: of a template, a body or a world.";
	}
	return header.scalarBytes == scalarBytesOf( kind ) ? nullptr : "The snapshot comes from a build with Bullet's other precision.";
}

} // namespace

Archive beginSnapshot( std::vector<std::byte>& bytes )
{
	Archive archive( bytes );
	std::memset( archive.extend( sizeof( Header ) ), 0, sizeof( Header ) );
	return archive;
}

void endSnapshot( std::vector<std::byte>& bytes, SnapshotKind kind )
{
	Header header;
	std::memcpy( header.magic, kMagic, sizeof( kMagic ) );
	header.kind = std::uint16_t( kind );
	header.scalarBytes = scalarBytesOf( kind );
	header.size = bytes.size() - sizeof( Header );
	header.checksum = checksumOf( header, bytes.data() + sizeof( Header ) );
	header.origin = originOf( header.checksum );
	std::memcpy( bytes.data(), &header, sizeof( Header ) );
}

Archive openSnapshot( BytesView bytes, SnapshotKind kind )
{
	if ( !bytes.data || bytes.size < sizeof( Header ) )
	{
		Archive none( nullptr, std::size_t( 0 ) );
		none.refuse( "The data is no snapshot: it is too short." );
		return none;
	}
	Header header;
	std::memcpy( &header, bytes.data, sizeof( Header ) );
	Archive archive( bytes.data + sizeof( Header ), bytes.size - sizeof( Header ) );
	if ( const char* const problem = problemOf( header, bytes, kind ) )
	{
		archive.refuse( problem );
	}
	else if ( header.origin == originOf( header.checksum ) )
	{
		archive.trust();
	}
	return archive;
}

std::size_t snapshotSize( BytesView bytes )
{
	Header header;
	if ( bytes.size < sizeof( Header ) )
	{
		return 0;
	}
	std::memcpy( &header, bytes.data, sizeof( Header ) );
	return header.size < bytes.size ? sizeof( Header ) + std::size_t( header.size ) : bytes.size;
}

Status refusalOf( const Archive& archive )
{
	return Status{ ResultCode::BadSnapshot, archive.problem() ? archive.problem() : "The snapshot has more data than it needs." };
}

} // namespace pliant
