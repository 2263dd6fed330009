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

bool link( GLuint program, std::string& why )
{
	glLinkProgram( program );
	GLint good = GL_FALSE;
	glGetProgramiv( program, GL_LINK_STATUS, &good );
	if ( good != GL_TRUE )
	{
		why = "a shader program does not link";
	}
	return good == GL_TRUE;
}

} // namespace

bool buildFeedback( GLuint program, const char* define, const char* source, const char* varying, std::string& why )
{
	glTransformFeedbackVaryings( program, 1, &varying, GL_INTERLEAVED_ATTRIBS );
	return compile( program, GL_VERTEX_SHADER, define, source, why ) && link( program, why );
}

bool buildPrograms( GlPrograms& programs, std::string& why )
{
	for ( int k = 0; k < int( Program::Count ); ++k )
	{
		const GLuint program = programs[std::size_t( k )].name();
		const char* define = programDefine( Program( k ) );
		if ( !compile( program, GL_VERTEX_SHADER, define, kVertexSource, why ) ||
			!compile( program, GL_FRAGMENT_SHADER, define, kFragmentSource, why ) || !link( program, why ) )
		{
			return false;
		}
	}
	return true;
}

} // namespace pliant_glue
