#pragma once

// 8-bit RGB pictures into PNG files.

#include <cstdint>
#include <string>
#include <vector>

namespace pliant_glue {

/// Rows from the top, three bytes a pixel.
struct Picture
{
	int width = 0;
	int height = 0;
	std::vector<std::uint8_t> rgb;
};

/// False when the file could not be written.
bool writePng( const std::string& path, const Picture& picture );

} // namespace pliant_glue
