// Which contacts meet the drawn surface of a body, and which its nodes' spheres.

#include "world/bodies/soft_body_impl.h"
#include "world/rigid/rigid_proxy.h"
#include "world/shape/contact_proxy.h"
#include "world/touch/edge_constants.h"
#include "world/touch/node_touch.h"

namespace pliant {

bool SoftBody::Impl::isMetAsDrawn() const
{
	return bodyTemplate->settings().contactSurface && !body->lattice().patch.empty() && surfaceNow().hasPatches();
}

bool SoftBody::Impl::isMetAsDrawnBy( const btCollisionObject& other ) const
{
	if ( other.getInternalType() == btCollisionObject::CO_FEATHERSTONE_LINK )
	{
		return false; // Bullet solves these contacts, each by one node
	}
	const bool isSoft = ownerOfContactProxy( &other ) || ownerOfRigidProxy( &other ) || SoftBody::upcast( &other );
	if ( isSoft || body->levels() || body->lattice().patch.empty() )
	{
		return isMetAsDrawn();
	}
	if ( !other.isStaticOrKinematicObject() || bodyTemplate->settings().contactSurface )
	{
		return surfaceNow().hasPatches();
	}
	return double( largestExtent( *other.getCollisionShape() ) ) < kSmallThing * double( body->lattice().cellSize ) &&
		surfaceNow().hasPatches();
}

} // namespace pliant
