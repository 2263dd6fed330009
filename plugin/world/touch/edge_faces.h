#pragma once

// Faces of the drawn surface at its edges and corners, for objects so small that they fit between the nodes' spheres there.

#include "world/touch/contact_surface.h"

namespace pliant {

/// Finds the flat face that continues in front of a node without a patch, in the plane of a linked node's. Among several, which meet at the
/// edge, the one that an object is least behind. `at`: the object's point nearest to the node, from its centre, m. False if there is none.
bool findEdgeFace( const ContactSurface& surface, const Body& body, int node, const Vec3d& at, ContactSurface::Patch& face );

} // namespace pliant
