// Joins the pairs that the surface itself connects, then, as for the inside, those connected by links around an edge or a corner.

#include "lattice/build/shell_links.h"

#include "lattice/constants.h"
#include "lattice/table.h"

#include <algorithm>

namespace pliant {

namespace {

constexpr std::uint32_t kNone = ~0u;

class ShellLinker
{
public:
	ShellLinker( const Grid& grid, const std::vector<SurfacePatch>& patches ) : m_grid( grid ), m_patches( patches )
	{
		m_patchKeys.reserve( patches.size() );
		for ( const SurfacePatch& patch : patches )
		{
			m_patchKeys.push_back( patch.key );
		}
	}

	void merge( const std::vector<CellDraft>& shell, std::vector<CellDraft>& cells, Lattice& lattice )
	{
		mergeCells( shell, cells );
		addInsideLinks( lattice );
		joinAlongSurface();
		joinAroundEdges();
		write( lattice );
		cells = std::move( m_cells );
	}

private:
	static constexpr int kParts = kShellSamples;
	static_assert( kParts == 4, "a position's parts are the bits of a word" );
	/// By axis: the parts along the low side of a position, and along the high side.
	static constexpr std::array<std::uint64_t, 3> kLowParts = { 0x1111111111111111u, 0x000f000f000f000fu, 0x000000000000ffffu };
	static constexpr std::array<std::uint64_t, 3> kHighParts = { 0x8888888888888888u, 0xf000f000f000f000u, 0xffff000000000000u };

	/// Merges both lists of cells; at the same position those of the inside come first.
	void mergeCells( const std::vector<CellDraft>& shell, const std::vector<CellDraft>& inside )
	{
		m_cells.reserve( shell.size() + inside.size() );
		m_cellOfPatch.assign( m_patches.size(), kNone );
		std::size_t i = 0, s = 0;
		std::size_t patch = 0;
		while ( i < inside.size() || s < shell.size() )
		{
			if ( s == shell.size() || ( i < inside.size() && inside[i].key <= shell[s].key ) )
			{
				m_numberOfInside.push_back( std::uint32_t( m_cells.size() ) );
				m_cells.push_back( inside[i++] );
				m_isShell.push_back( 0 );
				continue;
			}
			while ( !m_patches[patch].isShell )
			{
				++patch;
			}
			m_cellOfPatch[patch++] = std::uint32_t( m_cells.size() );
			m_cells.push_back( shell[s++] );
			m_isShell.push_back( 1 );
		}
		for ( const CellDraft& cell : m_cells )
		{
			m_at.push_back( m_grid.at( cell.key ) );
			m_keys.push_back( cell.key );
		}
	}

	void addInsideLinks( const Lattice& lattice )
	{
		for ( std::uint32_t i = 0; i < std::uint32_t( m_numberOfInside.size() ); ++i )
		{
			for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
			{
				if ( lattice.linkTo[k] > i )
				{
					join( m_numberOfInside[i], m_numberOfInside[lattice.linkTo[k]] );
				}
			}
		}
	}

	/// 1, 2 or 3 for neighbours across a face, an edge, a corner; 0 otherwise.
	std::size_t kindOf( std::uint32_t a, std::uint32_t b ) const
	{
		const Eigen::Vector3i step = ( m_at[a] - m_at[b] ).cwiseAbs();
		return step.maxCoeff() == 1 ? std::size_t( step.sum() ) : 0;
	}

	void join( std::uint32_t a, std::uint32_t b ) { m_pairs[kindOf( a, b ) - 1].emplace_back( std::min( a, b ), std::max( a, b ) ); }

	void joinAlongSurface()
	{
		const PositionIndex patches( m_grid, m_patchKeys ), cells( m_grid, m_keys );
		for ( std::size_t p = 0; p < m_patches.size(); ++p )
		{
			for ( int code = 0; code < 27 && m_patches[p].isShell; ++code )
			{
				const Eigen::Vector3i step( code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1 );
				const Eigen::Vector3i to = m_grid.at( m_patches[p].key ) + step;
				if ( code == 13 || !m_grid.holds( to ) )
				{
					continue;
				}
				const std::uint64_t key = m_grid.key( to.x(), to.y(), to.z() );
				const std::int32_t patch = patches.find( key );
				const std::uint64_t passed = patch >= 0 ? m_patches[std::size_t( patch )].passed : 0;
				Vec3d contact;
				if ( code > 13 && patch >= 0 && m_patches[std::size_t( patch )].isShell &&
					touches( m_patches[p].passed, passed, step, contact ) )
				{
					join( m_cellOfPatch[p], m_cellOfPatch[std::size_t( patch )] );
				}
				const std::uint32_t inside = nearestInside( cells, key, Vec3d::Zero() );
				// A full cell has material everywhere up to its border.
				const bool isFull = inside != kNone && m_cells[inside].fill == 1.0f;
				if ( inside != kNone && touches( m_patches[p].passed, isFull ? ~std::uint64_t( 0 ) : passed, step, contact ) )
				{
					const Vec3d position = m_grid.at( m_patches[p].key ).cast<double>() + contact;
					join( m_cellOfPatch[p], nearestInside( cells, key, position ) );
				}
			}
		}
	}

