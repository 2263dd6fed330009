// +-----------------------------------------------------------------------------------------------------------------+
// | EGL without a surface: the renderer draws into its own framebuffer and reads it back.                            |
// +-----------------------------------------------------------------------------------------------------------------+

#include "third_party_glue/offscreen.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

namespace pliant_glue {

struct Offscreen::Handles
{
	EGLDisplay display = EGL_NO_DISPLAY;
	EGLContext context = EGL_NO_CONTEXT;
};

Offscreen::Offscreen() : m_handles( new Handles ) {}

Offscreen::~Offscreen()
{
	if ( m_handles->display != EGL_NO_DISPLAY )
	{
		eglMakeCurrent( m_handles->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT );
		if ( m_handles->context != EGL_NO_CONTEXT )
		{
			eglDestroyContext( m_handles->display, m_handles->context );
		}
		eglTerminate( m_handles->display );
	}
}

std::unique_ptr<Offscreen> Offscreen::create( std::string& why )
{
	// epoxy ends the process when it asks a missing libEGL for a function, so ask for the extension string first.
	if ( !epoxy_has_egl() )
	{
		why = "libEGL is not installed (package libegl1)";
		return nullptr;
	}
	if ( !epoxy_has_egl_extension( EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless" ) ||
		!epoxy_has_egl_extension( EGL_NO_DISPLAY, "EGL_EXT_platform_base" ) )
	{
		why = "this EGL cannot draw without a screen (EGL_MESA_platform_surfaceless is missing; Mesa's is in package libegl-mesa0)";
		return nullptr;
	}
	std::unique_ptr<Offscreen> made( new Offscreen );
	EGLDisplay display = eglGetPlatformDisplayEXT( EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr );
	if ( display == EGL_NO_DISPLAY || !eglInitialize( display, nullptr, nullptr ) )
	{
		why = "EGL does not start (the drivers are in package libgl1-mesa-dri)";
		return nullptr;
	}
	made->m_handles->display = display;
	const EGLint asked[] = { EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
		EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE };
	if ( !eglBindAPI( EGL_OPENGL_API ) )
	{
		why = "EGL knows no desktop OpenGL";
		return nullptr;
	}
	made->m_handles->context = eglCreateContext( display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, asked );
	if ( made->m_handles->context == EGL_NO_CONTEXT ||
		!eglMakeCurrent( display, EGL_NO_SURFACE, EGL_NO_SURFACE, made->m_handles->context ) )
	{
		why = "EGL makes no OpenGL 3.3 context without a surface";
		return nullptr;
	}
	return made;
}

std::string Offscreen::driver() const
{
	const GLubyte* name = glGetString( GL_RENDERER );
	return name != nullptr ? reinterpret_cast<const char*>( name ) : "unknown";
}

} // namespace pliant_glue
