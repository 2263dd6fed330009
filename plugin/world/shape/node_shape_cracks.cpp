// Updates of the collision shape after a crack, which changes few spheres.

#include "body/levels/levels.h"
#include "world/shape/node_shape.h"
#include "world/shape/shape_constants.h"

#include <algorithm>

namespace pliant {

/// Removes the spheres of lost nodes. `before`: the previous number of each node. True where no number changed.
bool NodeShape::renumber( const std::vector<std::uint32_t>& nodeNow, const std::vector<std::uint32_t>& before )
{
	for ( int child = int( m_nodeOfChild.size() ); before.size() < nodeNow.size() && child-- > 0; )
	{
		if ( nodeNow[std::size_t( m_nodeOfChild[child] )] == kNoNode )
		{
			removeChild( child );
		}
	}
	if ( before.size() == nodeNow.size() && std::is_sorted( nodeNow.begin(), nodeNow.end() ) )
	{
		return true; // nothing lost: all numbers are unchanged
	}
	std::vector<btSphereShape*> spheres( before.size() );
	for ( std::size_t i = 0; i < before.size(); ++i )
	{
		spheres[i] = m_sphereOfNode[before[i]];
	}
	m_sphereOfNode.swap( spheres );
	m_childOfNode.assign( before.size(), -1 );
	for ( std::size_t child = 0; child < m_nodeOfChild.size(); ++child )
	{
		m_nodeOfChild[child] = int( nodeNow[std::size_t( m_nodeOfChild[child] )] );
		m_childOfNode[std::size_t( m_nodeOfChild[child] )] = int( child );
	}
	return false;
}

// Radii are unchanged: links change between finest cells only, whose radius does not depend on them.
bool NodeShape::followCracks( const Body& body, const std::vector<std::uint32_t>& nodeNow, const std::vector<std::uint32_t>& nodeBefore,
	const CollidersChange& change )
{
	if ( double( nodeBefore.size() ) < kLeastRemaining * double( nodeNow.size() ) )
	{
		return false;
	}
	if ( const Levels* levels = body.levels() )
	{
		const bool isKnown = !change.nodeBefore.empty();
		m_colliders = isKnown ? followColliders( body.lattice(), levels->octree(), m_colliders, change )
							  : measureColliders( body.lattice(), levels->octree() );
		m_smallestRadius = btScalar( *std::min_element( m_colliders.radius.begin(), m_colliders.radius.end() ) );
	}
	std::vector<int> exposed;
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		const bool isNear = collides( body, i ), wasNear = m_childOfNode[std::size_t( nodeBefore[std::size_t( i )] )] >= 0;
		if ( !isNear && wasNear )
		{
			return false;
		}
		if ( isNear && !wasNear )
		{
			exposed.push_back( i );
		}
	}
	if ( double( exposed.size() ) > kMostInserted * double( m_nodeOfChild.size() ) )
	{
		return false;
	}
	const bool hasLost = nodeBefore.size() < nodeNow.size(), isSameTree = exposed.empty() && !hasLost;
	if ( !isSameTree )
	{
		freshen(); // leaves are inserted and removed by their boxes
	}
	const bool keepsNumbers = renumber( nodeNow, nodeBefore );
	if ( hasLost && !body.levels() )
	{
		const auto isSmaller = []( const btSphereShape* a, const btSphereShape* b ) { return a->getRadius() < b->getRadius(); };
		const auto [smallest, largest] = std::minmax_element( m_sphereOfNode.begin(), m_sphereOfNode.end(), isSmaller );
		m_smallestRadius = ( *smallest )->getRadius();
		m_largestRadius = ( *largest )->getRadius();
	}
	for ( const int i : exposed )
	{
		addNode( i, body.nodes().x.get( i ), m_sphereOfNode[i] ); // placed with all others when the substep continues
	}
	m_areRowsKnown = m_areRowsKnown && isSameTree && keepsNumbers;
	return true;
}

} // namespace pliant
