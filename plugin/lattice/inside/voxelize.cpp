// Positions without a crossing on or next to any of their rows are wholly inside or wholly outside and need one test; in the others every
// sample is tested. The cost is therefore proportional to the surface.

#include "lattice/inside/voxelize.h"

#include "lattice/constants.h"
#include "lattice/guarded_tasks.h"
#include "lattice/inside/thin_runs.h"

#include <algorithm>
#include <array>

namespace pliant {

bool Progress::report( float fraction )
{
	m_done = std::max( m_done, fraction );
	return !m_settings.progress || m_settings.progress( m_done, m_settings.progressContext );
}

namespace {

class Voxelizer
{
public:
	Voxelizer( const SnappedSurface& surface, const VoxelizeOptions& options, Voxels& out ) :
		m_surface( surface ), m_grid( surface.grid() ), m_options( options ), m_out( out )
	{
		m_out = Voxels{};
		m_out.grid = m_grid;
	}

	ResultCode run()
	{
		constexpr std::array<float, 3> kRowsDone = { 0.4f, 0.5f, 0.6f };
		for ( int axis = 0; axis < 3; ++axis )
		{
			m_rows[std::size_t( axis )] = m_surface.makeRows( axis, m_options.runner );
			if ( !m_options.progress.report( kRowsDone[std::size_t( axis )] ) )
			{
				return ResultCode::Cancelled;
			}
		}
		if ( isTooMuch() )
		{
			return ResultCode::TooManyCells;
		}
		markCutCells();
		classifyTheRest();
		if ( double( m_out.full.size() ) > m_options.maxCells || double( m_out.cut.size() ) > kMaxPositionsPerCell * m_options.maxCells )
		{
			return ResultCode::TooManyCells;
		}
		if ( !m_options.progress.report( 0.7f ) )
		{
			return ResultCode::Cancelled;
		}
		m_out.flags.assign( m_out.cut.size() * m_out.samplesPerCell(), 0 );
		const PositionIndex index( m_grid, m_out.cut );
		m_index = &index;
		sampleCutCells();
		std::vector<Sliver> slivers;
		for ( const RowSet& rows : m_rows )
		{
			searchBetweenSamples( rows, slivers );
		}
		keepThinRuns( slivers, m_out );
		return m_options.progress.report( 0.8f ) ? ResultCode::Ok : ResultCode::Cancelled;
	}

private:
	/// A sample as its cell's key and its index in the cell.
	struct SampleIndex
	{
		std::uint64_t key;
		std::size_t sample;
	};

	SampleIndex sampleIndex( int axis, int u, int v, int along ) const
	{
		const int s = m_grid.samples;
		Eigen::Vector3i at;
		at[axis] = along;
		at[( axis + 1 ) % 3] = u;
		at[( axis + 2 ) % 3] = v;
		const Eigen::Vector3i cell = at / s;
		const Eigen::Vector3i in = at - cell * s;
		return { m_grid.key( cell.x(), cell.y(), cell.z() ), std::size_t( ( in.z() * s + in.y() ) * s + in.x() ) };
	}

	/// The volume along the rows is known before any cell is created; where the surface is open, every position needs a test.
	bool isTooMuch() const
	{
		if ( !m_surface.field().isClosed() )
		{
			return double( m_grid.positions() ) > kMaxPositionsPerCell * m_options.maxCells;
		}
		double length = 0.0;
		for ( const InsideRun& run : insideRuns( m_surface, m_rows[0] ) )
		{
			length += run.to - run.from;
		}
		const double cells = length / ( m_grid.cellSize * m_grid.samples * m_grid.samples );
		return cells > ( 1.0 + kTargetSlack ) * m_options.maxCells;
	}

