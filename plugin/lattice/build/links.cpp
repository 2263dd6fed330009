// Across a face, cells are linked when a path from sample to sample crosses it through material. Across an edge or a corner, they are
// linked when links through the cells around it connect them, or when a diagonal path leads straight across.

#include "lattice/build/links.h"

#include "lattice/constants.h"
#include "lattice/guarded_tasks.h"
#include "lattice/table.h"

#include <algorithm>

namespace pliant {

namespace {

using Rows = Table;
using Pair = NumberPair;

class Linker
{
public:
	Linker( const Parts& parts, const InsideField& field, TaskRunner* runner ) :
		m_parts( parts ), m_field( field ), m_runner( runner ), m_grid( parts.voxels().grid ), m_count( parts.cells().size() )
	{
		m_at.reserve( m_count );
		for ( const CellDraft& cell : parts.cells() )
		{
			m_at.push_back( m_grid.at( cell.key ) );
		}
	}

	int link( Lattice& lattice )
	{
		m_face = makeNeighbourTable( forCells( [this]( std::size_t i, std::vector<Pair>& out ) { linkFaces( i, out ); } ), m_count );
		sortDiagonalLinks( forCells( [this]( std::size_t i, std::vector<Pair>& out ) { linkDiagonals( i, out ); } ) );
		m_edge = makeNeighbourTable( forCells( [this]( std::size_t i, std::vector<Pair>& out ) { linkEdges( i, out ); } ), m_count );
		return writeLinks( lattice );
	}

private:
	std::size_t taskCount() const { return std::min( kMaxTasks, m_count ); }

	template <class F>
	std::vector<std::vector<Pair>> forCells( F&& perCell ) const
	{
		const std::size_t tasks = taskCount();
		std::vector<std::vector<Pair>> out( tasks );
		auto some = [&]( int task ) {
			for ( std::size_t i = m_count * std::size_t( task ) / tasks; i < m_count * ( std::size_t( task ) + 1 ) / tasks; ++i )
			{
				perCell( i, out[std::size_t( task )] );
			}
		};
		runGuarded( m_runner, int( tasks ), some );
		return out;
	}

	bool isFull( std::size_t i ) const { return m_parts.cells()[i].cutCell == Parts::kNone; }

	/// 1, 2 or 3 for neighbours across a face, an edge, a corner; 0 otherwise.
	int kindOf( std::size_t i, std::size_t j ) const
	{
		const Eigen::Vector3i step = ( m_at[i] - m_at[j] ).cwiseAbs();
		return step.maxCoeff() == 1 ? step.sum() : 0;
	}

	/// Towards higher coordinates only: each pair once.
	void linkFaces( std::size_t i, std::vector<Pair>& out ) const
	{
		for ( int axis = 0; axis < 3; ++axis )
		{
			const Eigen::Vector3i to = m_at[i] + Eigen::Vector3i::Unit( axis );
			if ( !m_grid.holds( to ) )
			{
				continue;
			}
			const auto [first, last] = m_parts.cellsAt( m_grid.key( to.x(), to.y(), to.z() ) );
			if ( first == Parts::kNone )
			{
				continue;
			}
			if ( isFull( i ) && isFull( std::size_t( first ) ) )
			{
				out.emplace_back( std::uint32_t( i ), std::uint32_t( first ) );
				continue;
			}
			linkAcrossFace( i, to, axis, std::size_t( last - first ), out );
		}
	}

	void linkAcrossFace( std::size_t i, const Eigen::Vector3i& to, int axis, std::size_t maxLinks, std::vector<Pair>& out ) const
	{
		const int s = m_grid.samples;
		const std::size_t before = out.size();
		for ( int code = 0; code < s * s && out.size() - before < maxLinks; ++code )
		{
			Eigen::Vector3i here;
			here[axis] = s - 1;
			here[( axis + 1 ) % 3] = code % s;
			here[( axis + 2 ) % 3] = code / s;
			Eigen::Vector3i there = here;
			there[axis] = 0;
			if ( m_parts.cellAt( m_at[i], here ) != std::int32_t( i ) || isBlocked( i, here, axis ) )
			{
				continue;
			}
			const std::int32_t other = m_parts.cellAt( to, there );
			const Pair found{ std::uint32_t( i ), std::uint32_t( other ) };
			if ( other != Parts::kNone && std::find( out.begin() + std::ptrdiff_t( before ), out.end(), found ) == out.end() )
			{
				out.push_back( found );
			}
		}
	}

