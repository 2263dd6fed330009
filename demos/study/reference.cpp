// +-----------------------------------------------------------------------------------------------------------------+
// | The reference in a file: vertices, frames, time of breaking; then the positions as floats, vertex after vertex.   |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/reference.h"

#include <cstdint>
#include <fstream>

namespace pliant_study {

namespace {

struct Header
{
	std::uint64_t vertices = 0, frames = 0;
	double brokenAt = -1;
};

} // namespace

bool isReference( const Record& record )
{
	return record.family == "reference";
}

bool read( const std::string& path, const Specimen& specimen, Reference& to )
{
	std::ifstream file( path, std::ios::binary );
	Header header;
	if ( !file.read( reinterpret_cast<char*>( &header ), sizeof( header ) ) || header.vertices != std::uint64_t( specimen.points.cols() ) )
	{
		return false;
	}
	to.brokenAt = header.brokenAt;
	to.track.clear();
	Eigen::Matrix<float, 3, Eigen::Dynamic> frame( 3, specimen.points.cols() );
	const auto bytes = std::streamsize( frame.size() ) * std::streamsize( sizeof( float ) );
	while ( to.track.size() < header.frames && file.read( reinterpret_cast<char*>( frame.data() ), bytes ) )
	{
		to.track.push_back( frame.cast<double>() );
	}
	return to.track.size() == header.frames;
}

bool write( const std::string& path, const Reference& reference )
{
	std::ofstream file( path, std::ios::binary );
	const Header header{
		reference.track.empty() ? 0 : std::uint64_t( reference.track.front().cols() ), reference.track.size(), reference.brokenAt };
	file.write( reinterpret_cast<const char*>( &header ), sizeof( header ) );
	for ( const Points& points : reference.track )
	{
		const Eigen::Matrix<float, 3, Eigen::Dynamic> frame = points.cast<float>();
		file.write( reinterpret_cast<const char*>( frame.data() ), std::streamsize( frame.size() ) * std::streamsize( sizeof( float ) ) );
	}
	return bool( file.flush() );
}

} // namespace pliant_study
