// +-----------------------------------------------------------------------------------------------------------------+
// | Tables of a scene's findings, and their means.                                                                    |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/findings.h"

#include <algorithm>
#include <cstdio>

namespace pliant_demos {

void print( const FindingTable& table )
{
	if ( table.rows.empty() )
	{
		return;
	}
	std::printf( "  %s\n  %-22s", table.caption.c_str(), "" );
	for ( const std::string& column : table.columns )
	{
		std::printf( " %14s", column.c_str() );
	}
	std::printf( "\n" );
	for ( const FindingTable::Row& row : table.rows )
	{
		std::printf( "  %-22s", row.name.c_str() );
		for ( const double value : row.values )
		{
			std::printf( " %14.5g", value );
		}
		std::printf( "\n" );
	}
	std::printf( "\n" );
}

void FindingMeans::add( std::vector<FindingTable> tables )
{
	m_runs.push_back( std::move( tables ) );
}

std::vector<FindingTable> FindingMeans::tables() const
{
	std::vector<FindingTable> all = m_runs.empty() ? std::vector<FindingTable>() : m_runs.front();
	for ( std::size_t t = 0; t < all.size(); ++t )
	{
		FindingTable& table = all[t];
		for ( std::size_t r = 0; r < table.rows.size(); ++r )
		{
			for ( std::size_t k = 0; k < table.rows[r].values.size(); ++k )
			{
				double sum = 0;
				for ( const std::vector<FindingTable>& run : m_runs )
				{
					sum += run[t].rows[r].values[k];
				}
				table.rows[r].values[k] = sum / double( m_runs.size() );
			}
		}
		if ( table.rows.size() != 1 )
		{
			continue;
		}
		FindingTable::Row least = m_runs.front()[t].rows[0], most = least;
		for ( const std::vector<FindingTable>& run : m_runs )
		{
			for ( std::size_t k = 0; k < least.values.size(); ++k )
			{
				least.values[k] = std::min( least.values[k], run[t].rows[0].values[k] );
				most.values[k] = std::max( most.values[k], run[t].rows[0].values[k] );
			}
		}
		least.name = "least";
		most.name = "most";
		table.rows.push_back( least );
		table.rows.push_back( most );
	}
	return all;
}

} // namespace pliant_demos
