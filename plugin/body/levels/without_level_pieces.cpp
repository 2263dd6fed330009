// In a build with fracture and without levels of detail: what pieces would take over of levels.

#include "body/body.h"
#include "body/breaking.h"
#include "body/levels/levels.h"

namespace pliant {

void Levels::measureLeftRows( const Material& ) {}

void Body::inheritLevels( const Body&, BodyPiece&, PieceRoad ) {}
void Body::prepareToBreak() {}

std::unique_ptr<Body> Body::relinkWhole( const std::shared_ptr<const Lattice>&, BodyPiece& )
{
	return nullptr;
}

} // namespace pliant
