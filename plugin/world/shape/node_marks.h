#pragma once

// A set of a body's nodes, added in any order and visited in ascending order: one bit each, which is faster than sorting a list.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pliant {

/// Keeps its memory between bodies.
class NodeMarks
{
public:
	/// Prepares for nodes of a body of `count`.
	void fit( int count ) { m_words.resize( std::max( m_words.size(), std::size_t( count ) / kBits + 1 ) ); }
	void add( int node )
	{
		const std::size_t word = std::size_t( node ) / kBits;
		m_words[word] |= std::uint64_t( 1 ) << ( std::size_t( node ) % kBits );
		m_first = std::min( m_first, word );
		m_end = std::max( m_end, word + 1 );
	}
	/// Calls visit( node ) in ascending order and empties the set.
	template <class Visit>
	void takeAll( Visit&& visit )
	{
		for ( std::size_t word = m_first; word < m_end; ++word )
		{
			for ( std::uint64_t left = m_words[word]; left != 0; left &= left - 1 )
			{
				visit( int( word * kBits ) + __builtin_ctzll( left ) );
			}
			m_words[word] = 0;
		}
		m_first = SIZE_MAX;
		m_end = 0;
	}

private:
	static constexpr std::size_t kBits = 64;

	std::vector<std::uint64_t> m_words;
	std::size_t m_first = SIZE_MAX, m_end = 0; ///< range of the nonzero words
};

} // namespace pliant
