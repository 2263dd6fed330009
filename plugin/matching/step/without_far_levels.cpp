// For builds without far levels: materials that need them are rejected (material.cpp), so none of this is ever called.

#include "matching/step/coarse_to_fine.h"

namespace pliant {

int usefulFarLevels( const Lattice&, int )
{
	return 0;
}

CoarseToFine::CoarseToFine( const Lattice& lattice, int, const RegionTables&, const std::vector<float>& ) : m_lattice( lattice ) {}

void CoarseToFine::reset() {}
void CoarseToFine::match( MatchView&, const FarFractions&, const Kernels&, TaskRunner* ) {}

} // namespace pliant
