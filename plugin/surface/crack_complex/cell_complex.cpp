#include "surface/crack_complex/cell_complex.h"

#include "lattice/attempt.h"
#include "surface/crack_complex/complex_builder.h"

#include <algorithm>
#include <chrono>

namespace pliant {

Result<std::shared_ptr<const CellComplex>> CellComplex::build(
	const MeshView& mesh, const Lattice& lattice, const SkinBinding& skin, const LatticeSettings& build, const CrackSettings& settings )
{
	using Answer = Result<std::shared_ptr<const CellComplex>>;
	const auto start = std::chrono::steady_clock::now();
	return withinMemory( kNoMemoryToBuild, [&]() -> Answer {
		insist( check( settings ) );
		const auto made = std::make_shared<CellComplex>();
		buildComplex( mesh, lattice, skin, build, settings, *made );
		made->report.seconds = std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count();
		return Answer::success( made );
	} );
}

std::uint32_t CellComplex::faceBetween( std::uint32_t a, std::uint32_t b ) const
{
	const std::uint32_t low = std::min( a, b ), high = std::max( a, b );
	for ( const std::uint32_t* f = facesOfCell.begin( low ); f != facesOfCell.end( low ); ++f )
	{
		if ( face[*f].cellA == low && face[*f].cellB == high )
		{
			return *f;
		}
	}
	return kNone;
}

} // namespace pliant
