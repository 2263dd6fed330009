// +-----------------------------------------------------------------------------------------------------------------+
// | PNG through stb_image_write.                                                                                     |
// +-----------------------------------------------------------------------------------------------------------------+

#include "third_party_glue/png_file.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#if defined( __GNUC__ )
	#pragma GCC diagnostic push
	#pragma GCC diagnostic ignored "-Wunused-function"
	#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
	#pragma GCC diagnostic ignored "-Wsign-compare"
#endif
#include <stb/stb_image_write.h>
#if defined( __GNUC__ )
	#pragma GCC diagnostic pop
#endif

namespace pliant_glue {

bool writePng( const std::string& path, const Picture& picture )
{
	if ( picture.rgb.size() != std::size_t( picture.width ) * std::size_t( picture.height ) * 3 || picture.rgb.empty() )
	{
		return false;
	}
	return stbi_write_png( path.c_str(), picture.width, picture.height, 3, picture.rgb.data(), picture.width * 3 ) != 0;
}

} // namespace pliant_glue
