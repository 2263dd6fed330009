// +-----------------------------------------------------------------------------------------------------------------+
// | Reads INRIMAGE-4: a header of lines NAME=VALUE, filled up to whole blocks of 256 bytes and closed by ##}, then    |
// | the voxels. Written because assimp knows meshes only.                                                            |
// +-----------------------------------------------------------------------------------------------------------------+

#include "third_party_glue/inr_reader.h"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

namespace pliant_glue {

namespace {

constexpr std::string_view kMagic = "#INRIMAGE-4#{";
constexpr std::string_view kEnd = "##}";
constexpr std::size_t kBlock = 256;     // bytes
constexpr std::size_t kMostBlocks = 64; // of a header

using Header = std::map<std::string, std::string, std::less<>>;

VolumeResult refuse( const std::string& what )
{
	return VolumeResult::failure( FileCode::Unreadable, "INR file: " + what + "." );
}

/// Length of the header in bytes; 0 where it does not end.
std::size_t headerLength( std::string_view bytes )
{
	for ( std::size_t length = kBlock; length <= bytes.size() && length <= kMostBlocks * kBlock; length += kBlock )
	{
		const std::string_view tail = bytes.substr( length - kEnd.size() - 1, kEnd.size() );
		if ( tail == kEnd )
		{
			return length;
		}
	}
	return 0;
}

Header readHeader( std::string_view text )
{
	Header header;
	while ( !text.empty() )
	{
		const std::size_t end = text.find( '\n' );
		const std::string_view line = text.substr( 0, end );
		text = end == std::string_view::npos ? std::string_view() : text.substr( end + 1 );
		if ( const std::size_t equals = line.find( '=' ); equals != std::string_view::npos )
		{
			header.emplace( std::string( line.substr( 0, equals ) ), std::string( line.substr( equals + 1 ) ) );
		}
	}
	return header;
}

template <class Number>
bool number( const Header& header, std::string_view name, Number& value )
{
	const auto found = header.find( name );
	if ( found == header.end() )
	{
		return false;
	}
	const std::string& text = found->second;
	return std::from_chars( text.data(), text.data() + text.size(), value ).ec == std::errc();
}

std::string textOf( const Header& header, std::string_view name )
{
	const auto found = header.find( name );
	return found == header.end() ? std::string() : found->second.substr( 0, found->second.find_last_not_of( " \r" ) + 1 );
}

} // namespace

VolumeResult readInr( std::string_view bytes, const ReadLimits& limits )
{
	if ( bytes.substr( 0, kMagic.size() ) != kMagic )
	{
		return refuse( "it does not begin with " + std::string( kMagic ) );
	}
	const std::size_t begin = headerLength( bytes );
	if ( begin == 0 )
	{
		return refuse( "its header does not end" );
	}
	const Header header = readHeader( bytes.substr( 0, begin ) );
	VolumeResult result;
	GreyVolume& volume = result.volume;
	std::size_t voxels = 1;
	static constexpr const char* kSize[3] = { "XDIM", "YDIM", "ZDIM" };
	static constexpr const char* kSpacing[3] = { "VX", "VY", "VZ" };
	for ( std::size_t k = 0; k < 3; ++k )
	{
		if ( !number( header, kSize[k], volume.size[k] ) || volume.size[k] < 1 )
		{
			return refuse( std::string( kSize[k] ) + " is missing or not above 0" );
		}
		if ( std::size_t( volume.size[k] ) > limits.fileBytes / voxels )
		{
			return VolumeResult::failure( FileCode::TooLarge, "The INR file promises more voxels than are read." );
		}
		voxels *= std::size_t( volume.size[k] );
		if ( header.find( kSpacing[k] ) != header.end() &&
			( !number( header, kSpacing[k], volume.spacing[k] ) || !( volume.spacing[k] > 0 ) || !std::isfinite( volume.spacing[k] ) ) )
		{
			return refuse( std::string( kSpacing[k] ) + " is not above 0" );
		}
	}
	int values = 1;
	number( header, "VDIM", values );
	if ( values != 1 || textOf( header, "TYPE" ) != "unsigned fixed" || textOf( header, "PIXSIZE" ) != "8 bits" )
	{
		return refuse( "only one unsigned byte a voxel is read" );
	}
	if ( bytes.size() - begin < voxels )
	{
		return refuse( "it ends after " + std::to_string( bytes.size() - begin ) + " of " + std::to_string( voxels ) + " voxels" );
	}
	volume.values.assign( bytes.begin() + std::ptrdiff_t( begin ), bytes.begin() + std::ptrdiff_t( begin + voxels ) );
	return result;
}

VolumeResult readVolume( const std::string& path, const ReadLimits& limits )
{
	std::error_code error;
	const std::uintmax_t length = std::filesystem::file_size( path, error );
	if ( error || !std::filesystem::is_regular_file( path, error ) )
	{
		return VolumeResult::failure( FileCode::NotFound, path + " is not there." );
	}
	if ( length > limits.fileBytes )
	{
		return VolumeResult::failure( FileCode::TooLarge, path + " is larger than the limit." );
	}
	std::ifstream file( path, std::ios::binary );
	const std::string bytes{ std::istreambuf_iterator<char>( file ), std::istreambuf_iterator<char>() };
	return readInr( bytes, limits );
}

} // namespace pliant_glue
