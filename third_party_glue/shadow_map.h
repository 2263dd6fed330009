#pragma once

// Depth as a light sees it. Private to the renderer.

#include "third_party_glue/draw_list.h"
#include "third_party_glue/gl_objects.h"

#include <glm/glm.hpp>

namespace pliant_glue {

/// A depth texture that a shader compares with, and the camera it is seen from.
struct ShadowMap
{
	GlTexture texture;
	GlFramebuffer framebuffer;
	int size = 0;
	glm::mat4 viewProjection = glm::mat4( 1.0f );

	void allocate( int edge );
	void aim( const DrawLight& light, const glm::vec3& toLight );

	/// Clip space [-1, 1] to texture space [0, 1].
	glm::mat4 lookUp() const;
};

} // namespace pliant_glue
