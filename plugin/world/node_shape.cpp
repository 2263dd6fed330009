#include "world/node_shape.h"

#include "world/constants.h"

#include <cmath>

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

} // namespace

NodeShape::NodeShape( const Lattice& lattice ) : btCompoundShape( true, lattice.cellCount() ), m_childOfNode( lattice.cellCount(), -1 )
{
	m_sphereOfNode.reserve( lattice.cellCount() );
	for ( int i = 0; i < lattice.cellCount(); ++i )
	{
		// r = ( d / 2 ) cbrt( fill ). Departs from [O], where it is proportional to the mass: an eighth of a cell would be a dot.
		m_sphereOfNode.push_back( sphereOf( 0.5 * lattice.cellSize * std::cbrt( lattice.fill[i] ) ) );
		bool collides = lattice.isSurface[i] != 0;
		for ( std::uint32_t k = lattice.linkStart[i]; !collides && k < lattice.linkStart[i + 1]; ++k )
		{
			collides = lattice.isSurface[lattice.linkTo[k]] != 0;
		}
		if ( !collides )
		{
			continue;
		}
		const Vec3& p = lattice.restCentre[i];
		m_childOfNode[i] = int( m_nodeOfChild.size() );
		m_nodeOfChild.push_back( i );
		addChildShape( btTransform( btQuaternion::getIdentity(), btVector3( p.x(), p.y(), p.z() ) ), m_sphereOfNode[i] );
	}
	m_dynamicAabbTree->optimizeTopDown();
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
		   m_inner.size() * ( sizeof( btDbvtNode ) + sizeof( btDbvtNode* ) ) + m_childOfNode.size() * ( sizeof( int ) + sizeof( btSphereShape* ) );
}

} // namespace pliant
