#pragma once

// Draws a DrawList with OpenGL 3.3 into whatever context is current: a window's or an offscreen one.

#include "third_party_glue/draw_list.h"
#include "third_party_glue/png_file.h"

#include <memory>
#include <string>

namespace pliant_glue {

class Renderer
{
public:
	/// Null when the context is too old or a shader does not compile; `why` then says so.
	static std::unique_ptr<Renderer> create( std::string& why );
	~Renderer();
	Renderer( const Renderer& ) = delete;
	Renderer& operator=( const Renderer& ) = delete;

	/// Draw into the window's own framebuffer.
	void draw( const DrawList& list, int width, int height );

	/// Draw into memory, `supersampling` times as wide and high (1 to 4), and shrink it.
	Picture drawPicture( const DrawList& list, int width, int height, float supersampling );

	/// What the GPU made of a mesh in the last picture: positions of 4 floats, normals of 3. False for a mesh not skinned on the GPU.
	bool readSkin( std::uint64_t id, int vertexCount, std::vector<float>& positions, std::vector<float>& normals );

private:
	struct Device;
	explicit Renderer( std::unique_ptr<Device> device );
	std::unique_ptr<Device> m_device;
};

} // namespace pliant_glue
