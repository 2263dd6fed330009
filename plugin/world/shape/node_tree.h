#pragma once

// Trees over the spheres of a body's nodes, all at once or in place of one leaf. Bullet's own way, leaf by leaf, takes twenty times as
// long, which is the worst of what a fracture, or a change of levels, would cost.

#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include <cstddef>
#include <vector>

namespace pliant {

class TaskRunner;

/// A tree's nodes lie anywhere in memory, and waiting for them is most of a refit: each is asked for this many steps ahead.
inline constexpr int kAskedAhead = 8;

/// A tree over children `which` of a compound, halved along its longest side again and again. At least one. Boxes are not set.
btDbvtNode* buildNodeTree( btCompoundShapeChild* children, const std::vector<int>& which );

/// Puts the tree `top` where `leaf` stood, which is freed.
void replaceLeaf( btDbvt& tree, btDbvtNode* leaf, btDbvtNode* top, int leaves );

/// Inner nodes from `top` down, children before parents.
void collectInner( btDbvtNode* top, std::vector<btDbvtNode*>& inner );

/// The inner nodes of one tree in an order in which their boxes can be set: children before parents, and branch by branch, so that threads
/// can share a large tree. A box is the union of its children's, whoever comes first.
class TreeRefit
{
public:
	void reserve( std::size_t inner ) { m_inner.reserve( inner ); }
	/// Anew from the root, which may be null.
	void collect( btDbvtNode* root );
	/// Trees were put where leaves were: their inner nodes, children before parents. `fresh` is left with what does not matter.
	void putBefore( std::vector<btDbvtNode*>& fresh );
	/// Sets all inner boxes from the leaves'. `runner` may be null.
	void run( TaskRunner* runner ) const;
	std::size_t count() const { return m_inner.size(); }

private:
	void run( int first, int last ) const;

	std::vector<btDbvtNode*> m_inner;  // below old leaves, then the branches, then what is above them
	std::vector<int> m_branch = { 0 }; // where each branch begins, and where the last one ends
};

/// Boxes of a node's parents, as far up as they change.
void refitUpwards( btDbvtNode* node );

} // namespace pliant
