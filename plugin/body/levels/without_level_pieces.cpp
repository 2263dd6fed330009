// For builds with fracture and without levels of detail: levels of pieces.

#include "body/body.h"
#include "body/breaking.h"
#include "body/levels/levels.h"

namespace pliant {

void Levels::measureSkippedRows( const Material& ) {}

void Body::inheritLevels( const Body&, BodyPiece&, PieceBuild ) {}
void Body::prepareToBreak() {}

std::unique_ptr<Body> Body::relinkWhole( const std::shared_ptr<const Lattice>&, BodyPiece& )
{
	return nullptr;
}

} // namespace pliant