	void markCutCells()
	{
		std::vector<std::uint64_t>& cut = m_out.cut;
		for ( const RowSet& rows : m_rows )
		{
			const int sampleCount = m_grid.sampleCount( rows.axis );
			for ( const Crossing& c : rows.crossing )
			{
				const int above = m_grid.firstAbove( rows.axis, c.at );
				for ( int along = std::max( above - 1, 0 ); along < std::min( above + 1, sampleCount ); ++along )
				{
					const std::uint64_t key = sampleIndex( rows.axis, c.u(), c.v(), along ).key;
					if ( cut.empty() || cut.back() != key )
					{
						cut.push_back( key );
					}
				}
			}
			std::sort( cut.begin(), cut.end() );
			cut.erase( std::unique( cut.begin(), cut.end() ), cut.end() );
		}
	}

	/// Classifies every position that is not cut, layer by layer.
	void classifyTheRest()
	{
		if ( !m_surface.field().isClosed() )
		{
			classifyOpen();
			return;
		}
		std::vector<std::vector<std::uint64_t>> full( static_cast<std::size_t>( m_grid.extent.z() ) );
		auto classifyLayer = [&]( int z ) { classifyCrossedRows( z, full[std::size_t( z )] ); };
		runGuarded( m_options.runner, m_grid.extent.z(), classifyLayer );
		appendAll( full, m_out.full );
	}

	/// For a closed surface, rows of cells without any crossing are outside: only the others are traversed.
	void classifyCrossedRows( int z, std::vector<std::uint64_t>& full ) const
	{
		const RowSet& rows = m_rows[0];
		const auto keep = [&]( std::uint64_t key, bool isInside ) {
			if ( isInside )
			{
				full.push_back( key );
			}
		};
		int done = -1;
		for ( std::size_t k = rows.slabStart[std::size_t( z )]; k < rows.slabStart[std::size_t( z ) + 1]; ++k )
		{
			const Crossing& c = rows.crossing[k];
			if ( c.v() != z * m_grid.samples )
			{
				break; // the first rows of the cells come first in the slab
			}
			if ( c.u() % m_grid.samples == 0 && c.u() / m_grid.samples != done )
			{
				done = c.u() / m_grid.samples;
				classifyRow( done, z, keep );
			}
		}
	}

	/// Positions between samples of a row of cells share the row's count; cut cells are skipped.
	template <class F>
	void classifyRow( int y, int z, F&& keep ) const
	{
		auto [next, last] = m_rows[0].row( y * m_grid.samples, z * m_grid.samples, m_grid.samples );
		const std::uint64_t first = m_grid.key( 0, y, z );
		auto cut = std::lower_bound( m_out.cut.begin(), m_out.cut.end(), first );
		int count = 0;
		for ( int x = 0; x < m_grid.extent.x(); ++x )
		{
			while ( next != last && next->at <= m_grid.sampleAt( x * m_grid.samples ) )
			{
				count += m_surface.counted( *next++ );
			}
			const std::uint64_t key = first + std::uint64_t( x );
			if ( cut != m_out.cut.end() && *cut == key )
			{
				++cut;
				continue;
			}
			keep( key, m_surface.field().isInside( count, m_grid.corner + m_grid.cellSize * Vec3d( x + 0.5, y + 0.5, z + 0.5 ) ) );
		}
	}

