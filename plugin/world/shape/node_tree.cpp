#include "world/shape/node_tree.h"

#include "world/shape/shape_constants.h"
#include "world/shape/sphere_rows.h"

#include <algorithm>
#include <new>

namespace pliant {

namespace {

btDbvtNode* makeTreeNode( btDbvtNode* parent )
{
	// Allocated as btDbvt does, since the tree frees it.
	auto* const node = new ( btAlignedAlloc( sizeof( btDbvtNode ), int( alignof( btDbvtNode ) ) ) ) btDbvtNode();
	node->parent = parent;
	node->childs[1] = nullptr;
	return node;
}

class TreeBuilder
{
public:
	TreeBuilder( btCompoundShapeChild* children, const std::vector<int>& which ) : m_children( children )
	{
		m_order.reserve( which.size() );
		for ( const int child : which )
		{
			const btVector3& at = children[child].m_transform.getOrigin();
			m_order.push_back( Leaf{ { at.x(), at.y(), at.z() }, child } );
		}
	}

	btDbvtNode* build( btDbvtNode* parent, int first, int last ) // NOLINT(misc-no-recursion): as deep as the logarithm of the count
	{
		btDbvtNode* const node = makeTreeNode( parent );
		if ( last - first == 1 )
		{
			const int child = m_order[std::size_t( first )].child;
			node->dataAsInt = child;
			m_children[child].m_node = node;
			return node;
		}
		const int axis = longestAxis( first, last ), half = ( last - first ) / 2;
		// Whole rows of eight below each half: SphereRows takes the leaves in order.
		const int middle = first +
			( last - first > SphereRows::kWide ? ( half + SphereRows::kWide - 1 ) / SphereRows::kWide * SphereRows::kWide : half );
		const auto begin = m_order.begin();
		std::nth_element( begin + first, begin + middle, begin + last,
			[axis]( const Leaf& a, const Leaf& b ) { return a.at[axis] != b.at[axis] ? a.at[axis] < b.at[axis] : a.child < b.child; } );
		node->childs[0] = build( node, first, middle );
		node->childs[1] = build( node, middle, last );
		return node;
	}

private:
	struct Leaf
	{
		btScalar at[3];
		int child;
	};

	/// The last of equal axes: nodes are numbered along z last, so that the first half of the tree holds the first half of the node arrays,
	/// and a thread reads the data that it wrote in the stage before.
	int longestAxis( int first, int last ) const
	{
		btVector3 low( BT_LARGE_FLOAT, BT_LARGE_FLOAT, BT_LARGE_FLOAT ), high( -low );
		for ( int k = first; k < last; ++k )
		{
			const btScalar* const p = m_order[std::size_t( k )].at;
			const btVector3 at( p[0], p[1], p[2] );
			low.setMin( at );
			high.setMax( at );
		}
		const btVector3 extent = high - low;
		const btScalar least = extent[extent.maxAxis()] * ( 1 - kEqualExtents );
		return extent.z() >= least ? 2 : extent.y() >= least ? 1 : 0;
	}

	btCompoundShapeChild* m_children;
	std::vector<Leaf> m_order;
};

} // namespace

btDbvtNode* buildNodeTree( btCompoundShapeChild* children, const std::vector<int>& which )
{
	return TreeBuilder( children, which ).build( nullptr, 0, int( which.size() ) );
}

void replaceLeaf( btDbvt& tree, btDbvtNode* leaf, btDbvtNode* top, int leaves )
{
	top->parent = leaf->parent;
	if ( leaf->parent )
	{
		leaf->parent->childs[leaf->parent->childs[1] == leaf ? 1 : 0] = top;
	}
	else
	{
		tree.m_root = top;
	}
	tree.m_leaves += leaves - 1;
	btAlignedFree( leaf );
}

void refitBelow( btDbvtNode* top )
{
	// Parents before children, then reversed. Not recursive, since the tree may be deep.
	std::vector<btDbvtNode*> inner, stack( 1, top );
	while ( !stack.empty() )
	{
		btDbvtNode* const node = stack.back();
		stack.pop_back();
		if ( node && node->isinternal() )
		{
			inner.push_back( node );
			stack.push_back( node->childs[0] );
			stack.push_back( node->childs[1] );
		}
	}
	std::for_each(
		inner.rbegin(), inner.rend(), []( btDbvtNode* node ) { Merge( node->childs[0]->volume, node->childs[1]->volume, node->volume ); } );
}

void refitUpwards( btDbvtNode* node )
{
	for ( btDbvtNode* parent = node->parent; parent; parent = parent->parent )
	{
		const btDbvtVolume before = parent->volume;
		Merge( parent->childs[0]->volume, parent->childs[1]->volume, parent->volume );
		if ( !NotEqual( before, parent->volume ) )
		{
			return;
		}
	}
}

} // namespace pliant
