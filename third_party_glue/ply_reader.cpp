// +-----------------------------------------------------------------------------------------------------------------+
// | Reads PLY. Written because assimp 5.2 ends with a segmentation fault on about one in twenty files with a few      |
// | damaged bytes.                                                                                                    |
// +-----------------------------------------------------------------------------------------------------------------+

#include "third_party_glue/ply_reader.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <sstream>

namespace pliant_glue {

namespace {

enum class Scalar : int
{
	Int8,
	UInt8,
	Int16,
	UInt16,
	Int32,
	UInt32,
	Float,
	Double,
	None
};

Scalar scalarNamed( const std::string& name )
{
	static constexpr std::array<std::array<const char*, 2>, 8> kNames = { { { "char", "int8" }, { "uchar", "uint8" }, { "short", "int16" },
		{ "ushort", "uint16" }, { "int", "int32" }, { "uint", "uint32" }, { "float", "float32" }, { "double", "float64" } } };
	for ( std::size_t k = 0; k < kNames.size(); ++k )
	{
		if ( name == kNames[k][0] || name == kNames[k][1] )
		{
			return Scalar( k );
		}
	}
	return Scalar::None;
}

/// Where a number of a vertex goes.
enum class Slot : int
{
	X,
	Y,
	Z,
	NormalX,
	NormalY,
	NormalZ,
	U,
	V,
	Count
};

struct Property
{
	std::string name;
	Scalar type = Scalar::None;
	Scalar countType = Scalar::None; ///< of a list; None for a single number
	Slot slot = Slot::Count;         ///< of a vertex's number
};

struct Element
{
	std::string name;
	std::size_t count = 0;
	std::vector<Property> properties;
};

enum class Format : int
{
	Text,
	LittleEndian,
	BigEndian
};

Slot slotNamed( const std::string& name )
{
	static constexpr std::array<std::pair<const char*, Slot>, 12> kSlots = {
		{ { "x", Slot::X }, { "y", Slot::Y }, { "z", Slot::Z }, { "nx", Slot::NormalX }, { "ny", Slot::NormalY }, { "nz", Slot::NormalZ },
			{ "u", Slot::U }, { "v", Slot::V }, { "s", Slot::U }, { "t", Slot::V }, { "texture_u", Slot::U }, { "texture_v", Slot::V } } };
	const auto found = std::find_if( kSlots.begin(), kSlots.end(), [&]( const auto& entry ) { return name == entry.first; } );
	return found == kSlots.end() ? Slot::Count : found->second;
}

/// Numbers one after the other, whatever the file writes them as.
class Numbers
{
public:
	Numbers( std::string_view bytes, Format format ) : m_rest( bytes ), m_format( format ) {}

	std::size_t bytesLeft() const { return m_rest.size(); }

	bool next( Scalar type, double& value )
	{
		switch ( type )
		{
			case Scalar::Int8: return nextAs<std::int8_t>( value );
			case Scalar::UInt8: return nextAs<std::uint8_t>( value );
			case Scalar::Int16: return nextAs<std::int16_t>( value );
			case Scalar::UInt16: return nextAs<std::uint16_t>( value );
			case Scalar::Int32: return nextAs<std::int32_t>( value );
			case Scalar::UInt32: return nextAs<std::uint32_t>( value );
			case Scalar::Float: return nextAs<float>( value );
			case Scalar::Double: return nextAs<double>( value );
			case Scalar::None: break;
		}
		return false;
	}

	/// A number that counts something: whole and not negative.
	bool nextCount( Scalar type, std::size_t& count )
	{
		double value = 0;
		if ( !next( type, value ) || !( value >= 0 && value <= 4294967295.0 ) )
		{
			return false;
		}
		count = std::size_t( value );
		return double( count ) == value;
	}

private:
	template <class Type>
	bool nextAs( double& value )
	{
		if ( m_format == Format::Text )
		{
			return nextWord( value );
		}
		if ( m_rest.size() < sizeof( Type ) )
		{
			return false;
		}
		std::array<char, sizeof( Type )> bytes;
		std::copy_n( m_rest.begin(), sizeof( Type ), bytes.begin() );
		m_rest.remove_prefix( sizeof( Type ) );
		if ( ( m_format == Format::BigEndian ) == ( std::endian::native == std::endian::little ) )
		{
			std::reverse( bytes.begin(), bytes.end() );
		}
		value = double( std::bit_cast<Type>( bytes ) );
		return true;
	}