	/// At a hole the inside ends without a crossing: where a position and its neighbour differ, both are sampled like cut ones.
	void classifyOpen()
	{
		constexpr std::uint8_t kCutHere = 0, kOutside = 1, kFullHere = 2;
		std::vector<std::uint8_t> kind( std::size_t( m_grid.positions() ), kCutHere );
		auto classifyLayer = [&]( int z ) {
			const auto keep = [&]( std::uint64_t key, bool isInside ) { kind[std::size_t( key )] = isInside ? kFullHere : kOutside; };
			for ( int y = 0; y < m_grid.extent.y(); ++y )
			{
				classifyRow( y, z, keep );
			}
		};
		runGuarded( m_options.runner, m_grid.extent.z(), classifyLayer );
		const auto differs = [&]( std::uint64_t key ) {
			const Eigen::Vector3i at = m_grid.at( key );
			for ( int side = 0; side < 6; ++side )
			{
				const Eigen::Vector3i to = at + ( side % 2 ? 1 : -1 ) * Eigen::Vector3i::Unit( side / 2 );
				const std::uint8_t there = m_grid.holds( to ) ? kind[std::size_t( m_grid.key( to.x(), to.y(), to.z() ) )] : kOutside;
				if ( there != kCutHere && there != kind[std::size_t( key )] )
				{
					return true;
				}
			}
			return false;
		};
		std::vector<std::uint64_t> rim;
		std::vector<std::uint64_t> inside;
		for ( std::uint64_t key = 0; key < m_grid.positions(); ++key )
		{
			const std::uint8_t here = kind[std::size_t( key )];
			if ( here == kFullHere )
			{
				inside.push_back( key );
			}
			if ( here != kCutHere && differs( key ) )
			{
				rim.push_back( key );
			}
		}
		// A hole is smaller than the surface around it. Where the winding number is close to one half everywhere, samples carry no more
		// information than the position's centre.
		if ( rim.size() > m_out.cut.size() )
		{
			rim.clear();
		}
		std::set_difference( inside.begin(), inside.end(), rim.begin(), rim.end(), std::back_inserter( m_out.full ) );
		const auto middle = std::ptrdiff_t( m_out.cut.size() );
		m_out.cut.insert( m_out.cut.end(), rim.begin(), rim.end() );
		std::inplace_merge( m_out.cut.begin(), m_out.cut.begin() + middle, m_out.cut.end() );
	}

	void sampleCutCells()
	{
		// Cut cells of one row of cells share their rows of samples.
		std::vector<std::size_t> start;
		for ( std::size_t k = 0; k < m_out.cut.size(); ++k )
		{
			const std::uint64_t nx = std::uint64_t( m_grid.extent.x() );
			if ( k == 0 || m_out.cut[k] / nx != m_out.cut[k - 1] / nx )
			{
				start.push_back( k );
			}
		}
		start.push_back( m_out.cut.size() );
		const std::size_t count = start.size() - 1;
		const std::size_t tasks = std::min( kMaxTasks, count );
		auto sampleSome = [&]( int task ) {
			for ( std::size_t k = count * std::size_t( task ) / tasks; k < count * ( std::size_t( task ) + 1 ) / tasks; ++k )
			{
				sampleRowOfCells( start[k], start[k + 1] );
			}
		};
		runGuarded( m_options.runner, int( tasks ), sampleSome );
	}

	void sampleRowOfCells( std::size_t begin, std::size_t end )
	{
		const int s = m_grid.samples;
		const Eigen::Vector3i at = m_grid.at( m_out.cut[begin] );
		for ( int inRow = 0; inRow < s * s; ++inRow )
		{
			const int u = at.y() * s + inRow % s;
			const int v = at.z() * s + inRow / s;
			const Crossing row{ Crossing::packRow( u, v ), 0.0 };
			auto [next, last] = m_rows[0].row( u, v, s );
			int count = 0;
			for ( std::size_t k = begin; k < end; ++k )
			{
				const int x = m_grid.at( m_out.cut[k] ).x();
				std::uint8_t* flags = &m_out.flags[k * m_out.samplesPerCell() + std::size_t( inRow * s )];
				for ( int i = 0; i < s; ++i )
				{
					const double coordinate = m_grid.sampleAt( x * s + i );
					while ( next != last && next->at <= coordinate )
					{
						count += m_surface.counted( *next++ );
					}
					const InsideField& field = m_surface.field();
					const bool isIn = field.isClosed() ? count != 0 : field.isInside( count, m_surface.pointOn( 0, row, coordinate ) );
					flags[i] = std::uint8_t( isIn ? kInside : 0 );
				}
			}
		}
	}

	std::uint8_t* flagsAt( const SampleIndex& index )
	{
		const std::int32_t cell = m_index->find( index.key );
		return cell == PositionIndex::kNone ? nullptr : &m_out.flags[std::size_t( cell ) * m_out.samplesPerCell() + index.sample];
	}

