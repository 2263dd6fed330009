#include "world/node_shape.h"

#include "body/levels.h"
#include "world/constants.h"

#include <algorithm>
#include <cmath>
#include <new>

namespace pliant {

namespace {

void collectInner( btDbvtNode* node, std::vector<btDbvtNode*>& inner )
{
	// Parents before children on the stack, then turned round: no recursion, the tree may be deep.
	std::vector<btDbvtNode*> stack( 1, node );
	while ( !stack.empty() )
	{
		btDbvtNode* top = stack.back();
		stack.pop_back();
		if ( top && top->isinternal() )
		{
			inner.push_back( top );
			stack.push_back( top->childs[0] );
			stack.push_back( top->childs[1] );
		}
	}
	std::vector<btDbvtNode*>( inner.rbegin(), inner.rend() ).swap( inner );
}

btDbvtNode* makeTreeNode( btDbvtNode* parent )
{
	// As btDbvt makes them: it is the tree that frees them.
	auto* const node = new ( btAlignedAlloc( sizeof( btDbvtNode ), 16 ) ) btDbvtNode();
	node->parent = parent;
	node->childs[1] = nullptr;
	return node;
}

/// Leaf by leaf into a tree takes twenty times as long as all at once: beyond this share of what is in it, it is made anew.
constexpr double kMostPutIn = 0.05;

/// Cells of the surface and one layer below.
bool isNearSurface( const Lattice& lattice, int cell )
{
	bool isNear = lattice.isSurface[cell] != 0;
	for ( std::uint32_t k = lattice.linkStart[cell]; !isNear && k < lattice.linkStart[cell + 1]; ++k )
	{
		isNear = lattice.isSurface[lattice.linkTo[k]] != 0;
	}
	return isNear;
}

/// A tree over all children at once, halved along its longest side again and again: Bullet's own way, leaf by leaf and then rebuilt, takes
/// twenty times as long, which is the worst of what a fracture would cost.
class TreeBuilder
{
public:
	TreeBuilder( btCompoundShapeChild* children, int count ) : m_children( children )
	{
		m_order.reserve( std::size_t( count ) );
		for ( int i = 0; i < count; ++i )
		{
			const btVector3& at = children[i].m_transform.getOrigin();
			m_order.push_back( Leaf{ { at.x(), at.y(), at.z() }, i } );
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
		const int axis = longestAxis( first, last ), middle = ( first + last ) / 2;
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

	int longestAxis( int first, int last ) const
	{
		btVector3 low( BT_LARGE_FLOAT, BT_LARGE_FLOAT, BT_LARGE_FLOAT ), high( -low );
		for ( int k = first; k < last; ++k )
		{
			const btScalar* const place = m_order[std::size_t( k )].at;
			const btVector3 at( place[0], place[1], place[2] );
			low.setMin( at );
			high.setMax( at );
		}
		return ( high - low ).maxAxis();
	}

	btCompoundShapeChild* m_children;
	std::vector<Leaf> m_order;
};

} // namespace

NodeShape::NodeShape( const Body& body ) : btCompoundShape( true, body.nodeCount() ), m_childOfNode( body.nodeCount(), -1 )
{
	if ( const Levels* levels = body.levels() )
	{
		m_colliders = measureColliders( body.lattice(), levels->octree() );
		const int room = levels->roomNodes();
		m_children.reserve( room );
		m_nodeOfChild.reserve( std::size_t( room ) );
		m_sphereOfNode.reserve( std::size_t( room ) );
		m_inner.reserve( std::size_t( room ) );
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
	}
	TreeBuilder builder( &m_children[0], m_children.size() );
	m_dynamicAabbTree->m_root = builder.build( nullptr, 0, m_children.size() );
	m_dynamicAabbTree->m_leaves = m_children.size();
	collectInner( m_dynamicAabbTree->m_root, m_inner );
}

void NodeShape::addUniform( const Lattice& lattice )
{
	m_sphereOfNode.reserve( lattice.cellCount() );
	for ( int i = 0; i < lattice.cellCount(); ++i )
	{
		// r = ( d / 2 ) cbrt( fill ). Departs from [O], where it is proportional to the mass: an eighth of a cell would be a dot.
		m_sphereOfNode.push_back( sphereOf( 0.5 * lattice.cellSize * std::cbrt( lattice.fill[i] ) ) );
		if ( isNearSurface( lattice, i ) )
		{
			addChild( i, lattice.restCentre[i], m_sphereOfNode[i] );
		}
	}
}

bool NodeShape::followCracks( const Body& body )
{
	const Lattice& lattice = body.lattice();
	std::vector<int> bare;
	for ( int i = 0; i < lattice.cellCount(); ++i )
	{
		const bool collides = isNearSurface( lattice, i );
		if ( !collides && m_childOfNode[i] >= 0 )
		{
			return false;
		}
		if ( collides && m_childOfNode[i] < 0 )
		{
			bare.push_back( i );
		}
	}
	if ( double( bare.size() ) > kMostPutIn * double( m_nodeOfChild.size() ) )
	{
		return false;
	}
	for ( const int i : bare )
	{
		addNode( i, body.nodes().x.get( i ), m_sphereOfNode[i] ); // placed with all others when the substep goes on
	}
	if ( !bare.empty() )
	{
		m_inner.clear();
		collectInner( m_dynamicAabbTree->m_root, m_inner );
	}
	return true;
}

// The child alone; the tree is built when all are there.
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

// Shape indices are in no order afterwards; contacts are sorted by node, so that nothing follows from that.
void NodeShape::followLevels( const Body& body, const Vec3& shift )
{
	const Levels& levels = *body.levels();
	const LevelChange& change = levels.lastChange();
	std::vector<btSphereShape*> spheres( std::size_t( body.nodeCount() ), nullptr );
	for ( std::size_t before = 0; before < change.keptAs.size(); ++before )
	{
		if ( change.keptAs[before] != kNoNode )
		{
			spheres[change.keptAs[before]] = m_sphereOfNode[before];
		}
	}
	m_childOfNode.assign( std::size_t( body.nodeCount() ), -1 );
	for ( int child = int( m_nodeOfChild.size() ); child-- > 0; )
	{
		const std::uint32_t now = change.keptAs[std::size_t( m_nodeOfChild[child] )];
		if ( now == kNoNode )
		{
			removeChildShapeByIndex( child ); // the last child moves into the gap
			m_nodeOfChild[child] = m_nodeOfChild.back();
			m_nodeOfChild.pop_back();
			continue;
		}
		m_nodeOfChild[child] = int( now );
	}
	for ( std::size_t child = 0; child < m_nodeOfChild.size(); ++child )
	{
		m_childOfNode[std::size_t( m_nodeOfChild[child] )] = int( child );
	}
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		const std::uint32_t node = levels.cut().node[i];
		if ( spheres[i] )
		{
			continue;
		}
		spheres[i] = sphereOf( double( m_colliders.radius[node] ) );
		if ( m_colliders.collides[node] != 0 )
		{
			addNode( i, body.nodes().x.get( i ) - shift, spheres[i] );
		}
	}
	m_sphereOfNode.swap( spheres );
	m_inner.clear();
	collectInner( m_dynamicAabbTree->m_root, m_inner );
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

void NodeShape::update( const NodeState& nodes, const Vec3& shift )
{
	for ( int child = 0; child < m_children.size(); ++child )
	{
		const int i = m_nodeOfChild[child];
		const Vec3 at = nodes.x.get( i ) - shift;
		const btVector3 p( at.x(), at.y(), at.z() );
		const btScalar r = radius( child ) * ( 1 + kContactSlop );
		const btVector3 around( r, r, r );
		m_children[child].m_transform.setOrigin( p );
		m_children[child].m_node->volume = btDbvtVolume::FromMM( p - around, p + around );
	}
	for ( btDbvtNode* node : m_inner )
	{
		Merge( node->childs[0]->volume, node->childs[1]->volume, node->volume );
	}
	setSweep( btVector3( 0, 0, 0 ), btVector3( 0, 0, 0 ) );
}

void NodeShape::setSweep( const btVector3& low, const btVector3& high )
{
	m_sweepLow = low;
	m_sweepHigh = high;
	m_sweepLow.setMin( btVector3( 0, 0, 0 ) );
	m_sweepHigh.setMax( btVector3( 0, 0, 0 ) );
	m_localAabbMin = m_dynamicAabbTree->m_root->volume.Mins() + m_sweepLow;
	m_localAabbMax = m_dynamicAabbTree->m_root->volume.Maxs() + m_sweepHigh;
}

std::size_t NodeShape::bytes() const
{
	return std::size_t( m_children.size() ) * ( sizeof( btCompoundShapeChild ) + sizeof( btDbvtNode ) + sizeof( int ) ) +
		   m_inner.size() * ( sizeof( btDbvtNode ) + sizeof( btDbvtNode* ) ) + m_childOfNode.size() * ( sizeof( int ) + sizeof( btSphereShape* ) ) +
		   m_colliders.bytes();
}

} // namespace pliant