	bool nextWord( double& value )
	{
		const std::size_t begin = std::min( m_rest.find_first_not_of( " \t\r\n" ), m_rest.size() );
		m_rest.remove_prefix( begin );
		const char* first = m_rest.data();
		const char* last = first + m_rest.size();
		const std::from_chars_result read = std::from_chars( first != last && *first == '+' ? first + 1 : first, last, value );
		m_rest.remove_prefix( std::size_t( read.ptr - first ) );
		return read.ec == std::errc();
	}

	std::string_view m_rest;
	Format m_format;
};

class PlyFile
{
public:
	PlyFile( std::string_view bytes, const ReadLimits& limits ) : m_bytes( bytes ), m_limits( limits ) {}

	ReadResult read()
	{
		if ( !readHeader() )
		{
			return refusal();
		}
		Numbers numbers( m_bytes, m_format );
		for ( const Element& element : m_elements )
		{
			// Every element takes a byte or more, so a header cannot make us reserve what is not there.
			if ( !element.properties.empty() && element.count > numbers.bytesLeft() )
			{
				m_wrong = "its header promises more than the file holds";
			}
			else if ( element.name == "vertex" && element.count > m_limits.vertices )
			{
				return ReadResult::failure( FileCode::TooLarge,
					"The PLY file has " + std::to_string( element.count ) + " vertices, more than the limit of " +
						std::to_string( m_limits.vertices ) + "." );
			}
			if ( !m_wrong.empty() || !readElement( element, numbers ) )
			{
				return refusal();
			}
		}
		return finish();
	}

private:
	ReadResult refusal() const { return ReadResult::failure( FileCode::Unreadable, "PLY file: " + m_wrong + "." ); }

	bool fail( std::string wrong )
	{
		m_wrong = std::move( wrong );
		return false;
	}

	/// The next line of the header, without its end.
	bool nextLine( std::string& line )
	{
		const std::size_t end = m_bytes.find( '\n' );
		if ( end == std::string_view::npos )
		{
			return false;
		}
		line = std::string( m_bytes.substr( 0, end ) );
		m_bytes.remove_prefix( end + 1 );
		if ( !line.empty() && line.back() == '\r' )
		{
			line.pop_back();
		}
		return true;
	}

	bool readHeader()
	{
		std::string line;
		if ( !nextLine( line ) || line != "ply" )
		{
			return fail( "it does not begin with \"ply\"" );
		}
		while ( nextLine( line ) )
		{
			std::istringstream words( line );
			std::string keyword;
			words >> keyword;
			if ( keyword == "end_header" )
			{
				return true;
			}
			if ( keyword == "format" && !readFormat( words ) )
			{
				return fail( "its format is none of ascii, binary_little_endian and binary_big_endian" );
			}
			if ( keyword == "element" )
			{
				m_elements.emplace_back();
				if ( !( words >> m_elements.back().name >> m_elements.back().count ) )
				{
					return fail( "an element has no count" );
				}
			}
			if ( keyword == "property" && !readProperty( words ) )
			{
				return fail( "a property's type is not known" );
			}
		}
		return fail( "its header has no end" );
	}

	bool readFormat( std::istringstream& words )
	{
		std::string name;
		words >> name;
		m_format = name == "binary_big_endian" ? Format::BigEndian : name == "binary_little_endian" ? Format::LittleEndian : Format::Text;
		return m_format != Format::Text || name == "ascii";
	}

	bool readProperty( std::istringstream& words )
	{
		Property property;
		std::string type;
		words >> type;
		if ( type == "list" )
		{
			words >> type;
			property.countType = scalarNamed( type );
			words >> type;
			if ( property.countType == Scalar::None )
			{
				return false;
			}
		}
		property.type = scalarNamed( type );
		if ( !( words >> property.name ) || property.type == Scalar::None || m_elements.empty() )
		{
			return false;
		}
		if ( property.countType == Scalar::None )
		{
			property.slot = slotNamed( property.name );
		}
		m_elements.back().properties.push_back( std::move( property ) );
		return true;
	}

