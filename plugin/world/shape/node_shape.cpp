#include "world/shape/node_shape.h"

#include "archive/archive.h"
#include "body/levels/levels.h"
#include "threads/parallel.h"
#include "world/constants.h"
#include "world/shape/node_tree.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

namespace pliant {

namespace {

/// Whether a cell belongs to the surface or to the layer below it.
bool isNearSurface( const Lattice& lattice, int cell )
{
	bool isNear = lattice.isSurface[cell] != 0;
	for ( std::uint32_t k = lattice.linkStart[cell]; !isNear && k < lattice.linkStart[cell + 1]; ++k )
	{
		isNear = lattice.isSurface[lattice.linkTo[k]] != 0;
	}
	return isNear;
}

} // namespace

NodeShape::NodeShape( const Body& body ) : btCompoundShape( true, body.nodeCount() ), m_childOfNode( body.nodeCount(), -1 )
{
	if ( const Levels* levels = body.levels() )
	{
		m_colliders = measureColliders( body.lattice(), levels->octree() );
		m_smallestRadius = btScalar( *std::min_element( m_colliders.radius.begin(), m_colliders.radius.end() ) );
		const int capacity = levels->scratchNodes();
		m_children.reserve( capacity );
		m_nodeOfChild.reserve( std::size_t( capacity ) );
		m_sphereOfNode.reserve( std::size_t( capacity ) );
		for ( int i = 0; i < body.nodeCount(); ++i )
		{
			const std::uint32_t node = levels->cut().node[i];
			m_sphereOfNode.push_back( sphereOf( double( m_colliders.radius[node] ) ) );
			if ( m_colliders.collides[node] != 0 )
			{
				addChild( i, levels->octree().restCentre[node], m_sphereOfNode[i] );
			}
		}
	}
	else
	{
		addUniform( body.lattice() );
		m_smallestRadius = m_spheres.begin()->second->getRadius(); // ascending
	}
	buildTree();
}

void NodeShape::buildTree()
{
	std::vector<int> all( std::size_t( m_children.size() ) );
	std::iota( all.begin(), all.end(), 0 );
	m_dynamicAabbTree->m_root = buildNodeTree( &m_children[0], all );
	m_dynamicAabbTree->m_leaves = m_children.size();
}

void NodeShape::addUniform( const Lattice& lattice )
{
	m_sphereOfNode.reserve( lattice.cellCount() );
	for ( int i = 0; i < lattice.cellCount(); ++i )
	{
		// r = ( d / 2 ) cbrt( fill ). Departs from [O], where it is proportional to the mass: an eighth of a cell would be a point.
		const bool isAlike = i > 0 && lattice.fill[i] == lattice.fill[i - 1];
		m_sphereOfNode.push_back( isAlike ? m_sphereOfNode.back() : sphereOf( 0.5 * lattice.cellSize * std::cbrt( lattice.fill[i] ) ) );
		if ( isNearSurface( lattice, i ) )
		{
			addChild( i, lattice.restCentre[i], m_sphereOfNode[i] );
		}
	}
}

bool NodeShape::collides( const Body& body, int node ) const
{
	const Levels* const levels = body.levels();
	return levels ? m_colliders.collides[levels->cut().node[std::size_t( node )]] != 0 : isNearSurface( body.lattice(), node );
}

/// The last child moves into the gap.
void NodeShape::removeChild( int child )
{
	removeChildShapeByIndex( child );
	m_nodeOfChild[child] = m_nodeOfChild.back();
	m_nodeOfChild.pop_back();
}

// Adds the child only; the tree is built when all are present.
void NodeShape::addChild( int node, const Vec3& at, btSphereShape* sphere )
{
	m_childOfNode[node] = int( m_nodeOfChild.size() );
	m_nodeOfChild.push_back( node );
	btCompoundShapeChild child;
	child.m_transform = btTransform( btQuaternion::getIdentity(), btVector3( at.x(), at.y(), at.z() ) );
	child.m_childShape = sphere;
	child.m_childShapeType = sphere->getShapeType();
	child.m_childMargin = sphere->getMargin();
	child.m_node = nullptr;
	m_children.push_back( child );
}

void NodeShape::addNode( int node, const Vec3& at, btSphereShape* sphere )
{
	m_childOfNode[node] = int( m_nodeOfChild.size() );
	m_nodeOfChild.push_back( node );
	addChildShape( btTransform( btQuaternion::getIdentity(), btVector3( at.x(), at.y(), at.z() ) ), sphere );
}

namespace {

/// New nodes that collide, listed by the split node they came from: those of node i are node[start[i]] to node[start[i + 1] - 1].
struct NewChildren
{
	std::vector<int> start, node;

