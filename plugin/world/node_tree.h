#pragma once

// Trees over the spheres of a body's nodes, all at once or in place of one leaf. Bullet's own way, leaf by leaf, takes twenty times as long,
// which is the worst of what a fracture, or a change of levels, would cost.

#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include <vector>

namespace pliant {

/// A tree over children `which` of a compound, halved along its longest side again and again. At least one. Boxes are not set.
btDbvtNode* buildNodeTree( btCompoundShapeChild* children, const std::vector<int>& which );

/// Puts the tree `top` where `leaf` stood, which is freed.
void replaceLeaf( btDbvt& tree, btDbvtNode* leaf, btDbvtNode* top, int leaves );

/// Inner nodes from `top` down, children before parents.
void collectInner( btDbvtNode* top, std::vector<btDbvtNode*>& inner );

/// Boxes of a node's parents, as far up as they change.
void refitUpwards( btDbvtNode* node );

} // namespace pliant
