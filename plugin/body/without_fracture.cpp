// For builds without fracture: no body ever breaks, Body::m_breaking stays null, and this is never called.

#include "body/breaking.h"
#include "fracture/shards/shard_cracks.h"

namespace pliant {

Breaking::Breaking() = default;

Breaking::~Breaking() = default;

void Breaking::prepare( const Lattice&, const Material&, std::vector<float> ) {}

} // namespace pliant