	NewChildren( const LevelChange& change, const std::function<bool( int )>& collides ) : start( change.nodeNow.size() + 1, 0 )
	{
		for ( int i = 0; i < int( change.source.size() ); ++i )
		{
			const std::uint32_t source = change.source[std::size_t( i )];
			if ( change.nodeNow[source] == kNoNode && collides( i ) )
			{
				++start[source + 1];
				node.push_back( i ); // ascending in both
			}
		}
		std::partial_sum( start.begin(), start.end(), start.begin() );
	}
	int count( int before ) const { return start[std::size_t( before ) + 1] - start[std::size_t( before )]; }
};

} // namespace

// The parts of a split node replace its leaf in the tree. Shape indices are then unordered; contacts are sorted by node.
void NodeShape::followLevels( const Body& body, const Vec3& shift, bool isPlacedNext )
{
	freshen();
	const Levels& levels = *body.levels();
	const LevelChange& change = levels.lastChange();
	const auto collides = [&]( int node ) { return m_colliders.collides[levels.cut().node[std::size_t( node )]] != 0; };
	const NewChildren added( change, collides );
	renumberSpheres( levels );
	for ( int child = int( m_nodeOfChild.size() ); child-- > 0; )
	{
		const int node = m_nodeOfChild[child];
		if ( change.keptAs[std::size_t( node )] == kNoNode && added.count( node ) == 0 )
		{
			removeChild( child );
		}
	}
	m_childOfNode.assign( std::size_t( body.nodeCount() ), -1 );
	for ( int child = 0, count = int( m_nodeOfChild.size() ); child < count; ++child )
	{
		const int before = m_nodeOfChild[child];
		if ( const std::uint32_t now = change.keptAs[std::size_t( before )]; now != kNoNode )
		{
			m_nodeOfChild[child] = int( now );
			m_childOfNode[now] = child;
			continue;
		}
		const auto first = added.node.begin() + added.start[std::size_t( before )];
		splitLeaf( child, std::vector<int>( first, first + added.count( before ) ), PlacedNodes{ body.nodes(), shift } );
	}
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		if ( m_childOfNode[i] < 0 && collides( i ) ) // merged
		{
			addNode( i, body.nodes().x.get( i ) - shift, m_sphereOfNode[i] );
		}
	}
	m_areRowsKnown = false;
	if ( !isPlacedNext )
	{
		place( body.nodes(), shift );
	}
}

void NodeShape::renumberSpheres( const Levels& levels )
{
	const LevelChange& change = levels.lastChange();
	std::vector<btSphereShape*> spheres( levels.cut().node.size(), nullptr );
	for ( std::size_t before = 0; before < change.keptAs.size(); ++before )
	{
		if ( change.keptAs[before] != kNoNode )
		{
			spheres[change.keptAs[before]] = m_sphereOfNode[before];
		}
	}
	for ( std::size_t i = 0; i < spheres.size(); ++i )
	{
		spheres[i] = spheres[i] ? spheres[i] : sphereOf( double( m_colliders.radius[levels.cut().node[i]] ) );
	}
	m_sphereOfNode.swap( spheres );
}

/// The first new node takes over the child.
void NodeShape::splitLeaf( int child, const std::vector<int>& into, const PlacedNodes& placed )
{
	btDbvtNode* const leaf = m_children[child].m_node;
	std::vector<int> which;
	for ( const int node : into )
	{
		which.push_back( which.empty() ? child : m_children.size() );
		if ( which.size() > 1 )
		{
			addChild( node, Vec3::Zero(), m_sphereOfNode[node] );
		}
		else
		{
			m_nodeOfChild[child] = node;
			m_childOfNode[node] = child;
			m_children[child].m_childShape = m_sphereOfNode[node];
			m_children[child].m_childMargin = m_sphereOfNode[node]->getMargin();
		}
		const Vec3 at = placed.nodes.x.get( node ) - placed.shift;
		m_children[which.back()].m_transform.setOrigin( btVector3( at.x(), at.y(), at.z() ) );
	}
	btDbvtNode* const top = buildNodeTree( &m_children[0], which );
	replaceLeaf( *m_dynamicAabbTree, leaf, top, int( which.size() ) );
	for ( const int part : which )
	{
		m_children[part].m_node->volume = boxOf( part );
	}
	refitBelow( top );
	refitUpwards( top );
}

