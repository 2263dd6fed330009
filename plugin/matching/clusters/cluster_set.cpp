#include "matching/clusters/cluster_set.h"

#include "lattice/table.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace pliant {

namespace {

/// A cell in a box. The box number comes first, so that sorting groups the cells of each box, ascending.
using Entry = std::pair<std::uint64_t, std::uint32_t>;

/// The boxes along one axis begin at 0, stride, 2 stride ...; the last is the first that reaches the end.
struct BoxRow
{
	int edge, stride, count;

	BoxRow( int boxEdge, int extent ) :
		edge( boxEdge ), stride( std::max( 1, boxEdge / 2 ) ),
		count( extent <= boxEdge ? 1 : 1 + ( extent - boxEdge + stride - 1 ) / stride )
	{}
	int first( int coordinate ) const { return coordinate < edge ? 0 : ( coordinate - edge ) / stride + 1; }
	int last( int coordinate ) const { return std::min( coordinate / stride, count - 1 ); }
};

std::vector<Entry> cellsByBox( const Lattice& lattice, int edge )
{
	const BoxRow x( edge, lattice.extent.x() ), y( edge, lattice.extent.y() ), z( edge, lattice.extent.z() );
	std::vector<Entry> entries;
	for ( int i = 0; i < lattice.cellCount(); ++i )
	{
		const auto& coordinate = lattice.coordinate[i];
		for ( int bz = z.first( coordinate.z() ); bz <= z.last( coordinate.z() ); ++bz )
		{
			for ( int by = y.first( coordinate.y() ); by <= y.last( coordinate.y() ); ++by )
			{
				for ( int bx = x.first( coordinate.x() ); bx <= x.last( coordinate.x() ); ++bx )
				{
					entries.emplace_back( ( std::uint64_t( bz ) * y.count + by ) * x.count + bx, std::uint32_t( i ) );
				}
			}
		}
	}
	std::sort( entries.begin(), entries.end() );
	return entries;
}

/// Splits the cells of one box after another into linked parts.
class PartCutter
{
public:
	explicit PartCutter( const Lattice& lattice ) : m_lattice( lattice ), m_isWaiting( lattice.cellCount(), 0 ) {}

	void cut( const Entry* first, const Entry* last, ClusterSet& out )
	{
		for ( const Entry* e = first; e != last; ++e )
		{
			m_isWaiting[e->second] = 1;
		}
		for ( const Entry* e = first; e != last; ++e )
		{
			if ( m_isWaiting[e->second] )
			{
				const std::size_t begin = out.member.size();
				flood( e->second, out.member );
				std::sort( out.member.begin() + std::ptrdiff_t( begin ), out.member.end() );
				out.start.push_back( std::uint32_t( out.member.size() ) );
			}
		}
	}

private:
	void flood( std::uint32_t from, std::vector<std::uint32_t>& members )
	{
		m_isWaiting[from] = 0;
		m_open.assign( 1, from );
		while ( !m_open.empty() )
		{
			const std::uint32_t cell = m_open.back();
			m_open.pop_back();
			members.push_back( cell );
			for ( std::uint32_t k = m_lattice.linkStart[cell]; k < m_lattice.linkStart[cell + 1]; ++k )
			{
				const std::uint32_t next = m_lattice.linkTo[k];
				if ( m_isWaiting[next] )
				{
					m_isWaiting[next] = 0;
					m_open.push_back( next );
				}
			}
		}
	}

	const Lattice& m_lattice;
	std::vector<std::uint8_t> m_isWaiting; ///< 1 for cells of the current box that are not in a part yet
	std::vector<std::uint32_t> m_open;
};

void fillCover( int nodes, ClusterSet& set )
{
	const auto forMembers = [&set]( auto&& visit ) {
		for ( int r = 0; r < set.count(); ++r )
		{
			for ( std::uint32_t k = set.start[r]; k < set.start[r + 1]; ++k )
			{
				visit( set.member[k], std::uint32_t( r ) );
			}
		}
	};
	sortIntoRows( std::size_t( nodes ), forMembers, set.coverStart, set.cover );
}

} // namespace

ClusterSet makeWholeCluster( const Lattice& lattice )
{
	ClusterSet set;
	set.start = { 0, std::uint32_t( lattice.cellCount() ) };
	set.member.resize( lattice.cellCount() );
	std::iota( set.member.begin(), set.member.end(), 0u );
	fillCover( lattice.cellCount(), set );
	return set;
}

ClusterSet makeBoxClusters( const Lattice& lattice, int edge )
{
	ClusterSet set;
	set.start.assign( 1, 0 );
	const std::vector<Entry> entries = cellsByBox( lattice, edge );
	PartCutter cutter( lattice );
	const Entry* const end = entries.data() + entries.size();
	for ( const Entry* first = entries.data(); first != end; )
	{
		const Entry* last = first;
		while ( last != end && last->first == first->first )
		{
			++last;
		}
		cutter.cut( first, last, set );
		first = last;
	}
	fillCover( lattice.cellCount(), set );
	return set;
}

} // namespace pliant
