#pragma once

// Decomposition of a shape into simple shapes.

#include "world/bodies/soft_body_impl.h"
#include "world/touch/node_touch.h"

#include <BulletCollision/CollisionShapes/btCompoundShape.h>

namespace pliant {

/// Calls visit( part ) for the obstacle or, recursively, for each part of a compound.
template <class Visit>
void visitParts( const Obstacle& obstacle, const Visit& visit )
{
	if ( !obstacle.shape->isCompound() )
	{
		visit( obstacle );
		return;
	}
	const auto* compound = static_cast<const btCompoundShape*>( obstacle.shape );
	for ( int child = 0; child < compound->getNumChildShapes(); ++child )
	{
		const btTransform& at = compound->getChildTransform( child );
		Obstacle part;
		part.shape = compound->getChildShape( child );
		part.basis = obstacle.basis * toMatrix3d( at.getBasis() );
		part.position = obstacle.position + obstacle.basis * toVec3d( at.getOrigin() );
		part.index = child;
		visitParts( part, visit );
	}
}

} // namespace pliant
