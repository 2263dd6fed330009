#pragma once

// OpenGL objects that free themselves. Private to the renderer.

#include <epoxy/gl.h>

#include <utility>

namespace pliant_glue {

/// Owns one OpenGL name; made by `Make`, freed by `Free` while the context is current.
template <void ( *Make )( GLuint& ), void ( *Free )( GLuint )>
class GlObject
{
public:
	GlObject() = default;
	~GlObject() { free(); }
	GlObject( GlObject&& from ) noexcept : m_name( std::exchange( from.m_name, 0u ) ) {}
	GlObject& operator=( GlObject&& from ) noexcept
	{
		if ( this != &from )
		{
			free();
			m_name = std::exchange( from.m_name, 0u );
		}
		return *this;
	}

	/// Made at the first use.
	GLuint name()
	{
		if ( m_name == 0 )
		{
			Make( m_name );
		}
		return m_name;
	}

private:
	void free()
	{
		if ( m_name != 0 )
		{
			Free( m_name );
		}
	}
	GLuint m_name = 0;
};

inline void makeBuffer( GLuint& name )
{
	glGenBuffers( 1, &name );
}
inline void freeBuffer( GLuint name )
{
	glDeleteBuffers( 1, &name );
}
inline void makeArrays( GLuint& name )
{
	glGenVertexArrays( 1, &name );
}
inline void freeArrays( GLuint name )
{
	glDeleteVertexArrays( 1, &name );
}
inline void makeTexture( GLuint& name )
{
	glGenTextures( 1, &name );
}
inline void freeTexture( GLuint name )
{
	glDeleteTextures( 1, &name );
}
inline void makeFramebuffer( GLuint& name )
{
	glGenFramebuffers( 1, &name );
}
inline void freeFramebuffer( GLuint name )
{
	glDeleteFramebuffers( 1, &name );
}
inline void makeRenderbuffer( GLuint& name )
{
	glGenRenderbuffers( 1, &name );
}
inline void freeRenderbuffer( GLuint name )
{
	glDeleteRenderbuffers( 1, &name );
}
inline void makeProgram( GLuint& name )
{
	name = glCreateProgram();
}
inline void freeProgram( GLuint name )
{
	glDeleteProgram( name );
}

using GlBuffer = GlObject<makeBuffer, freeBuffer>;
using GlArrays = GlObject<makeArrays, freeArrays>;
using GlTexture = GlObject<makeTexture, freeTexture>;
using GlFramebuffer = GlObject<makeFramebuffer, freeFramebuffer>;
using GlRenderbuffer = GlObject<makeRenderbuffer, freeRenderbuffer>;
using GlProgram = GlObject<makeProgram, freeProgram>;

} // namespace pliant_glue
