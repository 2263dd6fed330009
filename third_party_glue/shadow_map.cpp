// +-----------------------------------------------------------------------------------------------------------------+
// | An orthographic depth map around a ball in which shadows fall.                                                   |
// +-----------------------------------------------------------------------------------------------------------------+

#include "third_party_glue/shadow_map.h"

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>

namespace pliant_glue {

void ShadowMap::allocate( int edge )
{
	size = edge;
	glBindTexture( GL_TEXTURE_2D, texture.name() );
	glTexImage2D( GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, edge, edge, 0, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, nullptr );
	glTexParameteri( GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR );
	glTexParameteri( GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR );
	glTexParameteri( GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE );
	glTexParameteri( GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE );
	glTexParameteri( GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE );
	glBindFramebuffer( GL_FRAMEBUFFER, framebuffer.name() );
	glFramebufferTexture2D( GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texture.name(), 0 );
	glDrawBuffer( GL_NONE );
	glReadBuffer( GL_NONE );
}

void ShadowMap::aim( const DrawLight& light, const glm::vec3& toLight )
{
	const float radius = light.shadowRadius;
	const glm::vec3 centre( light.shadowCentre[0], light.shadowCentre[1], light.shadowCentre[2] );
	const glm::vec3 up = std::abs( toLight.y ) > 0.99f ? glm::vec3( 0, 0, 1 ) : glm::vec3( 0, 1, 0 );
	viewProjection = glm::ortho( -radius, radius, -radius, radius, 0.0f, 4 * radius ) *
		glm::lookAt( centre + toLight * 2.0f * radius, centre, up );
}

glm::mat4 ShadowMap::lookUp() const
{
	return glm::translate( glm::mat4( 1.0f ), glm::vec3( 0.5f ) ) * glm::scale( glm::mat4( 1.0f ), glm::vec3( 0.5f ) ) * viewProjection;
}

} // namespace pliant_glue
