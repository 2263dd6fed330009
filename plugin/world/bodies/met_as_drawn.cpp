// Which contacts meet the drawn surface of a body, and which its nodes' spheres.

#include "body/levels/levels.h"
#include "world/bodies/soft_body_impl.h"
#include "world/rigid/rigid_proxy.h"
#include "world/shape/contact_proxy.h"
#include "world/touch/edge_constants.h"
#include "world/touch/node_touch.h"

#include <cmath>

namespace pliant {

namespace {

bool hasPatches( const SoftBody::Impl& impl )
{
	return !impl.body->lattice().patch.empty() && impl.surfaceNow().hasPatches();
}

/// Fragments, whose faces fit into each other cell by cell, touch each other in their nodes' spheres; so do bodies that step explicitly,
/// since stacks of them would not come to rest on plane faces.
bool areMetAsDrawn( const SoftBody::Impl& a, const SoftBody::Impl& b )
{
	const auto isOne = []( const SoftBody::Impl& impl ) { return impl.isImplicit && impl.isUnbroken() && hasPatches( impl ); };
	return &a != &b && isOne( a ) && isOne( b );
}

/// How wide a shape is where it may slip between spheres, m: of a convex one the width of a post, or kSmallThing times the thickness of a
/// wall where that is less; of others the largest extent.
btScalar slipExtent( const btCollisionShape& shape )
{
	btVector3 low, high;
	shape.getAabb( btTransform::getIdentity(), low, high );
	const btVector3 extents = high - low;
	const btScalar least = extents[extents.minAxis()], most = extents[extents.maxAxis()];
	const btScalar middle = extents.x() + extents.y() + extents.z() - least - most;
	return shape.isConvex() ? btMin( middle, btScalar( kSmallThing ) * least ) : most;
}

} // namespace

bool SoftBody::Impl::isMetAsDrawn() const
{
	return bodyTemplate->settings().contactSurface && hasPatches( *this );
}

bool SoftBody::Impl::isMetAsDrawnBy( const btCollisionObject& other ) const
{
	if ( other.getInternalType() == btCollisionObject::CO_FEATHERSTONE_LINK )
	{
		return false; // Bullet solves these contacts, each by one node
	}
	const SoftBody* const owner = ownerOfContactProxy( &other );
	const SoftBody* const soft = owner ? owner : SoftBody::upcast( &other );
	if ( soft || ownerOfRigidProxy( &other ) )
	{
		return isMetAsDrawn() || ( soft && areMetAsDrawn( *this, soft->impl() ) );
	}
	const int levels = body->levels() ? body->levels()->settings().coarseLevels : 0;
	const bool meetsIt = bodyTemplate->settings().contactSurface || !other.isStaticOrKinematicObject() ||
		double( slipExtent( *other.getCollisionShape() ) ) < kSmallThing * std::ldexp( double( body->lattice().cellSize ), levels );
	return meetsIt && hasPatches( *this );
}

} // namespace pliant
