#pragma once

// A renderer's buffers for a body that is skinned on the GPU, and the shader in C++. The buffers are updated as by a renderer: only the
// listed changes are copied.

#include "pliant/render/gpu_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pliant::test {

using Float3 = std::array<float, 3>;

inline Float3 operator+( const Float3& a, const Float3& b )
{
	return { a[0] + b[0], a[1] + b[1], a[2] + b[2] };
}
inline Float3 operator-( const Float3& a, const Float3& b )
{
	return { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
}
inline Float3 operator*( float s, const Float3& a )
{
	return { s * a[0], s * a[1], s * a[2] };
}
inline Float3 crossOf( const Float3& a, const Float3& b )
{
	return { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
}
inline float lengthOf( const Float3& a )
{
	return std::sqrt( a[0] * a[0] + a[1] * a[1] + a[2] * a[2] );
}

template <class T>
struct SkinBuffer
{
	std::vector<T> entries;
	unsigned version = 0;
	std::size_t sent = 0; ///< bytes copied by the last `follow`

	void follow( const SkinArray<T>& array )
	{
		sent = 0;
		if ( array.version == version )
		{
			return;
		}
		entries.resize( std::size_t( array.count ) );
		if ( version != 0 && array.changedSince == version )
		{
			for ( int r = 0; r < array.changedCount; ++r )
			{
				copy( array, array.changed[r].first, array.changed[r].count );
			}
		}
		else
		{
			copy( array, 0, std::size_t( array.count ) );
		}
		version = array.version;
	}

private:
	void copy( const SkinArray<T>& array, std::size_t first, std::size_t count )
	{
		std::copy_n( array.data + first, count, entries.begin() + std::ptrdiff_t( first ) );
		sent += count * sizeof( T );
	}
};

class RendererBuffers
{
public:
	std::vector<Float3> positions, normals; ///< relative to the view's origin
	std::vector<std::uint32_t> indices;
	std::size_t sentByEvents = 0, sentByFrame = 0; ///< bytes, of the last `draw`

	void draw( const GpuSurfaceView& view )
	{
		m_vertices.follow( view.vertices );
		m_influences.follow( view.influences );
		m_mixes.follow( view.mixes );
		m_corners.follow( view.corners );
		m_indices.follow( view.indices );
		m_nodeOfCell.follow( view.nodeOfCell );
		m_offsets.follow( view.offsets );
		indices = m_indices.entries;
		sentByEvents = m_vertices.sent + m_influences.sent + m_mixes.sent + m_corners.sent + m_indices.sent + m_nodeOfCell.sent +
			m_offsets.sent;
		m_maps.assign( view.nodeTransforms, view.nodeTransforms + 12 * std::size_t( view.nodeCount ) );
		sentByFrame = m_maps.size() * sizeof( float );
		std::copy_n( view.offsetTurn, 9, m_turn.begin() );
		const std::size_t count = m_vertices.entries.size();
		positions.resize( count );
		normals.resize( count );
		for ( std::uint32_t v = 0; v < count; ++v )
		{
			positions[v] = positionOf( v );
		}
		for ( std::uint32_t v = 0; v < count; ++v )
		{
			normals[v] = normalOf( v );
		}
	}
	/// Change of a vertex's normal, rad, if the corners of its triangles are off by `error`, m: large for slivers.
	float normalErrorAt( std::uint32_t v, float error ) const
	{
		float sum = 0.0f;
		for ( std::uint32_t c = m_vertices.entries[v].corner; c != kSkinNone; c = m_corners.entries[c].next )
		{
			const std::uint32_t first = c - c % 3;
			const auto at = [&]( std::uint32_t k ) { return positions[m_corners.entries[first + k].vertex]; };
			sum += error * ( lengthOf( at( 1 ) - at( 0 ) ) + lengthOf( at( 2 ) - at( 0 ) ) );
		}
		const float area = lengthOf( areaOf( v ) );
		return area > 0.0f ? sum / area : 4.0f;
	}
	/// Twice the area of the triangles whose mean is a vertex's normal, as a vector.
	Float3 areaOf( std::uint32_t v ) const
	{
		Float3 sum = { 0, 0, 0 };
		for ( std::uint32_t c = m_vertices.entries[v].corner; c != kSkinNone; c = m_corners.entries[c].next )
		{
			const std::uint32_t first = c - c % 3;
			const auto at = [&]( std::uint32_t k ) { return positions[m_corners.entries[first + k].vertex]; };
			sum = sum + crossOf( at( 1 ) - at( 0 ), at( 2 ) - at( 0 ) );
		}
		return sum;
	}
	bool isMixed( std::uint32_t v ) const { return m_vertices.entries[v].count == 0; }

	/// blend( v ) ( direction, last )
	Float3 blended( std::uint32_t v, const float* direction, float last ) const
	{
		const SkinVertex& vertex = m_vertices.entries[v];
		Float3 sum = { 0, 0, 0 };
		for ( std::uint32_t k = vertex.first; k < vertex.first + vertex.count; ++k )
		{
			const SkinInfluence& influence = m_influences.entries[k];
			const std::uint32_t node = m_nodeOfCell.entries.empty() ? influence.cell : m_nodeOfCell.entries[influence.cell];
			const float* const m = m_maps.data() + 12 * std::size_t( node );
			for ( std::size_t row = 0; row < 3; ++row )
			{
				const float* const at = m + 4 * row;
				sum[row] += influence.weight * ( at[0] * direction[0] + at[1] * direction[1] + at[2] * direction[2] + at[3] * last );
			}
		}
		return sum;
	}
	template <class Of>
	Float3 mixed( std::uint32_t v, Of&& of ) const
	{
		const SkinMix& mix = m_mixes.entries[m_vertices.entries[v].first];
		return mix.weight[0] * of( mix.vertex[0] ) + mix.weight[1] * of( mix.vertex[1] ) + mix.weight[2] * of( mix.vertex[2] );
	}

private:
	static Float3 normalised( const Float3& a )
	{
		const float length = lengthOf( a );
		return length > 0.0f ? ( 1.0f / length ) * a : a;
	}
	Float3 skinned( std::uint32_t v ) const
	{
		const Float3 at = blended( v, m_vertices.entries[v].rest, 1.0f );
		if ( m_offsets.entries.empty() )
		{
			return at;
		}
		const float* const o = m_offsets.entries[v].offset;
		const auto row = [&]( std::size_t r ) { return m_turn[3 * r] * o[0] + m_turn[3 * r + 1] * o[1] + m_turn[3 * r + 2] * o[2]; };
		return at + Float3{ row( 0 ), row( 1 ), row( 2 ) };
	}
	Float3 positionOf( std::uint32_t v ) const
	{
		return isMixed( v ) ? mixed( v, [this]( std::uint32_t c ) { return skinned( c ); } ) : skinned( v );
	}
	Float3 plainNormal( std::uint32_t v ) const
	{
		const SkinVertex& vertex = m_vertices.entries[v];
		const Float3 area = areaOf( v );
		if ( !( lengthOf( area ) > 0.0f ) )
		{
			return normalised( blended( v, vertex.restNormal, 0.0f ) );
		}
		const float* const s = vertex.normalShift;
		const bool isShifted = s[0] != 0.0f || s[1] != 0.0f || s[2] != 0.0f;
		return isShifted ? normalised( normalised( area ) + blended( v, s, 0.0f ) ) : normalised( area );
	}
	Float3 normalOf( std::uint32_t v ) const
	{
		return isMixed( v ) ? normalised( mixed( v, [this]( std::uint32_t c ) { return plainNormal( c ); } ) ) : plainNormal( v );
	}

	SkinBuffer<SkinVertex> m_vertices;
	SkinBuffer<SkinInfluence> m_influences;
	SkinBuffer<SkinMix> m_mixes;
	SkinBuffer<SkinCorner> m_corners;
	SkinBuffer<std::uint32_t> m_indices, m_nodeOfCell;
	SkinBuffer<SkinOffset> m_offsets;
	std::vector<float> m_maps;
	std::array<float, 9> m_turn{};
};

} // namespace pliant::test
