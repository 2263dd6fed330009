#pragma once

// The shader programs of shaders.h, compiled. Private to the renderer.

#include "third_party_glue/gl_objects.h"
#include "third_party_glue/shaders.h"

#include <array>
#include <string>

namespace pliant_glue {

using GlPrograms = std::array<GlProgram, std::size_t( Program::Count )>;

/// False when one does not compile or link; `why` then says so.
bool buildPrograms( GlPrograms& programs, std::string& why );

/// Links a vertex shader alone, whose output `varying` is fed back into a buffer. False as above.
bool buildFeedback( GLuint program, const char* define, const char* source, const char* varying, std::string& why );

} // namespace pliant_glue
