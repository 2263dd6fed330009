// +-----------------------------------------------------------------------------------------------------------------+
// | Filling and describing buffers, and shapes drawn many times.                                                     |
// +-----------------------------------------------------------------------------------------------------------------+

#include "third_party_glue/gl_arrays.h"

namespace pliant_glue {

void sendArray( GlBuffer& buffer, GLenum target, const void* data, std::size_t bytes )
{
	glBindBuffer( target, buffer.name() );
	glBufferData( target, GLsizeiptr( bytes ), data, GL_STREAM_DRAW );
}

void describe( GLuint attribute, std::size_t stride, std::size_t offset )
{
	glEnableVertexAttribArray( attribute );
	glVertexAttribPointer( attribute, 3, GL_FLOAT, GL_FALSE, GLsizei( stride ), reinterpret_cast<const void*>( offset ) );
}

void prepareInstances( GpuInstances& to, const Primitive& shape )
{
	glBindVertexArray( to.arrays.name() );
	sendArray( to.positions, GL_ARRAY_BUFFER, shape.positions.data(), shape.positions.size() * sizeof( float ) );
	describe( Position, 3 * sizeof( float ), 0 );
	sendArray( to.normals, GL_ARRAY_BUFFER, shape.normals.data(), shape.normals.size() * sizeof( float ) );
	describe( Normal, 3 * sizeof( float ), 0 );
	sendArray( to.indices, GL_ELEMENT_ARRAY_BUFFER, shape.indices.data(), shape.indices.size() * sizeof( std::uint32_t ) );
	to.indexCount = int( shape.indices.size() );
	glBindBuffer( GL_ARRAY_BUFFER, to.instances.name() );
	for ( GLuint attribute = AxisX; attribute <= InstanceColour; ++attribute )
	{
		describe( attribute, sizeof( DrawInstance ), ( attribute - AxisX ) * sizeof( Vec3 ) );
		glVertexAttribDivisor( attribute, 1 );
	}
}

void uploadInstances( GpuInstances& to, const std::vector<DrawInstance>& from )
{
	static_assert( sizeof( DrawInstance ) == 5 * sizeof( Vec3 ) );
	sendArray( to.instances, GL_ARRAY_BUFFER, from.data(), from.size() * sizeof( DrawInstance ) );
	to.count = int( from.size() );
}

void drawInstances( GpuInstances& of )
{
	if ( of.count > 0 )
	{
		glBindVertexArray( of.arrays.name() );
		glDrawElementsInstanced( GL_TRIANGLES, of.indexCount, GL_UNSIGNED_INT, nullptr, of.count );
	}
}

} // namespace pliant_glue
