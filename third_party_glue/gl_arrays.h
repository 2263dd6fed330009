#pragma once

// Arrays of vertices and of instances on the GPU. Private to the renderer.

#include "third_party_glue/draw_list.h"
#include "third_party_glue/gl_objects.h"
#include "third_party_glue/primitives.h"

#include <cstddef>
#include <vector>

namespace pliant_glue {

enum Attribute : GLuint
{
	Position,
	Normal,
	AxisX,
	AxisY,
	AxisZ,
	Place,
	InstanceColour ///< of an instance, of a line's end, of a mesh's vertex
};

void sendArray( GlBuffer& buffer, GLenum target, const void* data, std::size_t bytes );
/// Three floats a vertex of the bound buffer.
void describe( GLuint attribute, std::size_t stride, std::size_t offset );

struct GpuInstances
{
	GlArrays arrays;
	GlBuffer positions, normals, indices, instances;
	int indexCount = 0;
	int count = 0;
};

void prepareInstances( GpuInstances& to, const Primitive& shape );
void uploadInstances( GpuInstances& to, const std::vector<DrawInstance>& from );
void drawInstances( GpuInstances& of );

} // namespace pliant_glue