	bool readElement( const Element& element, Numbers& numbers )
	{
		const bool isVertex = element.name == "vertex";
		const bool isFace = element.name == "face";
		const auto has = [&]( Slot slot ) {
			return std::any_of( element.properties.begin(), element.properties.end(), [&]( const Property& p ) { return p.slot == slot; } );
		};
		m_hasNormals = isVertex ? has( Slot::NormalX ) && has( Slot::NormalY ) && has( Slot::NormalZ ) : m_hasNormals;
		m_hasTexture = isVertex ? has( Slot::U ) && has( Slot::V ) : m_hasTexture;
		if ( isVertex && !( has( Slot::X ) && has( Slot::Y ) && has( Slot::Z ) ) )
		{
			return fail( "its vertices have no x, y and z" );
		}
		for ( std::size_t i = 0; i < element.count && !element.properties.empty(); ++i )
		{
			std::array<float, std::size_t( Slot::Count ) + 1> slots{};
			for ( const Property& property : element.properties )
			{
				if ( property.countType != Scalar::None )
				{
					const bool isPolygon = isFace && ( property.name == "vertex_indices" || property.name == "vertex_index" );
					if ( !readList( property, isPolygon, numbers ) )
					{
						return fail( "a " + element.name + " is cut off or no list of numbers" );
					}
					continue;
				}
				double value = 0;
				if ( !numbers.next( property.type, value ) )
				{
					return fail( "it ends after " + std::to_string( i ) + " of " + std::to_string( element.count ) + " elements \"" +
						element.name + "\"" );
				}
				slots[std::size_t( property.slot )] = float( value );
			}
			if ( isVertex )
			{
				appendVertex( slots.data() );
			}
		}
		return true;
	}

	void appendVertex( const float* slots )
	{
		m_mesh.positions.insert( m_mesh.positions.end(), slots, slots + 3 );
		if ( m_hasNormals )
		{
			m_mesh.normals.insert( m_mesh.normals.end(), slots + 3, slots + 6 );
		}
		if ( m_hasTexture )
		{
			m_mesh.textureCoordinates.insert( m_mesh.textureCoordinates.end(), slots + 6, slots + 8 );
		}
	}

	bool readList( const Property& property, bool isPolygon, Numbers& numbers )
	{
		std::size_t count = 0;
		if ( !numbers.nextCount( property.countType, count ) || count > numbers.bytesLeft() )
		{
			return false;
		}
		std::uint32_t fan[2] = { 0, 0 };
		for ( std::size_t k = 0; k < count; ++k )
		{
			std::size_t vertex = 0;
			double number = 0;
			if ( isPolygon ? !numbers.nextCount( property.type, vertex ) : !numbers.next( property.type, number ) )
			{
				return false;
			}
			if ( isPolygon && k >= 2 )
			{
				m_mesh.indices.insert( m_mesh.indices.end(), { fan[0], fan[1], std::uint32_t( vertex ) } );
			}
			fan[k == 0 ? 0 : 1] = std::uint32_t( vertex );
		}
		return true;
	}

	ReadResult finish()
	{
		const std::size_t vertices = m_mesh.vertexCount();
		const auto wild = std::find_if( m_mesh.indices.begin(), m_mesh.indices.end(), [&]( std::uint32_t i ) { return i >= vertices; } );
		if ( wild != m_mesh.indices.end() )
		{
			m_wrong = "a face names vertex " + std::to_string( *wild ) + " of " + std::to_string( vertices );
			return refusal();
		}
		if ( m_mesh.indices.empty() )
		{
			m_wrong = "it holds no triangle";
			return refusal();
		}
		m_mesh.submeshOfTriangle.assign( m_mesh.triangleCount(), 0 );
		m_mesh.submeshNames = { "mesh" };
		return { {}, std::move( m_mesh ) };
	}

	std::string_view m_bytes;
	const ReadLimits& m_limits;
	Format m_format = Format::Text;
	std::vector<Element> m_elements;
	ModelMesh m_mesh;
	bool m_hasNormals = false, m_hasTexture = false;
	std::string m_wrong;
};

} // namespace

ReadResult readPly( std::string_view bytes, const ReadLimits& limits )
{
	return PlyFile( bytes, limits ).read();
}

} // namespace pliant_glue
