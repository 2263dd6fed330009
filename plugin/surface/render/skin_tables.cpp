#include "surface/render/skin_tables.h"

namespace pliant {

namespace {

// Entries are compared by their bytes.
static_assert( sizeof( SkinVertex ) == 48 && sizeof( SkinInfluence ) == 8 && sizeof( SkinMix ) == 32 && sizeof( SkinCorner ) == 8 &&
	sizeof( SkinOffset ) == 16 );

void copy3( const Vec3& from, float* to )
{
	std::copy_n( from.data(), 3, to );
}

SkinMix mixOf( const SkinBinding::Placed& placed )
{
	SkinMix mix{};
	std::copy( placed.corner.begin(), placed.corner.end(), mix.vertex );
	std::copy( placed.weight.begin(), placed.weight.end(), mix.weight );
	return mix;
}

/// A mix for each interpolated vertex. Returns the indices by vertex, kSkinNone for all others.
std::vector<std::uint32_t> takeMixes( const SkinBinding& binding, std::vector<SkinMix>& mixes )
{
	std::vector<std::uint32_t> place( binding.placed.empty() ? 0 : binding.restPosition.size(), kSkinNone );
	for ( const SkinBinding::Placed& placed : binding.placed )
	{
		place[placed.vertex] = std::uint32_t( mixes.size() );
		mixes.push_back( mixOf( placed ) );
	}
	for ( const SkinBinding::Placed& placed : binding.placed ) // copies lie where their carrier does
	{
		const std::uint32_t carrier = binding.carrierOf( placed.vertex );
		mixes[place[placed.vertex]] = place[carrier] != kSkinNone ? mixes[place[carrier]] : mixes[place[placed.vertex]];
	}
	return place;
}

void writeVertices( const SkinBinding& binding, const std::vector<std::uint32_t>& mixPlace, std::vector<SkinVertex>& vertices )
{
	vertices.resize( binding.restPosition.size() );
	for ( std::size_t v = 0; v < vertices.size(); ++v )
	{
		SkinVertex& to = vertices[v];
		const std::uint32_t carrier = binding.carrierOf( v );
		const bool isMixed = !mixPlace.empty() && mixPlace[v] != kSkinNone;
		copy3( binding.restPosition[carrier], to.rest );
		copy3( binding.restNormal[v], to.restNormal );
		copy3( binding.normalShiftOf( v ), to.normalShift );
		to.first = isMixed ? mixPlace[v] : binding.start[carrier];
		to.count = isMixed ? 0 : binding.start[carrier + 1] - binding.start[carrier];
	}
}

/// Corners of the triangles that count for normals, each in the list of its group.
void writeCorners( const SkinBinding& binding, const SkinTriangles& triangles, SkinTables& tables )
{
	const std::size_t shading = binding.shading.size();
	const std::size_t after = std::size_t( triangles.count ) - binding.shadedTriangles;
	std::vector<SkinCorner>& corners = tables.corners;
	corners.assign( 3 * ( shading + after ), SkinCorner{ kSkinNone, kSkinNone } );
	const auto write = [&corners]( std::size_t place, const std::uint32_t* three ) {
		for ( std::size_t k = 0; k < 3; ++k )
		{
			corners[3 * place + k].vertex = three[k];
		}
	};
	for ( std::size_t k = 0; k < shading; ++k )
	{
		write( k, binding.shading[k].data() );
	}
	for ( std::size_t k = 0; k < after; ++k )
	{
		write( shading + k, triangles.indices + 3 * ( binding.shadedTriangles + k ) );
	}
	std::vector<std::uint32_t> head( std::size_t( binding.normalGroups ), kSkinNone );
	for ( std::size_t k = corners.size(); k-- > 0; ) // from the back: lists ascend
	{
		if ( corners[k].vertex != kSkinNone )
		{
			std::uint32_t& first = head[binding.normalGroup[corners[k].vertex]];
			corners[k].next = first;
			first = std::uint32_t( k );
		}
	}
	for ( std::size_t v = 0; v < tables.vertices.size(); ++v )
	{
		tables.vertices[v].corner = head[binding.normalGroup[v]];
	}
}

template <class T>
SkinArray<T> wholeArray( const T* data, std::size_t count )
{
	return { count > 0 ? data : nullptr, int( count ), 1, 1, nullptr, 0 };
}

} // namespace

SkinTables makeSkinTables( const SkinBinding& binding, const SkinTriangles& triangles )
{
	SkinTables tables;
	const std::vector<std::uint32_t> mixPlace = takeMixes( binding, tables.mixes );
	writeVertices( binding, mixPlace, tables.vertices );
	tables.influences.resize( binding.node.size() );
	for ( std::size_t k = 0; k < binding.node.size(); ++k )
	{
		tables.influences[k] = { binding.node[k], binding.weight[k] };
	}
	writeCorners( binding, triangles, tables );
	return tables;
}

// === Streams ===

void SkinTableStreams::showWhole( std::shared_ptr<const SkinTables> whole, const SkinTriangles& triangles )
{
	m_whole = std::move( whole );
	m_wholeTriangles = triangles;
}

void SkinTableStreams::showCracks( const SkinBinding& binding, const SkinTriangles& triangles )
{
	SkinTables tables = makeSkinTables( binding, triangles );
	std::vector<std::uint32_t> indices( triangles.indices, triangles.indices + 3 * std::size_t( triangles.count ) );
	if ( m_whole )
	{
		m_vertices.publishAfter( m_whole->vertices, 1, std::move( tables.vertices ) );
		m_influences.publishAfter( m_whole->influences, 1, std::move( tables.influences ) );
		m_mixes.publishAfter( m_whole->mixes, 1, std::move( tables.mixes ) );
		m_corners.publishAfter( m_whole->corners, 1, std::move( tables.corners ) );
		m_indices.publishAfter(
			{ m_wholeTriangles.indices, m_wholeTriangles.indices + 3 * std::size_t( m_wholeTriangles.count ) }, 1, std::move( indices ) );
		m_whole.reset();
		return;
	}
	m_vertices.publish( std::move( tables.vertices ) );
	m_influences.publish( std::move( tables.influences ) );
	m_mixes.publish( std::move( tables.mixes ) );
	m_corners.publish( std::move( tables.corners ) );
	m_indices.publish( std::move( indices ) );
}

void SkinTableStreams::showLevels( const std::uint32_t* nodeOfCell, std::size_t cells )
{
	m_nodeOfCell.publish( nodeOfCell ? std::vector<std::uint32_t>( nodeOfCell, nodeOfCell + cells ) : std::vector<std::uint32_t>() );
}

SkinArray<SkinVertex> SkinTableStreams::vertices() const
{
	return m_whole ? wholeArray( m_whole->vertices.data(), m_whole->vertices.size() ) : m_vertices.view();
}

SkinArray<SkinInfluence> SkinTableStreams::influences() const
{
	return m_whole ? wholeArray( m_whole->influences.data(), m_whole->influences.size() ) : m_influences.view();
}

SkinArray<SkinMix> SkinTableStreams::mixes() const
{
	return m_whole ? wholeArray( m_whole->mixes.data(), m_whole->mixes.size() ) : m_mixes.view();
}

SkinArray<SkinCorner> SkinTableStreams::corners() const
{
	return m_whole ? wholeArray( m_whole->corners.data(), m_whole->corners.size() ) : m_corners.view();
}

SkinArray<std::uint32_t> SkinTableStreams::indices() const
{
	return m_whole ? wholeArray( m_wholeTriangles.indices, 3 * std::size_t( m_wholeTriangles.count ) ) : m_indices.view();
}

} // namespace pliant
