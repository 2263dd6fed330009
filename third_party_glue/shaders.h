#pragma once

// The renderer's GLSL programs as text.

namespace pliant_glue {

/// What a program draws; each is a section of the same two sources.
enum class Program : int
{
	Mesh,
	Box,
	Sphere,
	Ground,
	Sky,
	Line,
	ShadowMesh,
	ShadowInstance,
	Count
};

/// The #define line that picks a program's section.
const char* programDefine( Program program );
extern const char* const kVertexSource;
extern const char* const kFragmentSource;

} // namespace pliant_glue
