// +-----------------------------------------------------------------------------------------------------------------+
// | Positions first, then normals from the positions of all neighbours, as the plugin's pliant/render/gpu_surface.h  |
// | states. Tables are texel buffers: OpenGL 3.3 has no storage buffers.                                             |
// +-----------------------------------------------------------------------------------------------------------------+

#include "third_party_glue/gpu_skin.h"

#include "third_party_glue/gl_programs.h"

#include <algorithm>

namespace pliant_glue {

namespace {

constexpr std::size_t kPositionBytes = 4 * sizeof( float ), kNormalBytes = 3 * sizeof( float );

const char* const kTableNames[] = {
	"uVertices", "uInfluences", "uMixes", "uCorners", "uNodeOfCell", "uOffsets", "uTransforms", "uPositions" };

const char* const kSource = R"(
uniform usamplerBuffer uVertices;   // three texels: rest, first | restNormal, count | normalShift, corner
uniform usamplerBuffer uInfluences; // cell, weight
uniform usamplerBuffer uMixes;      // two texels: three vertices | three weights
uniform usamplerBuffer uCorners;    // vertex, next
uniform usamplerBuffer uNodeOfCell;
uniform samplerBuffer uOffsets;
uniform samplerBuffer uTransforms;  // three texels: the rows
uniform samplerBuffer uPositions;
uniform bool uHasLevels;
uniform bool uHasOffsets;
uniform mat3 uOffsetTurn;

const uint kNone = 0xffffffffu;

vec3 blended( uint first, uint count, vec4 at )
{
	vec3 sum = vec3( 0.0 );
	for( uint k = first; k < first + count; ++k )
	{
		uvec2 influence = texelFetch( uInfluences, int( k ) ).xy;
		int node = int( uHasLevels ? texelFetch( uNodeOfCell, int( influence.x ) ).x : influence.x );
		vec3 moved = vec3( dot( texelFetch( uTransforms, 3 * node ), at ), dot( texelFetch( uTransforms, 3 * node + 1 ), at ),
			dot( texelFetch( uTransforms, 3 * node + 2 ), at ) );
		sum += uintBitsToFloat( influence.y ) * moved;
	}
	return sum;
}

#if defined( POSITIONS )
out vec4 outPosition;

vec3 skinned( int v )
{
	uvec4 rest = texelFetch( uVertices, 3 * v );
	vec3 at = blended( rest.w, texelFetch( uVertices, 3 * v + 1 ).w, vec4( uintBitsToFloat( rest.xyz ), 1.0 ) );
	return uHasOffsets ? at + uOffsetTurn * texelFetch( uOffsets, v ).xyz : at;
}

void main()
{
	int v = gl_VertexID;
	vec3 at;
	if( texelFetch( uVertices, 3 * v + 1 ).w == 0u )
	{
		int mix = 2 * int( texelFetch( uVertices, 3 * v ).w );
		uvec3 of = texelFetch( uMixes, mix ).xyz;
		vec3 weight = uintBitsToFloat( texelFetch( uMixes, mix + 1 ).xyz );
		at = weight.x * skinned( int( of.x ) ) + weight.y * skinned( int( of.y ) ) + weight.z * skinned( int( of.z ) );
	}
	else
	{
		at = skinned( v );
	}
	outPosition = vec4( at, 1.0 );
	gl_Position = outPosition;
}
#else
out vec3 outNormal;

vec3 unit( vec3 a )
{
	float size = length( a );
	return size > 0.0 ? a / size : a;
}

vec3 positionOf( uint corner )
{
	return texelFetch( uPositions, int( texelFetch( uCorners, int( corner ) ).x ) ).xyz;
}

vec3 normalOf( int v )
{
	uvec4 shift = texelFetch( uVertices, 3 * v + 2 );
	vec3 area = vec3( 0.0 );
	for( uint corner = shift.w; corner != kNone; corner = texelFetch( uCorners, int( corner ) ).y )
	{
		uint first = corner - corner % 3u;
		vec3 at = positionOf( first );
		area += cross( positionOf( first + 1u ) - at, positionOf( first + 2u ) - at );
	}
	uint first = texelFetch( uVertices, 3 * v ).w;
	uvec4 rest = texelFetch( uVertices, 3 * v + 1 );
	if( !( length( area ) > 0.0 ) )
	{
		return unit( blended( first, rest.w, vec4( uintBitsToFloat( rest.xyz ), 0.0 ) ) );
	}
	vec3 by = uintBitsToFloat( shift.xyz );
	return by == vec3( 0.0 ) ? unit( area ) : unit( unit( area ) + blended( first, rest.w, vec4( by, 0.0 ) ) );
}

void main()
{
	int v = gl_VertexID;
	if( texelFetch( uVertices, 3 * v + 1 ).w == 0u )
	{
		int mix = 2 * int( texelFetch( uVertices, 3 * v ).w );
		uvec3 of = texelFetch( uMixes, mix ).xyz;
		vec3 weight = uintBitsToFloat( texelFetch( uMixes, mix + 1 ).xyz );
		outNormal = unit( weight.x * normalOf( int( of.x ) ) + weight.y * normalOf( int( of.y ) ) + weight.z * normalOf( int( of.z ) ) );
	}
	else
	{
		outNormal = normalOf( v );
	}
	gl_Position = vec4( outNormal, 1.0 );
}
#endif
)";

} // namespace

