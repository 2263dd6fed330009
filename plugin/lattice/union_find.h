#pragma once

// Disjoint sets, each represented by its lowest member, so that the result does not depend on the order of joining.

#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace pliant {

class UnionFind
{
public:
	explicit UnionFind( std::size_t count ) : m_parent( count ) { std::iota( m_parent.begin(), m_parent.end(), 0u ); }

	std::uint32_t find( std::uint32_t i )
	{
		while ( m_parent[i] != i )
		{
			m_parent[i] = m_parent[m_parent[i]];
			i = m_parent[i];
		}
		return i;
	}

	void join( std::uint32_t a, std::uint32_t b )
	{
		a = find( a );
		b = find( b );
		if ( a > b )
		{
			std::swap( a, b );
		}
		m_parent[b] = a;
	}

private:
	std::vector<std::uint32_t> m_parent;
};

} // namespace pliant
