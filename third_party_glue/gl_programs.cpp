// +-----------------------------------------------------------------------------------------------------------------+
// | Compiles and links the programs, and hands out the driver's own words when it refuses.                           |
// +-----------------------------------------------------------------------------------------------------------------+

#include "third_party_glue/gl_programs.h"

namespace pliant_glue {

namespace {

bool compile( GLuint program, GLenum kind, const char* define, const char* body, std::string& why )
{
	const GLuint shader = glCreateShader( kind );
	const char* parts[] = { "#version 330 core\n", define, body };
	glShaderSource( shader, 3, parts, nullptr );
	glCompileShader( shader );
	GLint good = GL_FALSE;
	glGetShaderiv( shader, GL_COMPILE_STATUS, &good );
	if ( good != GL_TRUE )
	{
		char log[1024] = "";
		glGetShaderInfoLog( shader, sizeof( log ), nullptr, log );
		why = std::string( "a shader does not compile: " ) + log;
	}
	glAttachShader( program, shader );
	glDeleteShader( shader );
	return good == GL_TRUE;
}

} // namespace

bool buildPrograms( GlPrograms& programs, std::string& why )
{
	for ( int k = 0; k < int( Program::Count ); ++k )
	{
		const GLuint program = programs[std::size_t( k )].name();
		const char* define = programDefine( Program( k ) );
		if ( !compile( program, GL_VERTEX_SHADER, define, kVertexSource, why ) ||
			!compile( program, GL_FRAGMENT_SHADER, define, kFragmentSource, why ) )
		{
			return false;
		}
		glLinkProgram( program );
		GLint good = GL_FALSE;
		glGetProgramiv( program, GL_LINK_STATUS, &good );
		if ( good != GL_TRUE )
		{
			why = "a shader program does not link";
			return false;
		}
	}
	return true;
}

} // namespace pliant_glue
