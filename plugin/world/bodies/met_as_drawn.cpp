// Which contacts meet the drawn surface of a body, and which its nodes' spheres.

#include "world/bodies/soft_body_impl.h"
#include "world/rigid/rigid_proxy.h"
#include "world/shape/contact_proxy.h"
#include "world/touch/edge_constants.h"
#include "world/touch/node_touch.h"

namespace pliant {

namespace {

/// Fragments, whose faces fit into each other cell by cell, touch each other in their nodes' spheres; so do bodies that step explicitly,
/// since stacks of them would not come to rest on plane faces.
bool isWhole( const SoftBody::Impl& impl )
{
	return impl.isImplicit && !impl.body->levels() && !impl.family && impl.fractureVersion == 0 && !impl.body->lattice().patch.empty() &&
		impl.surfaceNow().hasPatches();
}

} // namespace

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
	const SoftBody* const owner = ownerOfContactProxy( &other );
	const SoftBody* const soft = owner ? owner : SoftBody::upcast( &other );
	if ( soft && &soft->impl() != this && isWhole( *this ) && isWhole( soft->impl() ) )
	{
		return true;
	}
	if ( soft || ownerOfRigidProxy( &other ) || body->levels() || body->lattice().patch.empty() )
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
