// For builds without fracture: no body ever breaks, and Body::m_breaking stays null.

#include "body/body.h"
#include "body/breaking.h"
#include "fracture/shards/shard_cracks.h"

namespace pliant {

bool Body::hasBrokenLinks() const
{
	return false;
}

void Body::noteTurns( float ) {}

Breaking::Breaking() = default; // never called, like the functions below

Breaking::~Breaking() = default;

void Breaking::prepare( const Lattice&, const Material&, std::vector<float> ) {}

} // namespace pliant
