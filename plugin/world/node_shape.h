#pragma once

// A soft body's collision shape: one Bullet compound of shared spheres, one a colliding node, its tree refitted after each substep.
// Ray, sweep and contact tests, ghosts and debug drawing work on it as on any compound.

#include "body/body.h"
#include "matching/node_state.h"
#include "world/node_colliders.h"
#include "world/node_tree.h"

#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>

#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace pliant {

/// Nodes of two trees that are still to be looked at together.
using TreePair = std::pair<const btDbvtNode*, const btDbvtNode*>;

class NodeShape : public btCompoundShape
{
public:
	BT_DECLARE_ALIGNED_ALLOCATOR();

	/// Spheres for the nodes of the surface and one layer below it: with a bare shell, what once got through meets nothing.
	explicit NodeShape( const Body& body );

	/// Takes out the spheres of nodes that the body's last change of levels did away with and puts in those of new ones, in their places; those
	/// of others stay where they are. `shift` as below.
	void followLevels( const Body& body, const Vec3& shift );

	/// The body's links have changed, and it may have lost nodes: those before are now `nodeNow`, or kNoNode; those it has were `nodeBefore`. Those that
	/// now lie at the surface get their spheres. False where it takes a new shape: where nodes lie at the surface no more, many do that did not,
	/// or a fifth has gone. `treeBefore`: BodyPiece::treeBefore.
	bool followCracks( const Body& body, const std::vector<std::uint32_t>& nodeNow, const std::vector<std::uint32_t>& nodeBefore,
		const std::vector<std::uint32_t>& treeBefore );

	/// Writes the spheres' places and boxes and refits the tree. `shift`: the shape's own origin in the nodes' coordinates.
	/// `runner` may be null.
	void update( const NodeState& nodes, const Vec3& shift, TaskRunner* runner = nullptr );
	/// The nodes may move by anything between `low` and `high`, m, in this step: the shape's box grows by it, the spheres' do not.
	void setSweep( const btVector3& low, const btVector3& high );
	const btVector3& sweepLow() const { return m_sweepLow; }
	const btVector3& sweepHigh() const { return m_sweepHigh; }

	int nodeOfChild( int child ) const { return m_nodeOfChild[child]; }
	/// -1 for a node that does not collide.
	int childOfNode( int node ) const { return m_childOfNode[node]; }
	/// Every node has a sphere, in the compound or not: against a plane all of them are tested, for there no tree is needed.
	btSphereShape* sphereOfNode( int node ) const { return m_sphereOfNode[node]; }
	btScalar radius( int child ) const { return m_sphereOfNode[m_nodeOfChild[child]]->getRadius(); }
	/// Radii that no node is larger, or smaller, than, m; with levels: none there ever could be.
	btScalar largestRadius() const { return m_largestRadius; }
	btScalar smallestRadius() const { return m_smallestRadius; }

	/// Calls visit( child ) for every child whose box meets the box, which is in the shape's own coordinates. `stack` is scratch that the
	/// caller keeps, so that only the first calls allocate.
	template <class Visit>
	void visitOverlaps( const btVector3& low, const btVector3& high, btNodeStack& stack, Visit&& visit ) const
	{
		struct Collect : btDbvt::ICollide
		{
			explicit Collect( Visit& v ) : call( v ) {}
			void Process( const btDbvtNode* leaf ) override { call( leaf->dataAsInt ); }
			Visit& call;
		} collect( visit );
		const btDbvtVolume box = btDbvtVolume::FromMM( low, high );
		m_dynamicAabbTree->collideTVNoStackAlloc( m_dynamicAabbTree->m_root, box, stack, collect );
	}
	/// Calls visit( childA, childB ) for every pair of children of two shapes whose boxes meet, a's moved by `shift` and stretched by `low` and
	/// `high`, which are not above and not below zero.
	struct Stretch
	{
		btVector3 shift, low, high;
	};
	template <class Visit>
	static void visitPairs( const NodeShape& a, const NodeShape& b, const Stretch& stretch, std::vector<TreePair>& waiting, Visit&& visit )
	{
		const btVector3 low = stretch.shift + stretch.low, high = stretch.shift + stretch.high;
		waiting.assign( 1, { a.m_dynamicAabbTree->m_root, b.m_dynamicAabbTree->m_root } );
		while ( !waiting.empty() )
		{
			const auto [one, other] = waiting.back();
			waiting.pop_back();
			const btVector3 oneLow = one->volume.Mins() + low, oneHigh = one->volume.Maxs() + high;
			const btVector3 &otherLow = other->volume.Mins(), &otherHigh = other->volume.Maxs();
			if ( oneLow.x() > otherHigh.x() || oneHigh.x() < otherLow.x() || oneLow.y() > otherHigh.y() || oneHigh.y() < otherLow.y() ||
				 oneLow.z() > otherHigh.z() || oneHigh.z() < otherLow.z() )
			{
				continue;
			}
			const bool isLeaf = one->isleaf(), isOtherLeaf = other->isleaf();
			if ( isLeaf && isOtherLeaf )
			{
				visit( one->dataAsInt, other->dataAsInt );
			}
			else if ( isOtherLeaf || ( !isLeaf && isLarger( one->volume, other->volume ) ) )
			{
				waiting.push_back( { one->childs[0], other } );
				waiting.push_back( { one->childs[1], other } );
			}
			else
			{
				waiting.push_back( { one, other->childs[0] } );
				waiting.push_back( { one, other->childs[1] } );
			}
		}
	}
	const btDbvt& tree() const { return *m_dynamicAabbTree; }

	std::size_t bytes() const;

private:
	static bool isLarger( const btDbvtVolume& a, const btDbvtVolume& b )
	{
		return ( a.Maxs() - a.Mins() ).length2() > ( b.Maxs() - b.Mins() ).length2();
	}
	void addUniform( const Lattice& lattice );
	void removeChild( int child );
	void renumber( const std::vector<std::uint32_t>& nodeNow, const std::vector<std::uint32_t>& before );
	bool collides( const Body& body, int node ) const;
	void addChild( int node, const Vec3& at, btSphereShape* sphere );
	void addNode( int node, const Vec3& at, btSphereShape* sphere );
	btSphereShape* sphereOf( double radius );
	struct PlacedNodes
	{
		const NodeState& nodes;
		const Vec3& shift;
	};
	void renumberSpheres( const Levels& levels );
	void splitLeaf( int child, const std::vector<int>& into, std::vector<btDbvtNode*>& inner, const PlacedNodes& placed );
	btDbvtVolume boxOf( int child ) const;

	std::map<int, std::unique_ptr<btSphereShape>> m_spheres; // by radius step
	std::vector<int> m_nodeOfChild, m_childOfNode;
	std::vector<btSphereShape*> m_sphereOfNode;
	TreeRefit m_refit;
	NodeColliders m_colliders; // of bodies with levels only
	btScalar m_largestRadius = btScalar( 0 ), m_smallestRadius = btScalar( SIMD_INFINITY );
	btVector3 m_sweepLow = btVector3( 0, 0, 0 ), m_sweepHigh = btVector3( 0, 0, 0 );
};

} // namespace pliant