	bool isBlocked( std::size_t i, const Eigen::Vector3i& sample, int axis ) const
	{
		if ( isFull( i ) )
		{
			return false;
		}
		const Voxels& voxels = m_parts.voxels();
		const std::size_t first = std::size_t( m_parts.cells()[i].cutCell ) * voxels.samplesPerCell();
		return ( voxels.flags[first + m_parts.sampleNumber( sample )] & kBlocked[std::size_t( axis )] ) != 0;
	}

	/// Diagonal paths across the border of a cut cell. Both cells are cut then: a full one has no outside sample next to it.
	void linkDiagonals( std::size_t i, std::vector<Pair>& out ) const
	{
		const int s = m_grid.samples;
		if ( isFull( i ) )
		{
			return;
		}
		for ( int code = 0; code < s * s * s; ++code )
		{
			const Eigen::Vector3i in( code % s, code / s % s, code / s / s );
			const bool isInner = in.minCoeff() > 0 && in.maxCoeff() < s - 1;
			if ( isInner || m_parts.cellAt( m_at[i], in ) != std::int32_t( i ) )
			{
				continue;
			}
			for ( const Eigen::Vector3i& step : diagonalSteps() )
			{
				const Eigen::Vector3i to = in + step;
				if ( to.minCoeff() < 0 || to.maxCoeff() >= s )
				{
					linkAlong( i, s * m_at[i] + in, step, out );
				}
			}
		}
	}

	/// The cell that contains a sample of the whole grid.
	std::int32_t cellOf( const Eigen::Vector3i& sample ) const
	{
		const int s = m_grid.samples;
		if ( sample.minCoeff() < 0 || !m_grid.holds( sample / s ) )
		{
			return Parts::kNone;
		}
		const Eigen::Vector3i position = sample / s;
		return m_parts.cellAt( position, sample - s * position );
	}

	void linkAlong( std::size_t i, const Eigen::Vector3i& from, const Eigen::Vector3i& step, std::vector<Pair>& out ) const
	{
		const std::int32_t other = cellOf( from + step );
		if ( other == Parts::kNone || std::size_t( other ) == i || kindOf( i, std::size_t( other ) ) == 0 )
		{
			return;
		}
		for ( int corner = 1; corner < 7; ++corner )
		{
			const Eigen::Vector3i beside = step.cwiseProduct( Eigen::Vector3i( corner & 1, corner >> 1 & 1, corner >> 2 ) );
			if ( !beside.isZero() && beside != step && cellOf( from + beside ) != Parts::kNone )
			{
				return;
			}
		}
		if ( isSliver( from ) || isSliver( from + step ) || isUnobstructed( m_field, m_grid, from, step ) )
		{
			out.emplace_back( std::uint32_t( i ), std::uint32_t( other ) );
		}
	}

	bool isSliver( const Eigen::Vector3i& sample ) const
	{
		const Voxels& voxels = m_parts.voxels();
		const Eigen::Vector3i position = sample / m_grid.samples;
		const std::int32_t cell = cellOf( sample );
		if ( isFull( std::size_t( cell ) ) )
		{
			return false;
		}
		const std::size_t first = std::size_t( m_parts.cells()[std::size_t( cell )].cutCell ) * voxels.samplesPerCell();
		return ( voxels.flags[first + m_parts.sampleNumber( sample - m_grid.samples * position )] & kSliver ) != 0;
	}

