#pragma once

// The binding of a skin as the records that a GPU reads (pliant/render/skin_tables.h). Steinemann et al. 2008, section 7.

#include "pliant/render/skin_tables.h"
#include "surface/constants.h"
#include "surface/skin/skinning.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

namespace pliant {

/// An array as it was last published, and the last change.
template <class T>
class SkinStream
{
public:
	/// Replaces the entries by `next`, and compares them with those of the version before.
	void publish( std::vector<T>&& next ) { replace( m_entries, m_version, std::move( next ) ); }
	/// The same where the version before, of number `version`, was somebody else's entries.
	void publishAfter( const std::vector<T>& before, unsigned version, std::vector<T>&& next )
	{
		replace( before, version, std::move( next ) );
	}
	SkinArray<T> view() const
	{
		return { m_entries.empty() ? nullptr : m_entries.data(), int( m_entries.size() ), m_version, m_since, m_ranges.data(),
			int( m_ranges.size() ) };
	}

private:
	void replace( const std::vector<T>& before, unsigned version, std::vector<T>&& next )
	{
		if ( version == 0 )
		{
			m_version = m_since = 1;
			m_ranges.clear();
		}
		else if ( const std::size_t common = std::min( before.size(), next.size() );
				  before.size() != next.size() || ( common > 0 && std::memcmp( before.data(), next.data(), common * sizeof( T ) ) != 0 ) )
		{
			m_ranges.clear();
			for ( std::size_t first = 0; first < next.size(); first += kStreamBlock )
			{
				const std::size_t last = std::min( first + kStreamBlock, next.size() );
				if ( last > common || std::memcmp( before.data() + first, next.data() + first, ( last - first ) * sizeof( T ) ) != 0 )
				{
					append( std::uint32_t( first ), std::uint32_t( last ) );
				}
			}
			m_since = version;
			m_version = version + 1;
		}
		else
		{
			m_version = version;
		}
		m_entries = std::move( next );
	}
	void append( std::uint32_t first, std::uint32_t last )
	{
		if ( !m_ranges.empty() && m_ranges.back().first + m_ranges.back().count == first )
		{
			m_ranges.back().count += last - first;
			return;
		}
		m_ranges.push_back( { first, last - first } );
	}

	std::vector<T> m_entries;
	std::vector<SkinRange> m_ranges;
	unsigned m_version = 0, m_since = 0; ///< 0: nothing published yet
};

/// The tables of one drawn surface.
struct SkinTables
{
	std::vector<SkinVertex> vertices;
	std::vector<SkinInfluence> influences;
	std::vector<SkinMix> mixes;
	std::vector<SkinCorner> corners;
};

/// Tables of a binding and its drawn triangles.
SkinTables makeSkinTables( const SkinBinding& binding, const SkinTriangles& triangles );

/// The published data of one body.
class SkinTableStreams
{
public:
	/// Shows a body that has not broken: its template's tables.
	void showWhole( std::shared_ptr<const SkinTables> whole, const SkinTriangles& triangles );
	/// Shows a cracked surface.
	void showCracks( const SkinBinding& binding, const SkinTriangles& triangles );
	/// By cell its node; none: cells are nodes.
	void showLevels( const std::uint32_t* nodeOfCell, std::size_t cells );
	void showOffsets( std::vector<SkinOffset>&& offsets ) { m_offsets.publish( std::move( offsets ) ); }

	SkinArray<SkinVertex> vertices() const;
	SkinArray<SkinInfluence> influences() const;
	SkinArray<SkinMix> mixes() const;
	SkinArray<SkinCorner> corners() const;
	SkinArray<std::uint32_t> indices() const;
	SkinArray<std::uint32_t> nodeOfCell() const { return m_nodeOfCell.view(); }
	SkinArray<SkinOffset> offsets() const { return m_offsets.view(); }

private:
	std::shared_ptr<const SkinTables> m_whole; ///< null: the streams are the body's own
	SkinTriangles m_wholeTriangles;
	SkinStream<SkinVertex> m_vertices;
	SkinStream<SkinInfluence> m_influences;
	SkinStream<SkinMix> m_mixes;
	SkinStream<SkinCorner> m_corners;
	SkinStream<std::uint32_t> m_indices, m_nodeOfCell;
	SkinStream<SkinOffset> m_offsets;
};

} // namespace pliant
