#pragma once

// An OpenGL 3.3 context without a window, a screen or a GPU: EGL on Mesa's surfaceless platform.

#include <memory>
#include <string>

namespace pliant_glue {

class Offscreen
{
public:
	/// Null when there is no such context; `why` then says so. The context is current on the calling thread.
	static std::unique_ptr<Offscreen> create( std::string& why );
	~Offscreen();
	Offscreen( const Offscreen& ) = delete;
	Offscreen& operator=( const Offscreen& ) = delete;

	/// The driver's name, e.g. "llvmpipe (LLVM 15.0.6, 256 bits)".
	std::string driver() const;

private:
	Offscreen();
	struct Handles;
	std::unique_ptr<Handles> m_handles;
};

} // namespace pliant_glue
