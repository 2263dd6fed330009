#pragma once

// Finds the cells that are reachable over the links. Rivers and James 2007, section 3.

#include "lattice/lattice.h"

#include <algorithm>

namespace pliant {

/// Breadth-first search, w rounds over the links, with marks that need no clearing between searches.
class Reach
{
public:
	explicit Reach( const Lattice& lattice ) : m_lattice( lattice ), m_mark( lattice.cellCount(), 0 ) {}

	/// Ascending and including the cell itself. Valid until the next search.
	const std::vector<std::uint32_t>& from( std::uint32_t owner, int rounds )
	{
		m_found.assign( 1, owner );
		return spread( rounds );
	}

	/// The same from several distinct cells.
	const std::vector<std::uint32_t>& from( const std::vector<std::uint32_t>& owners, int rounds )
	{
		m_found = owners;
		return spread( rounds );
	}

private:
	const std::vector<std::uint32_t>& spread( int rounds )
	{
		++m_stamp;
		for ( const std::uint32_t cell : m_found )
		{
			m_mark[cell] = m_stamp;
		}
		std::size_t front = 0;
		for ( int round = 0; round < rounds; ++round )
		{
			const std::size_t end = m_found.size();
			for ( ; front < end; ++front )
			{
				const std::uint32_t cell = m_found[front];
				for ( std::uint32_t k = m_lattice.linkStart[cell]; k < m_lattice.linkStart[cell + 1]; ++k )
				{
					const std::uint32_t next = m_lattice.linkTo[k];
					if ( m_mark[next] != m_stamp )
					{
						m_mark[next] = m_stamp;
						m_found.push_back( next );
					}
				}
			}
		}
		std::sort( m_found.begin(), m_found.end() );
		return m_found;
	}

	const Lattice& m_lattice;
	std::vector<std::uint32_t> m_mark;
	std::vector<std::uint32_t> m_found;
	std::uint32_t m_stamp = 0;
};

} // namespace pliant