	/// Merges diagonal links across faces into the face links and keeps the others for the edge and corner links.
	void sortDiagonalLinks( std::vector<std::vector<Pair>> diagonal )
	{
		std::vector<std::vector<Pair>> faces( 1 );
		for ( auto& some : diagonal )
		{
			for ( Pair& p : some )
			{
				if ( p.first > p.second )
				{
					std::swap( p.first, p.second );
				}
				const int kind = kindOf( p.first, p.second );
				( kind == 1 ? faces[0] : kind == 2 ? m_diagonalEdges : m_diagonalCorners ).push_back( p );
			}
		}
		for ( std::vector<Pair>* pairs : { &faces[0], &m_diagonalEdges, &m_diagonalCorners } )
		{
			std::sort( pairs->begin(), pairs->end() );
			pairs->erase( std::unique( pairs->begin(), pairs->end() ), pairs->end() );
		}
		for ( const Pair& p : m_diagonalCorners )
		{
			m_reversedCorners.emplace_back( p.second, p.first );
		}
		std::sort( m_reversedCorners.begin(), m_reversedCorners.end() );
		const auto isKnown = [this]( const Pair& p ) { return m_face.has( p.first, p.second ); };
		faces[0].erase( std::remove_if( faces[0].begin(), faces[0].end(), isKnown ), faces[0].end() );
		if ( !faces[0].empty() )
		{
			for ( std::uint32_t i = 0; i < m_count; ++i )
			{
				std::for_each( m_face.begin( i ), m_face.end( i ), [&]( std::uint32_t j ) {
					if ( i < j )
					{
						faces[0].emplace_back( i, j );
					}
				} );
			}
			m_face = makeNeighbourTable( faces, m_count );
		}
	}

	/// Each pair once, from its lower cell.
	void linkEdges( std::size_t i, std::vector<Pair>& out ) const
	{
		const std::size_t before = out.size();
		const auto add = [&]( std::uint32_t j ) {
			const Pair found( std::uint32_t( i ), j );
			if ( j > i && std::find( out.begin() + std::ptrdiff_t( before ), out.end(), found ) == out.end() )
			{
				out.push_back( found );
			}
		};
		for ( const std::uint32_t* k = m_face.begin( i ); k != m_face.end( i ); ++k )
		{
			for ( const std::uint32_t* j = m_face.begin( *k ); j != m_face.end( *k ); ++j )
			{
				if ( kindOf( i, *j ) == 2 )
				{
					add( *j );
				}
			}
		}
		forPartners( m_diagonalEdges, i, add );
	}

	template <class F>
	static void forPartners( const std::vector<Pair>& pairs, std::size_t i, F&& add )
	{
		auto it = std::lower_bound( pairs.begin(), pairs.end(), Pair( std::uint32_t( i ), 0 ) );
		for ( ; it != pairs.end() && it->first == i; ++it )
		{
			add( it->second );
		}
	}

	/// A full cell among 26 full cells is linked to all of them without a search; most cells are of this kind.
	bool linkInner( std::size_t i, std::vector<std::uint32_t>& row ) const
	{
		const Eigen::Vector3i p = m_at[i];
		if ( !isFull( i ) || p.minCoeff() < 1 || ( m_grid.extent - p ).minCoeff() < 2 || m_face.start[i + 1] - m_face.start[i] != 6 )
		{
			return false;
		}
		for ( int z = -1; z <= 1; ++z )
		{
			for ( int y = -1; y <= 1; ++y )
			{
				const std::int32_t middle = m_parts.cellsAt( m_grid.key( p.x(), p.y() + y, p.z() + z ) ).first;
				if ( middle < 1 || std::size_t( middle ) + 1 >= m_count )
				{
					return false;
				}
				for ( std::uint32_t j = std::uint32_t( middle ) - 1; j <= std::uint32_t( middle ) + 1; ++j )
				{
					if ( !isFull( j ) || m_at[j] != p + Eigen::Vector3i( int( j ) - middle, y, z ) )
					{
						return false;
					}
					if ( j != i )
					{
						row.push_back( j );
					}
				}
			}
		}
		return true;
	}