/// Sends what has changed since the version that the buffer holds; a buffer that is too small is made anew, with room for more.
void SkinOnGpu::send( Table table, GLenum format, const DrawTable& from )
{
	Buffer& to = m_tables[std::size_t( table )];
	if ( to.version == from.version )
	{
		return;
	}
	const std::size_t bytes = from.entries * from.entryBytes;
	const char* const data = static_cast<const char*>( from.data );
	glBindBuffer( GL_TEXTURE_BUFFER, to.buffer.name() );
	if ( bytes > to.capacity || to.version == 0 || from.changedSince != to.version )
	{
		if ( bytes > to.capacity )
		{
			to.capacity = bytes + bytes / 4;
			glBufferData( GL_TEXTURE_BUFFER, GLsizeiptr( to.capacity ), nullptr, GL_DYNAMIC_DRAW );
			glBindTexture( GL_TEXTURE_BUFFER, to.texture.name() );
			glTexBuffer( GL_TEXTURE_BUFFER, format, to.buffer.name() );
		}
		glBufferSubData( GL_TEXTURE_BUFFER, 0, GLsizeiptr( bytes ), data );
	}
	else
	{
		for ( const DrawRange& range : from.changed )
		{
			const std::size_t first = range.first * from.entryBytes;
			glBufferSubData( GL_TEXTURE_BUFFER, GLintptr( first ), GLsizeiptr( range.count * from.entryBytes ), data + first );
		}
	}
	to.version = from.version;
}

void SkinOnGpu::upload( const DrawSkin& skin )
{
	send( Vertices, GL_RGBA32UI, skin.vertices );
	send( Influences, GL_RG32UI, skin.influences );
	send( Mixes, GL_RGBA32UI, skin.mixes );
	send( Corners, GL_RG32UI, skin.corners );
	send( NodeOfCell, GL_R32UI, skin.nodeOfCell );
	send( Offsets, GL_RGBA32F, skin.offsets );
	const std::size_t floats = 12 * std::size_t( skin.nodeCount );
	send( Transforms, GL_RGBA32F, { skin.nodeTransforms, floats, sizeof( float ), m_tables[Transforms].version + 1, 0, {} } );
	m_vertexCount = int( skin.vertices.entries );
	m_hasLevels = skin.nodeOfCell.entries > 0;
	m_hasOffsets = skin.offsets.entries > 0;
	m_offsetTurn = skin.offsetTurn;
	if ( m_room < skin.vertices.entries )
	{
		m_room = skin.vertices.entries + skin.vertices.entries / 4;
		glBindBuffer( GL_ARRAY_BUFFER, normals.name() );
		glBufferData( GL_ARRAY_BUFFER, GLsizeiptr( m_room * kNormalBytes ), nullptr, GL_DYNAMIC_COPY );
		glBindBuffer( GL_ARRAY_BUFFER, positions.name() );
		glBufferData( GL_ARRAY_BUFFER, GLsizeiptr( m_room * kPositionBytes ), nullptr, GL_DYNAMIC_COPY );
		glBindTexture( GL_TEXTURE_BUFFER, m_tables[Positions].texture.name() );
		glTexBuffer( GL_TEXTURE_BUFFER, GL_RGBA32F, positions.name() );
	}
}

bool GpuSkinner::build( std::string& why )
{
	return buildFeedback( m_positions.name(), "#define POSITIONS\n", kSource, "outPosition", why ) &&
		buildFeedback( m_normals.name(), "#define NORMALS\n", kSource, "outNormal", why );
}

void GpuSkinner::pass( SkinOnGpu& mesh, GlProgram& program, GlBuffer& to )
{
	glUseProgram( program.name() );
	const auto place = [&]( const char* name ) { return glGetUniformLocation( program.name(), name ); };
	for ( int k = 0; k < SkinOnGpu::Count; ++k )
	{
		glActiveTexture( GLenum( GL_TEXTURE0 + k ) );
		glBindTexture( GL_TEXTURE_BUFFER, mesh.m_tables[std::size_t( k )].texture.name() );
		glUniform1i( place( kTableNames[k] ), k );
	}
	glUniform1i( place( "uHasLevels" ), mesh.m_hasLevels ? 1 : 0 );
	glUniform1i( place( "uHasOffsets" ), mesh.m_hasOffsets ? 1 : 0 );
	glUniformMatrix3fv( place( "uOffsetTurn" ), 1, GL_TRUE, mesh.m_offsetTurn.data() );
	glBindBufferBase( GL_TRANSFORM_FEEDBACK_BUFFER, 0, to.name() );
	glBeginTransformFeedback( GL_POINTS );
	glDrawArrays( GL_POINTS, 0, mesh.m_vertexCount );
	glEndTransformFeedback();
	glBindBufferBase( GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0 );
}

void GpuSkinner::skin( SkinOnGpu& mesh )
{
	glBindVertexArray( m_noArrays.name() );
	glEnable( GL_RASTERIZER_DISCARD );
	pass( mesh, m_positions, mesh.positions );
	pass( mesh, m_normals, mesh.normals );
	glDisable( GL_RASTERIZER_DISCARD );
	for ( int k = 0; k < SkinOnGpu::Count; ++k )
	{
		glActiveTexture( GLenum( GL_TEXTURE0 + k ) );
		glBindTexture( GL_TEXTURE_BUFFER, 0 );
	}
	glActiveTexture( GL_TEXTURE0 );
}

} // namespace pliant_glue
