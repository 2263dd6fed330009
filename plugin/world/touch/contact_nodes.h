#pragma once

// The nodes that take the impulses of a contact, and the position at which it acts.

#include "world/touch/shared_nodes.h"

class btCollisionObject;
class btManifoldPoint;

namespace pliant {

class ContactProxy;

/// Sets the nodes of a contact between the nodes' own spheres: the node, and between two round surfaces also the node behind it. Returns
/// the position at which it acts, world, m: the node's centre for both sides, which conserves angular momentum.
Vec3d distributeToNodes( const ContactProxy* const ( &nodes )[2], SharedNodes ( &shared )[2] );

/// Sets the nodes that share a contact with a drawn surface, on each side that is a node. Returns the position at which it acts on the
/// other side, world, m: the point that the nodes' weights reproduce, which conserves angular momentum. Friction acts midway between node
/// and surface, but at the surface itself on a rigid object that moves, where its longer arm would tip small ones over, and between bodies.
Vec3d distributeOnSurface( const ContactProxy* const ( &nodes )[2], const btCollisionObject* const ( &objects )[2],
	const btManifoldPoint& point, SharedNodes ( &shared )[2] );

} // namespace pliant
