#include "world/io/broadphase_record.h"

#include "world/io/object_state.h"

#include <algorithm>
#include <functional>

namespace pliant {

namespace {

int indexOf( const void* client )
{
	return static_cast<const btCollisionObject*>( client )->getWorldArrayIndex();
}

btDbvtProxy* proxyOf( const btCollisionObject& object )
{
	return static_cast<btDbvtProxy*>( const_cast<btBroadphaseProxy*>( object.getBroadphaseHandle() ) );
}

/// The fields that a step changes, in one order.
template <class Broadphase>
auto countersOf( Broadphase& b )
{
	return std::array{ &b.m_stageCurrent, &b.m_newpairs, &b.m_fixedleft, &b.m_pid, &b.m_cid, &b.m_gid, &b.m_fupdates, &b.m_dupdates };
}

} // namespace

void BroadphaseRecord::Box::archive( Archive& archive )
{
	archive( low, high );
}

void BroadphaseRecord::Node::archive( Archive& archive )
{
	archive( box, object, rank );
}

void BroadphaseRecord::Tree::archive( Archive& archive )
{
	archive( nodes, hasFree, freeRank, lookahead, path );
}

void BroadphaseRecord::Proxy::archive( Archive& archive )
{
	archive( box, stage, id );
}

// Bullet may have been built without run-time type information, so the class is recognised by its table of virtual functions.
btDbvtBroadphase* BroadphaseRecord::treesOf( btBroadphaseInterface& broadphase )
{
	static btDbvtBroadphase known;
	return isSameClass( broadphase, known ) ? static_cast<btDbvtBroadphase*>( &broadphase ) : nullptr;
}

void BroadphaseRecord::readTree( const btDbvt& from, Tree& tree )
{
	std::vector<const btDbvtNode*> inOrder, stack;
	from.m_root ? stack.push_back( from.m_root ) : void();
	while ( !stack.empty() )
	{
		const btDbvtNode* const node = stack.back();
		stack.pop_back();
		inOrder.push_back( node );
		if ( node->isinternal() )
		{
			stack.push_back( node->childs[1] );
			stack.push_back( node->childs[0] );
		}
	}
	std::vector<const btDbvtNode*> byAddress = inOrder;
	from.m_free ? byAddress.push_back( from.m_free ) : void();
	std::sort( byAddress.begin(), byAddress.end(), std::less<>() );
	const auto rankOf = [&byAddress]( const btDbvtNode* node ) {
		return std::uint32_t( std::lower_bound( byAddress.begin(), byAddress.end(), node, std::less<>() ) - byAddress.begin() );
	};
	for ( const btDbvtNode* const node : inOrder )
	{
		const int object = node->isleaf() ? indexOf( static_cast<const btDbvtProxy*>( node->data )->m_clientObject ) : -1;
		tree.nodes.push_back( Node{ Box{ node->volume.Mins(), node->volume.Maxs() }, object, rankOf( node ) } );
	}
	tree.hasFree = from.m_free != nullptr;
	tree.freeRank = tree.hasFree ? rankOf( from.m_free ) : 0;
	tree.lookahead = from.m_lkhd;
	tree.path = from.m_opath;
}

void BroadphaseRecord::fillTree( const Tree& tree, btDbvt& to, const Objects& objects ) const
{
	std::vector<btDbvtNode*> memory;
	for ( std::size_t k = 0; k < tree.nodes.size() + ( tree.hasFree ? 1 : 0 ); ++k )
	{
		memory.push_back( new ( btAlignedAlloc( sizeof( btDbvtNode ), 16 ) ) btDbvtNode() );
	}
	std::sort( memory.begin(), memory.end(), std::less<>() );
	std::vector<btDbvtNode*> open; // inner nodes that lack a child
	to.m_leaves = 0;
	for ( const Node& from : tree.nodes )
	{
		btDbvtNode* const node = memory[from.rank];
		node->volume = btDbvtVolume::FromMM( from.box.low, from.box.high );
		node->parent = open.empty() ? nullptr : open.back();
		node->childs[0] = node->childs[1] = nullptr;
		if ( !node->parent )
		{
			to.m_root = node;
		}
		else
		{
			node->parent->childs[node->parent->childs[0] ? 1 : 0] = node;
			node->parent->childs[1] ? open.pop_back() : void();
		}
		if ( from.object < 0 )
		{
			open.push_back( node );
			continue;
		}
		btDbvtProxy* const proxy = proxyOf( *objects[from.object] );
		node->data = proxy;
		proxy->leaf = node;
		++to.m_leaves;
	}
	to.m_free = tree.hasFree ? memory[tree.freeRank] : nullptr;
	to.m_lkhd = tree.lookahead;
	to.m_opath = tree.path;
}

void BroadphaseRecord::readTrees( const btDbvtBroadphase& from, const Objects& objects )
{
	int leaves = 0;
	for ( int k = 0; k < 2; ++k )
	{
		readTree( from.m_sets[k], m_trees[k] );
		leaves += from.m_sets[k].m_leaves;
	}
	for ( int k = 0; k < 3; ++k )
	{
		for ( const btDbvtProxy* proxy = from.m_stageRoots[k]; proxy; proxy = proxy->links[1] )
		{
			m_stages[k].push_back( indexOf( proxy->m_clientObject ) );
		}
	}
	const auto counters = countersOf( from );
	for ( std::size_t k = 0; k < counters.size(); ++k )
	{
		m_counters[k] = *counters[k];
	}
	m_calls = from.m_updates_call;
	m_done = from.m_updates_done;
	m_needsCleanup = from.m_needcleanup;
	m_hasTrees = leaves == objects.size() && areComplete( objects.size() );
}

void BroadphaseRecord::fillTrees( btDbvtBroadphase& to, const Objects& objects ) const
{
	for ( int k = 0; k < 2; ++k )
	{
		to.m_sets[k].clear();
		fillTree( m_trees[k], to.m_sets[k], objects );
	}
	for ( int k = 0; k < objects.size(); ++k )
	{
		const Proxy& from = m_proxies[std::size_t( k )];
		btDbvtProxy* const proxy = proxyOf( *objects[k] );
		proxy->m_aabbMin = from.box.low;
		proxy->m_aabbMax = from.box.high;
		proxy->stage = from.stage;
		proxy->m_uniqueId = from.id;
	}
	for ( int k = 0; k < 3; ++k )
	{
		to.m_stageRoots[k] = nullptr;
		btDbvtProxy* before = nullptr;
		for ( const int object : m_stages[k] )
		{
			btDbvtProxy* const proxy = proxyOf( *objects[object] );
			( before ? before->links[1] : to.m_stageRoots[k] ) = proxy;
			proxy->links[0] = before;
			proxy->links[1] = nullptr;
			before = proxy;
		}
	}
	const auto counters = countersOf( to );
	for ( std::size_t k = 0; k < counters.size(); ++k )
	{
		*counters[k] = m_counters[k];
	}
	to.m_updates_call = m_calls;
	to.m_updates_done = m_done;
	to.m_updates_ratio = m_calls > 0 ? btScalar( m_done ) / btScalar( m_calls ) : btScalar( 0 );
	to.m_needcleanup = m_needsCleanup;
}

BroadphaseRecord BroadphaseRecord::of( btBroadphaseInterface& broadphase, const Objects& objects, bool withTrees )
{
	BroadphaseRecord record;
	const btDbvtBroadphase* const trees = withTrees ? treesOf( broadphase ) : nullptr;
	for ( int k = 0; k < objects.size(); ++k )
	{
		const btBroadphaseProxy& proxy = *objects[k]->getBroadphaseHandle();
		record.m_proxies.push_back(
			Proxy{ Box{ proxy.m_aabbMin, proxy.m_aabbMax }, trees ? proxyOf( *objects[k] )->stage : 0, trees ? proxy.m_uniqueId : 0 } );
	}
	if ( trees )
	{
		record.readTrees( *trees, objects );
	}
	return record;
}

void BroadphaseRecord::applyTo( btBroadphaseInterface& broadphase, Objects& objects, btDispatcher* dispatcher ) const
{
	btDbvtBroadphase* const trees = treesOf( broadphase );
	if ( trees && m_hasTrees && trees->m_sets[0].m_leaves + trees->m_sets[1].m_leaves == objects.size() )
	{
		fillTrees( *trees, objects );
		return;
	}
	for ( int k = 0; k < objects.size(); ++k )
	{
		const Box& box = m_proxies[std::size_t( k )].box;
		broadphase.setAabb( objects[k]->getBroadphaseHandle(), box.low, box.high, dispatcher );
	}
}

/// Whether both trees are whole, each object is a leaf of one of them and in one list, and ranks and ids are all different.
bool BroadphaseRecord::areComplete( int objects ) const
{
	std::vector<int> leaves, listed, ids;
	for ( const Tree& tree : m_trees )
	{
		std::vector<std::uint32_t> ranks;
		std::size_t missing = tree.nodes.empty() ? 0 : 1;
		for ( const Node& node : tree.nodes )
		{
			if ( missing == 0 )
			{
				return false;
			}
			missing += node.object < 0 ? 1 : std::size_t( -1 );
			ranks.push_back( node.rank );
			node.object >= 0 ? leaves.push_back( node.object ) : void();
		}
		tree.hasFree ? ranks.push_back( tree.freeRank ) : void();
		std::sort( ranks.begin(), ranks.end() );
		for ( std::size_t k = 0; k < ranks.size(); ++k )
		{
			missing += ranks[k] != k ? 1 : 0;
		}
		if ( missing != 0 )
		{
			return false;
		}
	}
	for ( const std::vector<int>& stage : m_stages )
	{
		listed.insert( listed.end(), stage.begin(), stage.end() );
	}
	for ( const Proxy& proxy : m_proxies )
	{
		ids.push_back( proxy.id );
	}
	for ( std::vector<int>* const list : { &leaves, &listed, &ids } )
	{
		std::sort( list->begin(), list->end() );
	}
	bool areAll = leaves.size() == std::size_t( objects ) && leaves == listed && ids.size() == leaves.size() &&
		std::adjacent_find( ids.begin(), ids.end() ) == ids.end() && ( ids.empty() || ( ids.front() >= 0 && ids.back() <= m_counters[5] ) );
	for ( int k = 0; areAll && k < objects; ++k )
	{
		areAll = leaves[std::size_t( k )] == k;
	}
	return areAll && areStaged();
}

/// Whether the stages of the proxies are those of their trees and lists; the objects exist.
bool BroadphaseRecord::areStaged() const
{
	bool areRight = true;
	for ( int stage = 0; stage < 3; ++stage )
	{
		for ( const int object : m_stages[stage] )
		{
			areRight = areRight && m_proxies[std::size_t( object )].stage == stage;
		}
	}
	for ( int k = 0; k < 2; ++k )
	{
		for ( const Node& node : m_trees[k].nodes )
		{
			const bool isFixed = node.object >= 0 && m_proxies[std::size_t( node.object )].stage == btDbvtBroadphase::STAGECOUNT;
			areRight = areRight && ( node.object < 0 || isFixed == ( k == btDbvtBroadphase::FIXED_SET ) );
		}
	}
	return areRight;
}

void BroadphaseRecord::archive( Archive& archive, int objects )
{
	archive( m_proxies, m_hasTrees, m_trees, m_stages, m_counters, m_calls, m_done, m_needsCleanup );
	archive.require( !archive.isReading() || ( m_proxies.size() == std::size_t( objects ) && ( !m_hasTrees || areComplete( objects ) ) ),
		"The broadphase is not whole." );
	archive.require( m_counters[0] >= 0 && m_counters[0] < btDbvtBroadphase::STAGECOUNT && m_counters[4] >= 0 && m_counters[1] >= 0,
		"The broadphase's counters are out of range." );
}

} // namespace pliant
