// +-----------------------------------------------------------------------------------------------------------------+
// | Reads OFF text line by line. Written because assimp 5.2 drops one face for each comment line among the faces,     |
// | which opens closed meshes without a word.                                                                         |
// +-----------------------------------------------------------------------------------------------------------------+

#include "third_party_glue/off_reader.h"

#include <charconv>
#include <cmath>

namespace pliant_glue {

namespace {

bool isBlank( char c )
{
	return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/// One line's numbers, one after the other.
class Line
{
public:
	explicit Line( std::string_view text ) : m_at( text.data() ), m_end( text.data() + text.size() ) {}

	bool empty()
	{
		skipBlanks();
		return m_at == m_end;
	}

	template <class Number>
	bool next( Number& value )
	{
		skipBlanks();
		if ( m_at != m_end && *m_at == '+' )
		{
			++m_at;
		}
		const std::from_chars_result read = std::from_chars( m_at, m_end, value );
		if ( read.ec != std::errc() )
		{
			return false;
		}
		m_at = read.ptr;
		return true;
	}

	std::string_view word()
	{
		skipBlanks();
		const char* begin = m_at;
		while ( m_at != m_end && !isBlank( *m_at ) )
		{
			++m_at;
		}
		return { begin, std::size_t( m_at - begin ) };
	}

private:
	void skipBlanks()
	{
		while ( m_at != m_end && isBlank( *m_at ) )
		{
			++m_at;
		}
	}

	const char* m_at;
	const char* m_end;
};

/// The lines of a text that hold something, comments cut off.
class Lines
{
public:
	explicit Lines( std::string_view text ) : m_rest( text ) {}

	bool next( std::string_view& line )
	{
		while ( !m_rest.empty() )
		{
			const std::size_t end = m_rest.find( '\n' );
			line = m_rest.substr( 0, end );
			m_rest = end == std::string_view::npos ? std::string_view() : m_rest.substr( end + 1 );
			++m_number;
			line = line.substr( 0, line.find( '#' ) );
			if ( !Line( line ).empty() )
			{
				return true;
			}
		}
		return false;
	}

	std::size_t number() const { return m_number; }

private:
	std::string_view m_rest;
	std::size_t m_number = 0;
};

struct OffHeader
{
	std::size_t vertices = 0;
	std::size_t faces = 0;
	bool hasNormals = false;
	bool hasTexture = false;
};

ReadResult refuseAt( const std::string& what, const Lines& lines )
{
	return ReadResult::failure( FileCode::Unreadable, "OFF file, line " + std::to_string( lines.number() ) + ": " + what + "." );
}

/// [ST][C][N]OFF, then two or three counts on the same line or on the next. Returns what is wrong, or nothing.
std::string readOffHeader( Lines& lines, OffHeader& header )
{
	std::string_view text;
	if ( !lines.next( text ) )
	{
		return "nothing but comments";
	}
	Line line( text );
	std::string_view keyword = line.word();
	if ( keyword.size() < 3 || keyword.substr( keyword.size() - 3 ) != "OFF" )
	{
		return "it does not begin with OFF";
	}
	keyword.remove_suffix( 3 );
	if ( keyword.substr( 0, 2 ) == "ST" )
	{
		header.hasTexture = true;
		keyword.remove_prefix( 2 );
	}
	for ( const char letter : keyword )
	{
		if ( letter != 'C' && letter != 'N' )
		{
			return "only three-dimensional text OFF files (OFF, COFF, NOFF, STOFF and their mixtures) are read";
		}
		header.hasNormals = header.hasNormals || letter == 'N';
	}
	if ( line.empty() )
	{
		if ( !lines.next( text ) )
		{
			return "it ends before its counts";
		}
		line = Line( text );
	}
	return line.next( header.vertices ) && line.next( header.faces ) ? "" : "the counts of vertices and faces are not there";
}

bool readVertex( Line line, const OffHeader& header, ModelMesh& mesh )
{
	float p[3];
	if ( !line.next( p[0] ) || !line.next( p[1] ) || !line.next( p[2] ) )
	{
		return false;
	}
	mesh.positions.insert( mesh.positions.end(), p, p + 3 );
	// After the position: normal, colour, texture coordinates. Colours have no fixed length, so texture coordinates are the last two.
	if ( header.hasNormals )
	{
		float n[3];
		if ( !line.next( n[0] ) || !line.next( n[1] ) || !line.next( n[2] ) )
		{
			return false;
		}
		mesh.normals.insert( mesh.normals.end(), n, n + 3 );
	}
	if ( header.hasTexture )
	{
		float last[2] = { 0, 0 };
		int found = 0;
		for ( float number; line.next( number ); ++found )
		{
			last[0] = last[1];
			last[1] = number;
		}
		if ( found < 2 )
		{
			return false;
		}
		mesh.textureCoordinates.insert( mesh.textureCoordinates.end(), last, last + 2 );
	}
	return true;
}

/// A face's corners as a fan of triangles. Returns what is wrong, or nothing.
std::string readFace( Line line, const OffHeader& header, const ReadLimits& limits, ModelMesh& mesh )
{
	std::size_t corners = 0;
	if ( !line.next( corners ) )
	{
		return "a face does not begin with its number of corners";
	}
	std::uint32_t fan[2] = { 0, 0 };
	for ( std::size_t k = 0; k < corners; ++k )
	{
		std::uint32_t vertex = 0;
		if ( !line.next( vertex ) )
		{
			return "a face ends before its last corner";
		}
		if ( vertex >= header.vertices )
		{
			return "a face names vertex " + std::to_string( vertex ) + " of " + std::to_string( header.vertices );
		}
		if ( k >= 2 )
		{
			mesh.indices.insert( mesh.indices.end(), { fan[0], fan[1], vertex } );
		}
		fan[k == 0 ? 0 : 1] = vertex;
	}
	return mesh.indices.size() / 3 > limits.vertices * 8 ? "more triangles than are read" : "";
}

} // namespace

ReadResult readOff( std::string_view text, const ReadLimits& limits )
{
	Lines lines( text );
	OffHeader header;
	if ( const std::string wrong = readOffHeader( lines, header ); !wrong.empty() )
	{
		return refuseAt( wrong, lines );
	}
	if ( header.vertices > limits.vertices )
	{
		return ReadResult::failure( FileCode::TooLarge,
			"The OFF file has " + std::to_string( header.vertices ) + " vertices, more than the limit of " +
				std::to_string( limits.vertices ) + "." );
	}
	// The shortest vertex is "0 0 0\n" and the shortest face "3 0 0 0\n": a header must not make us reserve what cannot be there.
	if ( header.vertices > text.size() / 5 || header.faces > text.size() / 3 )
	{
		return refuseAt( "its header promises more than the file holds", lines );
	}

	ReadResult result;
	ModelMesh& mesh = result.mesh;
	mesh.positions.reserve( header.vertices * 3 );
	mesh.indices.reserve( header.faces * 3 );
	std::string_view line;
	for ( std::size_t i = 0; i < header.vertices; ++i )
	{
		if ( !lines.next( line ) )
		{
			return refuseAt( "it ends after " + std::to_string( i ) + " of " + std::to_string( header.vertices ) + " vertices", lines );
		}
		if ( !readVertex( Line( line ), header, mesh ) )
		{
			return refuseAt( "a vertex is not a row of numbers", lines );
		}
	}
	for ( std::size_t f = 0; f < header.faces; ++f )
	{
		if ( !lines.next( line ) )
		{
			return refuseAt( "it ends after " + std::to_string( f ) + " of " + std::to_string( header.faces ) + " faces", lines );
		}
		if ( const std::string wrong = readFace( Line( line ), header, limits, mesh ); !wrong.empty() )
		{
			return refuseAt( wrong, lines );
		}
	}
	if ( mesh.indices.empty() )
	{
		return ReadResult::failure( FileCode::Unreadable, "The OFF file holds no triangle." );
	}
	mesh.submeshOfTriangle.assign( mesh.triangleCount(), 0 );
	mesh.submeshNames = { "mesh" };
	return result;
}

} // namespace pliant_glue
