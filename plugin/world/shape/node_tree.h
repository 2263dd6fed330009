#pragma once

// Builds trees over the spheres of a body's nodes, as a whole or in place of one leaf. Bullet's insertion of single leaves takes twenty
// times as long, which would dominate the cost of a fracture or of a change of levels.

#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include <cstddef>
#include <vector>

namespace pliant {

class TaskRunner;

/// Builds a tree over the children `which` of a compound, at least one, by recursive bisection along the longest side. Boxes are not set.
btDbvtNode* buildNodeTree( btCompoundShapeChild* children, const std::vector<int>& which );

/// Replaces `leaf`, which is freed, by the tree `top`.
void replaceLeaf( btDbvt& tree, btDbvtNode* leaf, btDbvtNode* top, int leaves );

/// Appends the inner nodes below and including `top`, children before parents.
void collectInner( btDbvtNode* top, std::vector<btDbvtNode*>& inner );

/// The inner nodes of one tree in an order in which their boxes can be computed: children before parents, and branch by branch, so that
/// threads can share a large tree. A box is the union of its children's boxes, in any order.
class TreeRefit
{
public:
	void reserve( std::size_t inner ) { m_inner.reserve( inner ); }
	/// Collects them from the root, which may be null.
	void collect( btDbvtNode* root );
	/// Prepends the inner nodes of trees that replaced leaves, children before parents. The contents of `fresh` are unspecified afterwards.
	void prepend( std::vector<btDbvtNode*>& fresh );
	/// Computes all inner boxes from the leaves' boxes. `runner` may be null.
	void run( TaskRunner* runner ) const;

private:
	void run( int first, int last ) const;

	std::vector<btDbvtNode*> m_inner;  // below replaced leaves, then the branches, then the nodes above them
	std::vector<int> m_branch = { 0 }; // start of each branch, and end of the last
};

/// Updates the boxes of a node's ancestors up to the first that does not change.
void refitUpwards( btDbvtNode* node );

} // namespace pliant
