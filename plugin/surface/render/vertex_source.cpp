// Attributes of drawn vertices from those of the input's. No part of the skin: it needs no feature.

#include "pliant/render/vertex_source.h"

#include <algorithm>
#include <cstddef>

namespace pliant {

Status interpolateAttribute( const VertexSourceView& vertices, const float* input, int components, const float* inside, float* out )
{
	if ( !input || !out || components < 1 || vertices.vertexCount < 0 )
	{
		return { ResultCode::BadArgument,
			"interpolateAttribute: the arrays must not be null, components at least 1, and the number of vertices not negative." };
	}
	const std::size_t width = std::size_t( components ), count = std::size_t( vertices.vertexCount );
	if ( !vertices.sources )
	{
		std::copy_n( input, width * count, out );
		return {};
	}
	for ( std::size_t v = 0; v < count; ++v )
	{
		const VertexSource& source = vertices.sources[v];
		const bool isInside = source.vertex[0] == VertexSource::kInside;
		for ( std::size_t c = 0; c < width; ++c )
		{
			const auto at = [&]( int k ) { return source.weight[k] * input[width * std::size_t( source.vertex[k] ) + c]; };
			out[width * v + c] = !isInside ? ( at( 0 ) + at( 1 ) ) + at( 2 ) : inside ? inside[c] : 0.0f;
		}
	}
	return {};
}

} // namespace pliant
