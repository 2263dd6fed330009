#include "matching/lattice_matcher.h"

#include "matching/reference_matcher.h"

namespace pliant {

std::unique_ptr<Matcher> makeLatticeMatcher( const Lattice& lattice, const Material& material )
{
	return std::make_unique<ReferenceMatcher>( lattice, material );
}

} // namespace pliant
