// +-----------------------------------------------------------------------------------------------------------------+
// | One frame: depth as the sun sees it, depth as the sky sees it, then the picture. Meshes are streamed anew each    |
// | frame; rigid bodies are instances of a cube and a sphere.                                                        |
// +-----------------------------------------------------------------------------------------------------------------+

#include "third_party_glue/renderer.h"

#include "third_party_glue/gl_arrays.h"
#include "third_party_glue/gl_programs.h"
#include "third_party_glue/gpu_skin.h"
#include "third_party_glue/shadow_map.h"

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace pliant_glue {

namespace {

constexpr int kSunMapSize = 2048;
constexpr int kSkyMapSize = 192; // coarse on purpose: it is looked up blurred, and fine steps would show as stripes on walls
constexpr int kSphereSubdivisions = 3;
constexpr float kGroundExtent = 60.0f; // m from the camera's target; the fog hides the edge
constexpr float kFogDistance = 22.0f;  // m
constexpr float kNear = 0.05f, kFar = 200.0f;

glm::vec3 toGlm( const Vec3& v )
{
	return { v[0], v[1], v[2] };
}

struct GpuMesh
{
	GlArrays arrays;
	GlBuffer positions, normals, colours, indices;
	std::unique_ptr<SkinOnGpu> skin; ///< its positions and normals instead of the above; null: they are sent
	unsigned topologyVersion = 0;
	int indexCount = 0;
	unsigned lastFrame = 0;
};

} // namespace

struct Renderer::Device
{
	GlPrograms programs;
	ShadowMap sun, sky;
	std::map<std::uint64_t, GpuMesh> meshes;
	GpuInstances boxes, spheres;
	GlArrays flatArrays, lineArrays;
	GlBuffer flatBuffer, lineBuffer;
	int lineVertices = 0;
	unsigned frame = 0;
	GpuSkinner skinner;
	glm::mat4 viewProjection = glm::mat4( 1.0f );
	glm::vec3 eye = glm::vec3( 0.0f );
	glm::vec3 toSun = glm::vec3( 0, 1, 0 );

	// the picture in memory, and its shrunken copy
	GlFramebuffer largeTarget, smallTarget;
	GlRenderbuffer largeColour, largeDepth, smallColour;
	int largeWidth = 0, largeHeight = 0, smallWidth = 0, smallHeight = 0;

	bool build( std::string& why );
	void upload( const DrawList& list );
	void uploadMesh( const DrawMesh& mesh );
	void skinMesh( GpuMesh& mesh, const DrawSkin& skin );
	GLuint use( Program program );
	void drawDepth( const DrawList& list, const ShadowMap& map );
	void drawMeshes( const DrawList& list, GLuint program );
	void drawScene( const DrawList& list, int width, int height, GLuint target );
	void drawGround( const DrawList& list );
	void allocateTargets( int width, int height, int bigWidth, int bigHeight );
};

bool Renderer::Device::build( std::string& why )
{
	if ( epoxy_gl_version() < 33 )
	{
		why = "OpenGL 3.3 is needed";
		return false;
	}
	if ( !buildPrograms( programs, why ) || !skinner.build( why ) )
	{
		return false;
	}
	sun.allocate( kSunMapSize );
	sky.allocate( kSkyMapSize );
	prepareInstances( boxes, unitCube() );
	prepareInstances( spheres, unitSphere( kSphereSubdivisions ) );
	glBindVertexArray( flatArrays.name() );
	glBindBuffer( GL_ARRAY_BUFFER, flatBuffer.name() );
	describe( Position, 3 * sizeof( float ), 0 );
	glBindVertexArray( lineArrays.name() );
	glBindBuffer( GL_ARRAY_BUFFER, lineBuffer.name() );
	describe( Position, 6 * sizeof( float ), 0 );
	describe( InstanceColour, 6 * sizeof( float ), 3 * sizeof( float ) );
	return true;
}

void Renderer::Device::skinMesh( GpuMesh& mesh, const DrawSkin& skin )
{
	mesh.skin = mesh.skin ? std::move( mesh.skin ) : std::make_unique<SkinOnGpu>();
	mesh.skin->upload( skin );
	skinner.skin( *mesh.skin );
}

void Renderer::Device::uploadMesh( const DrawMesh& mesh )
{
	const auto [entry, isNew] = meshes.try_emplace( mesh.id );
	GpuMesh& gpu = entry->second;
	const std::size_t bytes = std::size_t( mesh.vertexCount ) * 3 * sizeof( float );
	mesh.skin ? skinMesh( gpu, *mesh.skin ) : gpu.skin.reset();
	glBindVertexArray( gpu.arrays.name() );
	if ( mesh.skin )
	{
		glBindBuffer( GL_ARRAY_BUFFER, gpu.skin->positions.name() );
		describe( Position, 4 * sizeof( float ), 0 );
		glBindBuffer( GL_ARRAY_BUFFER, gpu.skin->normals.name() );
		describe( Normal, 3 * sizeof( float ), 0 );
	}
	else
	{
		sendArray( gpu.positions, GL_ARRAY_BUFFER, mesh.positions, bytes );
		describe( Position, 3 * sizeof( float ), 0 );
		sendArray( gpu.normals, GL_ARRAY_BUFFER, mesh.normals, bytes );
		describe( Normal, 3 * sizeof( float ), 0 );
	}
	if ( mesh.vertexColours != nullptr )
	{
		sendArray( gpu.colours, GL_ARRAY_BUFFER, mesh.vertexColours, bytes );
		describe( InstanceColour, 3 * sizeof( float ), 0 );
	}
	else
	{
		glDisableVertexAttribArray( InstanceColour ); // drawMeshes then sets one colour for all
	}
	if ( isNew || gpu.topologyVersion != mesh.topologyVersion || gpu.indexCount != mesh.triangleCount * 3 )
	{
		gpu.topologyVersion = mesh.topologyVersion;
		gpu.indexCount = mesh.triangleCount * 3;
		sendArray( gpu.indices, GL_ELEMENT_ARRAY_BUFFER, mesh.indices, std::size_t( gpu.indexCount ) * sizeof( std::uint32_t ) );
	}
	gpu.lastFrame = frame;
}

void Renderer::Device::upload( const DrawList& list )
{
	++frame;
	for ( const DrawMesh& mesh : list.meshes )
	{
		uploadMesh( mesh );
	}
	std::erase_if( meshes, [&]( const auto& entry ) { return entry.second.lastFrame != frame; } );
	uploadInstances( boxes, list.boxes );
	uploadInstances( spheres, list.spheres );
	std::vector<Vec3> ends;
	ends.reserve( list.lines.size() * 4 );
	for ( const DrawLine& line : list.lines )
	{
		ends.insert( ends.end(), { line.from, line.colour, line.to, line.colour } );
	}
	sendArray( lineBuffer, GL_ARRAY_BUFFER, ends.data(), ends.size() * sizeof( Vec3 ) );
	lineVertices = int( list.lines.size() * 2 );
}

GLuint Renderer::Device::use( Program which )
{
	const GLuint program = programs[std::size_t( which )].name();
	const auto place = [&]( const char* name ) { return glGetUniformLocation( program, name ); };
	glUseProgram( program );
	glUniformMatrix4fv( place( "uViewProjection" ), 1, GL_FALSE, glm::value_ptr( viewProjection ) );
	glUniformMatrix4fv( place( "uInverseViewProjection" ), 1, GL_FALSE, glm::value_ptr( glm::inverse( viewProjection ) ) );
	glUniformMatrix4fv( place( "uToShadow" ), 1, GL_FALSE, glm::value_ptr( sun.lookUp() ) );
	glUniformMatrix4fv( place( "uToSkyShadow" ), 1, GL_FALSE, glm::value_ptr( sky.lookUp() ) );
	glUniform3fv( place( "uEye" ), 1, glm::value_ptr( eye ) );
	glUniform3fv( place( "uToSun" ), 1, glm::value_ptr( toSun ) );
	glUniform3f( place( "uOrigin" ), 0, 0, 0 );
	glUniform1i( place( "uShadowMap" ), 0 );
	glUniform1i( place( "uSkyShadowMap" ), 1 );
	glUniform2f( place( "uShadowMapTexel" ), 1.0f / float( sun.size ), 1.0f / float( sun.size ) );
	// viewProjection scales by 1 / radius: a texel's edge in metres follows from its first row.
	const glm::vec3 row( sun.viewProjection[0][0], sun.viewProjection[1][0], sun.viewProjection[2][0] );
	glUniform1f( place( "uShadowTexel" ), 2.0f / ( glm::length( row ) * float( sun.size ) ) );
	glUniform1f( place( "uFogDistance" ), kFogDistance );
	return program;
}

void Renderer::Device::drawMeshes( const DrawList& list, GLuint program )
{
	for ( const DrawMesh& mesh : list.meshes )
	{
		GpuMesh& gpu = meshes.at( mesh.id );
		glUniform3fv( glGetUniformLocation( program, "uOrigin" ), 1, mesh.origin.data() );
		glBindVertexArray( gpu.arrays.name() );
		glVertexAttrib3fv( InstanceColour, mesh.colour.data() );
		glDrawElements( GL_TRIANGLES, gpu.indexCount, GL_UNSIGNED_INT, nullptr );
	}
}

void Renderer::Device::drawDepth( const DrawList& list, const ShadowMap& map )
{
	const glm::mat4 kept = viewProjection;
	viewProjection = map.viewProjection;
	glViewport( 0, 0, map.size, map.size );
	glClear( GL_DEPTH_BUFFER_BIT );
	glEnable( GL_POLYGON_OFFSET_FILL );
	glPolygonOffset( 1.5f, 3.0f );
	drawMeshes( list, use( Program::ShadowMesh ) );
	use( Program::ShadowInstance );
	drawInstances( boxes );
	drawInstances( spheres );
	glDisable( GL_POLYGON_OFFSET_FILL );
	viewProjection = kept;
}

void Renderer::Device::drawGround( const DrawList& list )
{
	const Vec3& at = list.camera.target;
	const float e = kGroundExtent, y = list.groundHeight;
	const float corners[] = { at[0] - e, y, at[2] - e, at[0] - e, y, at[2] + e, at[0] + e, y, at[2] - e, at[0] + e, y, at[2] + e };
	glBindVertexArray( flatArrays.name() );
	sendArray( flatBuffer, GL_ARRAY_BUFFER, corners, sizeof( corners ) );
	glVertexAttrib3f( Normal, 0, 1, 0 );
	use( Program::Ground );
	glDrawArrays( GL_TRIANGLE_STRIP, 0, 4 );
}

void Renderer::Device::drawScene( const DrawList& list, int width, int height, GLuint target )
{
	upload( list );
	eye = toGlm( list.camera.eye );
	toSun = glm::normalize( toGlm( list.light.toSun ) );
	viewProjection = glm::perspective( glm::radians( list.camera.fieldOfView ), float( width ) / float( height ), kNear, kFar ) *
		glm::lookAt( eye, toGlm( list.camera.target ), glm::vec3( 0, 1, 0 ) );
	sun.aim( list.light, toSun );
	sky.aim( list.light, glm::vec3( 0, 1, 0 ) );
	glEnable( GL_DEPTH_TEST );
	glDepthMask( GL_TRUE );
	glDepthFunc( GL_LEQUAL );
	glDisable( GL_BLEND );
	glDisable( GL_CULL_FACE );
	glDisable( GL_SCISSOR_TEST );
	for ( ShadowMap* map : { &sun, &sky } )
	{
		glBindFramebuffer( GL_FRAMEBUFFER, map->framebuffer.name() );
		drawDepth( list, *map );
	}

	glBindFramebuffer( GL_FRAMEBUFFER, target );
	glViewport( 0, 0, width, height );
	glClear( GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT );
	glActiveTexture( GL_TEXTURE1 );
	glBindTexture( GL_TEXTURE_2D, sky.texture.name() );
	glActiveTexture( GL_TEXTURE0 );
	glBindTexture( GL_TEXTURE_2D, sun.texture.name() );
	// Near things first: what they hide is not shaded.
	drawMeshes( list, use( Program::Mesh ) );
	use( Program::Box );
	drawInstances( boxes );
	use( Program::Sphere );
	drawInstances( spheres );
	use( Program::Line );
	glBindVertexArray( lineArrays.name() );
	glDrawArrays( GL_LINES, 0, lineVertices );
	if ( list.hasGround )
	{
		drawGround( list );
	}
	const float cover[] = { -1, -1, 1, 3, -1, 1, -1, 3, 1 };
	glBindVertexArray( flatArrays.name() );
	sendArray( flatBuffer, GL_ARRAY_BUFFER, cover, sizeof( cover ) );
	use( Program::Sky );
	glDrawArrays( GL_TRIANGLES, 0, 3 );
	glBindVertexArray( 0 );
}

void Renderer::Device::allocateTargets( int width, int height, int bigWidth, int bigHeight )
{
	if ( width == smallWidth && height == smallHeight && bigWidth == largeWidth && bigHeight == largeHeight )
	{
		return;
	}
	smallWidth = width;
	smallHeight = height;
	largeWidth = bigWidth;
	largeHeight = bigHeight;
	glBindRenderbuffer( GL_RENDERBUFFER, largeColour.name() );
	glRenderbufferStorage( GL_RENDERBUFFER, GL_RGBA8, bigWidth, bigHeight );
	glBindRenderbuffer( GL_RENDERBUFFER, largeDepth.name() );
	glRenderbufferStorage( GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, bigWidth, bigHeight );
	glBindRenderbuffer( GL_RENDERBUFFER, smallColour.name() );
	glRenderbufferStorage( GL_RENDERBUFFER, GL_RGBA8, width, height );
	glBindFramebuffer( GL_FRAMEBUFFER, largeTarget.name() );
	glFramebufferRenderbuffer( GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, largeColour.name() );
	glFramebufferRenderbuffer( GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, largeDepth.name() );
	glBindFramebuffer( GL_FRAMEBUFFER, smallTarget.name() );
	glFramebufferRenderbuffer( GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, smallColour.name() );
}

Renderer::Renderer( std::unique_ptr<Device> device ) : m_device( std::move( device ) ) {}

Renderer::~Renderer() = default;

std::unique_ptr<Renderer> Renderer::create( std::string& why )
{
	auto device = std::make_unique<Device>();
	return device->build( why ) ? std::unique_ptr<Renderer>( new Renderer( std::move( device ) ) ) : nullptr;
}

void Renderer::draw( const DrawList& list, int width, int height )
{
	if ( width > 0 && height > 0 )
	{
		m_device->drawScene( list, width, height, 0 );
	}
}

Picture Renderer::drawPicture( const DrawList& list, int width, int height, float supersampling )
{
	const float factor = std::clamp( supersampling, 1.0f, 4.0f );
	const int bigWidth = int( std::lround( float( width ) * factor ) );
	const int bigHeight = int( std::lround( float( height ) * factor ) );
	Device& device = *m_device;
	device.allocateTargets( width, height, bigWidth, bigHeight );
	device.drawScene( list, bigWidth, bigHeight, device.largeTarget.name() );

	// Upside down on the way, since OpenGL counts rows from the bottom.
	glBindFramebuffer( GL_READ_FRAMEBUFFER, device.largeTarget.name() );
	glBindFramebuffer( GL_DRAW_FRAMEBUFFER, device.smallTarget.name() );
	glBlitFramebuffer( 0, 0, bigWidth, bigHeight, 0, height, width, 0, GL_COLOR_BUFFER_BIT, GL_LINEAR );
	glBindFramebuffer( GL_READ_FRAMEBUFFER, device.smallTarget.name() );
	Picture picture{ width, height, std::vector<std::uint8_t>( std::size_t( width ) * std::size_t( height ) * 3 ) };
	glPixelStorei( GL_PACK_ALIGNMENT, 1 );
	glReadPixels( 0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, picture.rgb.data() );
	return picture;
}

bool Renderer::readSkin( std::uint64_t id, int vertexCount, std::vector<float>& positions, std::vector<float>& normals )
{
	const auto found = m_device->meshes.find( id );
	if ( found == m_device->meshes.end() || !found->second.skin )
	{
		return false;
	}
	positions.resize( 4 * std::size_t( vertexCount ) );
	normals.resize( 3 * std::size_t( vertexCount ) );
	glBindBuffer( GL_ARRAY_BUFFER, found->second.skin->positions.name() );
	glGetBufferSubData( GL_ARRAY_BUFFER, 0, GLsizeiptr( positions.size() * sizeof( float ) ), positions.data() );
	glBindBuffer( GL_ARRAY_BUFFER, found->second.skin->normals.name() );
	glGetBufferSubData( GL_ARRAY_BUFFER, 0, GLsizeiptr( normals.size() * sizeof( float ) ), normals.data() );
	return true;
}

} // namespace pliant_glue
