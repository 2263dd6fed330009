#pragma once

// Skins meshes on the GPU into buffers of positions and normals, which are then drawn as any others. Two passes of a vertex shader with
// transform feedback, OpenGL 3.3. Private to the renderer.

#include "third_party_glue/draw_list.h"
#include "third_party_glue/gl_objects.h"

#include <array>
#include <string>

namespace pliant_glue {

/// The tables of one mesh on the GPU.
class SkinOnGpu
{
public:
	/// Brings tables and transforms up to date.
	void upload( const DrawSkin& skin );

	/// Positions of 4 floats and normals of 3 floats per vertex, in buffers that the skinner writes.
	GlBuffer positions, normals;

private:
	friend class GpuSkinner;
	enum Table : int
	{
		Vertices,
		Influences,
		Mixes,
		Corners,
		NodeOfCell,
		Offsets,
		Transforms,
		Positions, ///< `positions`, as the second pass reads them
		Count
	};
	struct Buffer
	{
		GlBuffer buffer;
		GlTexture texture;
		std::size_t capacity = 0; ///< bytes
		unsigned version = 0;
	};
	void send( Table table, GLenum format, const DrawTable& from );

	std::array<Buffer, Count> m_tables;
	std::size_t m_room = 0; ///< vertices that `positions` and `normals` have room for
	int m_vertexCount = 0;
	bool m_hasLevels = false, m_hasOffsets = false;
	std::array<float, 9> m_offsetTurn{};
};

class GpuSkinner
{
public:
	/// False when a shader does not compile; `why` then says so.
	bool build( std::string& why );
	/// Writes positions and normals of a mesh whose tables are up to date.
	void skin( SkinOnGpu& mesh );

private:
	void pass( SkinOnGpu& mesh, GlProgram& program, GlBuffer& to );

	GlProgram m_positions, m_normals;
	GlArrays m_noArrays; ///< OpenGL wants an array object even where nothing is read from one
};

} // namespace pliant_glue
