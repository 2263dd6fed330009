#include "world/node_shape.h"

#include "body/levels.h"
#include "world/constants.h"

#include <algorithm>
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

NodeShape::NodeShape( const Body& body ) : btCompoundShape( true, body.nodeCount() ), m_childOfNode( body.nodeCount(), -1 )
{
	const Lattice& lattice = body.lattice();
	m_sphereOfNode.reserve( body.nodeCount() );
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		if ( const Levels* levels = body.levels() )
		{
			const Octree& octree = levels->octree();
			const RegionMatrix& regions = levels->matrix();
			const auto isSurface = [&]( std::uint32_t slot ) { return octree.isSurface[levels->cut().node[slot]] != 0; };
			const auto first = regions.member.begin() + regions.start[i], last = regions.member.begin() + regions.start[i + 1];
			const std::uint32_t node = levels->cut().node[i];
			addNode( i, octree.restCentre[node], octree.mass[node], lattice.cellSize, std::any_of( first, last, isSurface ) );
			continue;
		}
		const auto isSurface = [&lattice]( std::uint32_t cell ) { return lattice.isSurface[cell] != 0; };
		const auto first = lattice.linkTo.begin() + lattice.linkStart[i], last = lattice.linkTo.begin() + lattice.linkStart[i + 1];
		const bool collides = isSurface( std::uint32_t( i ) ) || std::any_of( first, last, isSurface );
		addNode( i, lattice.restCentre[i], lattice.fill[i], lattice.cellSize, collides );
	}
	m_dynamicAabbTree->optimizeTopDown();
	collectInner( m_dynamicAabbTree->m_root, m_inner );
}

void NodeShape::addNode( int node, const Vec3& restCentre, double cells, double cellSize, bool collides )
{
	// r = ( d / 2 ) cbrt( mass ). Departs from [O], where it is proportional to the mass: an eighth of a cell would be a dot.
	m_sphereOfNode.push_back( sphereOf( 0.5 * cellSize * std::cbrt( cells ) ) );
	if ( collides )
	{
		m_childOfNode[node] = int( m_nodeOfChild.size() );
		m_nodeOfChild.push_back( node );
		addChildShape( btTransform( btQuaternion::getIdentity(), btVector3( restCentre.x(), restCentre.y(), restCentre.z() ) ), m_sphereOfNode[node] );
	}
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