	void searchBetweenSamples( const RowSet& rows, std::vector<Sliver>& slivers )
	{
		std::vector<std::vector<Sliver>> found( static_cast<std::size_t>( rows.slabs() ) );
		auto searchSlab = [&]( int slab ) {
			int count = 0;
			for ( std::size_t k = rows.slabStart[std::size_t( slab )]; k < rows.slabStart[std::size_t( slab ) + 1]; ++k )
			{
				const Crossing& c = rows.crossing[k];
				count += m_surface.counted( c );
				const bool isLast = k + 1 == rows.slabStart[std::size_t( slab ) + 1] || rows.crossing[k + 1].row() != c.row();
				if ( isLast )
				{
					count = 0;
				}
				else
				{
					inspect( rows.axis, c, rows.crossing[k + 1].at, count, found[std::size_t( slab )] );
				}
			}
		};
		runGuarded( m_options.runner, rows.slabs(), searchSlab );
		appendAll( found, slivers );
	}

	/// Classifies the segment of a row between two crossings. Without a sample in it, it is a gap between inside samples or a sliver
	/// between outside ones; with one, it is a thin run, whose length is more accurate than the sample.
	void inspect( int axis, const Crossing& from, double to, int count, std::vector<Sliver>& slivers )
	{
		const int above = m_grid.firstAbove( axis, from.at );
		const int samplesWithin = m_grid.firstAbove( axis, to ) - above;
		if ( to <= from.at || samplesWithin > 1 )
		{
			return;
		}
		const double middle = 0.5 * ( from.at + to );
		const bool isInside = m_surface.field().isInside( count, m_surface.pointOn( axis, from, middle ) );
		const double length = ( to - from.at ) * m_grid.quantum();
		if ( samplesWithin == 1 )
		{
			const std::uint8_t* flags = flagsAt( sampleIndex( axis, from.u(), from.v(), above ) );
			if ( isInside && flags && ( *flags & kInside ) )
			{
				addSliver( axis, from, above, { middle, length, true }, slivers );
			}
			return;
		}
		const int sampleCount = m_grid.sampleCount( axis );
		std::uint8_t* low = above > 0 ? flagsAt( sampleIndex( axis, from.u(), from.v(), above - 1 ) ) : nullptr;
		const std::uint8_t* high = above < sampleCount ? flagsAt( sampleIndex( axis, from.u(), from.v(), above ) ) : nullptr;
		const bool isLowInside = low && ( *low & kInside );
		const bool isHighInside = high && ( *high & kInside );
		if ( isLowInside && isHighInside && !isInside && length > m_options.gap )
		{
			*low |= kBlocked[std::size_t( axis )];
		}
		if ( isLowInside || isHighInside || !isInside || middle < 0.0 || length <= m_options.gap )
		{
			return;
		}
		const double edge = double( std::int64_t( 1 ) << m_grid.bits );
		addSliver( axis, from, std::min( int( middle / edge * m_grid.samples ), sampleCount - 1 ), { middle, length, false }, slivers );
	}

	struct Run
	{
		double middle; ///< quanta
		double length; ///< m
		bool hasSample;
	};

	void addSliver( int axis, const Crossing& row, int along, const Run& run, std::vector<Sliver>& slivers ) const
	{
		const SampleIndex at = sampleIndex( axis, row.u(), row.v(), along );
		const std::int32_t cell = m_index->find( at.key );
		const float fraction = float( run.length / m_grid.cellSize / ( m_grid.samples * m_grid.samples ) );
		if ( cell != PositionIndex::kNone && fraction > 0.0f )
		{
			const Vec3d point = ( m_surface.pointOn( axis, row, run.middle ) - m_grid.corner ) / m_grid.cellSize;
			slivers.push_back( { cell, std::uint16_t( at.sample ), std::uint8_t( axis ), run.hasSample, fraction, point } );
		}
	}

	const SnappedSurface& m_surface;
	const Grid m_grid;
	const VoxelizeOptions& m_options;
	Voxels& m_out;
	std::array<RowSet, 3> m_rows;
	const PositionIndex* m_index = nullptr;
};

} // namespace

ResultCode voxelize( const SnappedSurface& surface, const VoxelizeOptions& options, Voxels& out )
{
	return Voxelizer( surface, options, out ).run();
}

} // namespace pliant