	void linkRow( std::size_t i, std::vector<std::uint32_t>& row ) const
	{
		row.assign( m_face.begin( i ), m_face.end( i ) );
		row.insert( row.end(), m_edge.begin( i ), m_edge.end( i ) );
		const auto addCorners = [&]( const Rows& near, const Rows& far ) {
			for ( const std::uint32_t* k = near.begin( i ); k != near.end( i ); ++k )
			{
				std::copy_if(
					far.begin( *k ), far.end( *k ), std::back_inserter( row ), [&]( std::uint32_t j ) { return kindOf( i, j ) == 3; } );
			}
		};
		addCorners( m_face, m_edge );
		addCorners( m_edge, m_face );
		forPartners( m_diagonalCorners, i, [&]( std::uint32_t j ) { row.push_back( j ); } );
		forPartners( m_reversedCorners, i, [&]( std::uint32_t j ) { row.push_back( j ); } );
		std::sort( row.begin(), row.end() );
		row.erase( std::unique( row.begin(), row.end() ), row.end() );
	}

	/// Number of neighbours of a cell, linked or not.
	int countNeighbours( std::size_t i ) const
	{
		int count = 0;
		for ( int code = 0; code < 27; ++code )
		{
			const Eigen::Vector3i at = m_at[i] + Eigen::Vector3i( code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1 );
			if ( code != 13 && m_grid.holds( at ) )
			{
				const auto [first, last] = m_parts.cellsAt( m_grid.key( at.x(), at.y(), at.z() ) );
				count += last - first;
			}
		}
		return count;
	}

	int writeLinks( Lattice& lattice ) const
	{
		const std::size_t tasks = taskCount();
		std::vector<std::vector<std::uint32_t>> to( tasks );
		std::vector<int> unlinked( tasks, 0 );
		lattice.linkStart.assign( m_count + 1, 0 );
		auto some = [&]( int task ) {
			std::vector<std::uint32_t> row;
			for ( std::size_t i = m_count * std::size_t( task ) / tasks; i < m_count * ( std::size_t( task ) + 1 ) / tasks; ++i )
			{
				row.clear();
				if ( !linkInner( i, row ) )
				{
					linkRow( i, row );
					unlinked[std::size_t( task )] += countNeighbours( i ) - int( row.size() );
				}
				lattice.linkStart[i + 1] = std::uint32_t( row.size() );
				to[std::size_t( task )].insert( to[std::size_t( task )].end(), row.begin(), row.end() );
			}
		};
		runGuarded( m_runner, int( tasks ), some );
		lattice.isSurface.resize( m_count );
		for ( std::size_t i = 0; i < m_count; ++i )
		{
			lattice.isSurface[i] = m_parts.cells()[i].fill < 1.0f || lattice.linkStart[i + 1] != kNeighbours;
			lattice.linkStart[i + 1] += lattice.linkStart[i];
		}
		lattice.linkTo.reserve( lattice.linkStart.back() );
		for ( const auto& part : to )
		{
			lattice.linkTo.insert( lattice.linkTo.end(), part.begin(), part.end() );
		}
		int total = 0;
		for ( const int count : unlinked )
		{
			total += count;
		}
		return total / 2;
	}

	const Parts& m_parts;
	const InsideField& m_field;
	TaskRunner* m_runner;
	const Grid& m_grid;
	const std::size_t m_count;
	std::vector<Eigen::Vector3i> m_at;
	Rows m_face;
	Rows m_edge;
	std::vector<Pair> m_diagonalEdges;
	std::vector<Pair> m_diagonalCorners;
	std::vector<Pair> m_reversedCorners;
};

} // namespace

int linkCells( const Parts& parts, const InsideField& field, TaskRunner* runner, Lattice& lattice )
{
	return Linker( parts, field, runner ).link( lattice );
}

} // namespace pliant
