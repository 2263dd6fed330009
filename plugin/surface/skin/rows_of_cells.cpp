#include "surface/skin/rows_of_cells.h"

#include "surface/crack_complex/cell_complex.h"

namespace pliant {

// Most rows contain none of the cells, so entries are tested eight at a time, regardless of rows.
std::vector<char> rowsThatHold( const SkinBinding& binding, const std::vector<char>& isWanted )
{
	constexpr std::size_t kWide = 8;
	const std::size_t rows = binding.start.size() - 1, entries = binding.node.size();
	std::vector<char> holds( rows, 0 );
	std::size_t row = 0;
	const auto mark = [&]( std::size_t first, std::size_t end ) {
		for ( std::size_t k = first; k < end; ++k )
		{
			if ( isWanted[binding.node[k]] != 0 )
			{
				for ( ; binding.start[row + 1] <= k; ++row )
				{}
				holds[row] = 1;
			}
		}
	};
	std::size_t first = 0;
	for ( ; first + kWide <= entries; first += kWide )
	{
		const std::uint32_t* const node = binding.node.data() + first;
		int any = 0;
		for ( std::size_t k = 0; k < kWide; ++k )
		{
			any |= isWanted[node[k]];
		}
		if ( any != 0 )
		{
			mark( first, first + kWide );
		}
	}
	mark( first, entries );
	return holds;
}

// A side that has lost all carriers of its point follows one of the cells that draw inComplex (CrackGatherer::writeRow).
std::vector<char> rowsAtPointsOf( const SkinBinding& binding, const std::vector<char>& isWanted, const CellComplex& complex,
	const std::vector<std::uint32_t>& cellsInComplex )
{
	std::vector<char> isMarked( complex.pointCount(), 0 );
	for ( std::size_t cell = 0; cell < isWanted.size(); ++cell )
	{
		const std::size_t inComplex = cellsInComplex.empty() ? cell : cellsInComplex[cell];
		for ( const Table* points : { &complex.boundPoints, &complex.pointsOfCell } )
		{
			for ( const std::uint32_t* p = points->begin( inComplex ); isWanted[cell] != 0 && p != points->end( inComplex ); ++p )
			{
				isMarked[*p] = 1;
			}
		}
	}
	const std::size_t rows = binding.start.size() - 1;
	std::vector<char> isNear( rows );
	for ( std::size_t row = 0; row < rows; ++row )
	{
		isNear[row] = binding.carrierOf( row ) == row ? isMarked[binding.point[row]] : char( 0 );
	}
	return isNear;
}

} // namespace pliant