	std::uint32_t nearestInside( const PositionIndex& cells, std::uint64_t key, const Vec3d& position ) const
	{
		std::uint32_t best = kNone;
		const std::int32_t first = cells.find( key );
		for ( std::size_t i = std::size_t( first ); first >= 0 && i < m_keys.size() && m_keys[i] == key; ++i )
		{
			const bool isNearer = best == kNone ||
				( m_cells[i].centre - position ).squaredNorm() < ( m_cells[best].centre - position ).squaredNorm();
			best = !m_isShell[i] && isNearer ? std::uint32_t( i ) : best;
		}
		return best;
	}

	/// The parts of a position that are adjacent to the position one step away.
	static std::uint64_t borderTowards( const Eigen::Vector3i& step )
	{
		std::uint64_t border = ~std::uint64_t( 0 );
		for ( std::size_t axis = 0; axis < 3; ++axis )
		{
			border &= step[Eigen::Index( axis )] == 0 ? border : step[Eigen::Index( axis )] < 0 ? kLowParts[axis] : kHighParts[axis];
		}
		return border;
	}

	/// True where the surface passes through adjacent parts of this position and the one a step away; `contact` is the mean position of
	/// these parts, in cells.
	static bool touches( std::uint64_t here, std::uint64_t there, const Eigen::Vector3i& step, Vec3d& contact )
	{
		Vec3d sum = Vec3d::Zero();
		int count = 0;
		here &= borderTowards( step );
		for ( int part = 0; part < kParts * kParts * kParts && here >> part != 0; ++part )
		{
			if ( ( here >> part & 1 ) == 0 )
			{
				continue;
			}
			const Eigen::Vector3i a( part % kParts, part / kParts % kParts, part / kParts / kParts );
			for ( int code = 0; code < 27; ++code )
			{
				const Eigen::Vector3i b = a + Eigen::Vector3i( code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1 ) - kParts * step;
				if ( b.minCoeff() >= 0 && b.maxCoeff() < kParts && ( there >> ( ( b.z() * kParts + b.y() ) * kParts + b.x() ) & 1 ) != 0 )
				{
					sum += ( a.cast<double>() + Vec3d::Constant( 0.5 ) ) / kParts;
					++count;
				}
			}
		}
		contact = sum / std::max( count, 1 );
		return count > 0;
	}

	/// Joins cells that are connected by links across two faces, or a face and an edge: as in links.cpp.
	void joinAroundEdges()
	{
		const auto addOver = [this]( const Table& near, const Table& far, std::size_t kind ) {
			for ( std::uint32_t i = 0; i < std::uint32_t( m_cells.size() ); ++i )
			{
				for ( const std::uint32_t* k = near.begin( i ); m_isShell[i] && k != near.end( i ); ++k )
				{
					for ( const std::uint32_t* j = far.begin( *k ); j != far.end( *k ); ++j )
					{
						if ( kindOf( i, *j ) == kind )
						{
							join( i, *j );
						}
					}
				}
			}
		};
		const Table face = rowsOf( 1 );
		addOver( face, face, 2 );
		const Table edge = rowsOf( 2 );
		addOver( face, edge, 3 );
		addOver( edge, face, 3 );
	}

	Table rowsOf( std::size_t kind )
	{
		std::vector<NumberPair>& pairs = m_pairs[kind - 1];
		std::sort( pairs.begin(), pairs.end() );
		pairs.erase( std::unique( pairs.begin(), pairs.end() ), pairs.end() );
		return makeNeighbourTable( { pairs }, m_cells.size() );
	}

	void write( Lattice& lattice )
	{
		rowsOf( 3 ); // removes duplicates
		const Table rows = makeNeighbourTable( { m_pairs[0], m_pairs[1], m_pairs[2] }, m_cells.size() );
		lattice.linkStart = rows.start;
		lattice.linkTo = rows.entry;
		lattice.isSurface.clear();
		for ( std::size_t i = 0; i < m_cells.size(); ++i )
		{
			lattice.isSurface.push_back( m_cells[i].fill < 1.0f || rows.start[i + 1] - rows.start[i] != kNeighbours );
		}
	}

	const Grid& m_grid;
	const std::vector<SurfacePatch>& m_patches;
	std::vector<std::uint64_t> m_patchKeys;
	std::vector<std::uint32_t> m_cellOfPatch, m_numberOfInside;
	std::vector<CellDraft> m_cells;
	std::vector<std::uint8_t> m_isShell;
	std::vector<Eigen::Vector3i> m_at;
	std::vector<std::uint64_t> m_keys;
	std::array<std::vector<NumberPair>, 3> m_pairs; ///< by kind
};

} // namespace

void mergeShell( const Grid& grid, const std::vector<SurfacePatch>& patches, const std::vector<CellDraft>& shell,
	std::vector<CellDraft>& cells, Lattice& lattice )
{
	ShellLinker( grid, patches ).merge( shell, cells, lattice );
}

} // namespace pliant
