#pragma once

// Builds trees over the spheres of a body's nodes, as a whole or in place of one leaf. Bullet's insertion of single leaves takes twenty
// times as long, which would dominate the cost of a fracture or of a change of levels.

#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include <vector>

namespace pliant {

/// Builds a tree over the children `which` of a compound, at least one, by recursive bisection along the longest side. Boxes are not set.
btDbvtNode* buildNodeTree( btCompoundShapeChild* children, const std::vector<int>& which );

/// Replaces `leaf`, which is freed, by the tree `top`.
void replaceLeaf( btDbvt& tree, btDbvtNode* leaf, btDbvtNode* top, int leaves );

/// Computes the boxes of the inner nodes below and including `top`, which may be null, from those of the leaves.
void refitBelow( btDbvtNode* top );

/// Updates the boxes of a node's ancestors up to the first that does not change.
void refitUpwards( btDbvtNode* node );

} // namespace pliant