btDbvtVolume NodeShape::boxOf( int child ) const
{
	const btVector3& at = m_children[child].m_transform.getOrigin();
	const btScalar r = radius( child ) * ( 1 + kContactSlop );
	const btVector3 around( r, r, r );
	return btDbvtVolume::FromMM( at - around, at + around );
}

btSphereShape* NodeShape::sphereOf( double radius )
{
	const int step = int( std::lround( std::log2( radius ) * kRadiusStepsPerOctave ) );
	std::unique_ptr<btSphereShape>& shape = m_spheres[step];
	if ( !shape )
	{
		shape = std::make_unique<btSphereShape>( btScalar( std::exp2( step / kRadiusStepsPerOctave ) ) );
	}
	m_largestRadius = btMax( m_largestRadius, shape->getRadius() );
	return shape.get();
}

void NodeShape::place( const NodeState& nodes, const Vec3& shift, TaskRunner* runner )
{
	if ( !m_areRowsKnown )
	{
		m_rows.arrange( m_dynamicAabbTree->m_root, m_nodeOfChild, m_sphereOfNode );
		m_areRowsKnown = true;
	}
	m_rows.place( nodes, shift, runner );
	m_isStale = true;
	setSweep( btVector3( 0, 0, 0 ), btVector3( 0, 0, 0 ) );
}

void NodeShape::freshen()
{
	if ( !m_isStale )
	{
		return;
	}
	m_isStale = false;
	m_rows.visitPositions( 0, m_rows.count(), [&]( int node, const btVector3& at ) {
		const int child = m_childOfNode[std::size_t( node )];
		m_children[child].m_transform.setOrigin( at );
		m_children[child].m_node->volume = boxOf( child );
	} );
	refitBelow( m_dynamicAabbTree->m_root );
}

void NodeShape::setSweep( const btVector3& low, const btVector3& high )
{
	m_sweepLow = low;
	m_sweepHigh = high;
	m_sweepLow.setMin( btVector3( 0, 0, 0 ) );
	m_sweepHigh.setMax( btVector3( 0, 0, 0 ) );
	m_localAabbMin = m_rows.whole().mins() + m_sweepLow;
	m_localAabbMax = m_rows.whole().maxs() + m_sweepHigh;
}

// Those of an unbroken body without levels follow from its lattice. On levels the number that a child has depends on the changes so far,
// and where cells were lost a radius may differ in its last bits.
void NodeShape::archive( Archive& archive, const Body& body )
{
	if ( !body.levels() && body.firstCells().empty() )
	{
		return;
	}
	std::vector<int> nodes = m_nodeOfChild;
	archive.sameLength( m_colliders.radius );
	archive.sameLength( m_colliders.collides );
	archive.sameLength( m_colliders.depth );
	archive( m_largestRadius, m_smallestRadius, nodes );
	const int count = body.nodeCount();
	std::vector<int> sorted = nodes;
	std::sort( sorted.begin(), sorted.end() );
	archive.require( !nodes.empty() && sorted.front() >= 0 && sorted.back() < count &&
			std::adjacent_find( sorted.begin(), sorted.end() ) == sorted.end() && m_smallestRadius > 0 && m_largestRadius > 0 &&
			std::isfinite( m_largestRadius ),
		"The spheres are those of another body." );
	for ( const float radius : m_colliders.radius )
	{
		archive.require( radius > 0.0f && std::isfinite( radius ), "A sphere has an impossible radius." );
	}
	if ( !archive.isReading() || !archive.isSound() )
	{
		return;
	}
	const btScalar largest = m_largestRadius;
	m_children.resizeNoInitialize( 0 );
	m_nodeOfChild.clear();
	m_childOfNode.assign( std::size_t( count ), -1 );
	m_dynamicAabbTree->clear();
	for ( int i = 0; body.levels() && i < count; ++i )
	{
		m_sphereOfNode[std::size_t( i )] = sphereOf( double( m_colliders.radius[body.levels()->cut().node[std::size_t( i )]] ) );
	}
	m_largestRadius = largest;
	for ( const int node : nodes )
	{
		addChild( node, body.nodes().x.get( node ), m_sphereOfNode[std::size_t( node )] );
	}
	buildTree();
	m_areRowsKnown = false;
}

} // namespace pliant
