// For builds without fracture: a body that can break is refused before these are called.

#include "archive/archive.h"
#include "body/breaking.h"

namespace pliant {

void Breaking::archiveMake( Archive& archive, const Lattice&, const Material&, bool )
{
	archive.refuse( "This build of the library has no fracture." );
}

void Breaking::archiveState( Archive& archive, const Lattice& )
{
	archive.refuse( "This build of the library has no fracture." );
}

} // namespace pliant
