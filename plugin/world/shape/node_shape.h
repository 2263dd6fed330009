#pragma once

// A soft body's collision shape: one Bullet compound of shared spheres, one a colliding node, its tree refitted after each step.
// Ray, sweep and contact tests, ghosts and debug drawing work on it as on any compound. A substep's own searches ask sphere_rows.h.

#include "body/body.h"
#include "matching/node_state.h"
#include "world/shape/node_colliders.h"
#include "world/shape/node_tree.h"
#include "world/shape/sphere_rows.h"

#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>

#include <map>
#include <memory>
#include <vector>

namespace pliant {

class NodeShape : public btCompoundShape
{
public:
	BT_DECLARE_ALIGNED_ALLOCATOR();

	/// Spheres for the nodes of the surface and one layer below it: with a bare shell, what once got through meets nothing.
	explicit NodeShape( const Body& body );

	/// Takes out the spheres of nodes that the body's last change of levels did away with and puts in those of new ones, in their places;
	/// those of others stay where they are. `shift` as below. `isPlacedNext`: place() comes before anybody asks for spheres' places.
	void followLevels( const Body& body, const Vec3& shift, bool isPlacedNext = false );

	/// The body's links have changed, and it may have lost nodes: those before are now `nodeNow`, or kNoNode; those it has were
	/// `nodeBefore`. Those that now lie at the surface get their spheres. False where it takes a new shape: where nodes lie at the surface
	/// no more, many do that did not, or a fifth has gone. `change`: of bodies with levels; `nodeBefore` empty where it is not known. All
	/// are to be placed.
	bool followCracks( const Body& body, const std::vector<std::uint32_t>& nodeNow, const std::vector<std::uint32_t>& nodeBefore,
		const CollidersChange& change );

	/// The spheres go where the nodes are. `shift`: the shape's own origin in the nodes' coordinates. `runner` may be null. What Bullet is
	/// asked (the compound's children and its tree) stays where it is until it is freshened: most of a substep's work for nothing while
	/// only we ask.
	void place( const NodeState& nodes, const Vec3& shift, TaskRunner* runner = nullptr );
	/// Children and tree go where the spheres are.
	void freshen( TaskRunner* runner = nullptr );
	bool isStale() const { return m_isStale; }
	/// Both.
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

	/// What a substep's searches ask: the spheres where the nodes are, in the shape's own coordinates.
	const SphereRows& rows() const { return m_rows; }
	/// Bullet's tree, where it was last freshened.
	const btDbvt& tree() const { return *m_dynamicAabbTree; }

	std::size_t bytes() const;

private:
	void addUniform( const Lattice& lattice );
	void removeChild( int child );
	bool renumber( const std::vector<std::uint32_t>& nodeNow, const std::vector<std::uint32_t>& before );
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
	SphereRows m_rows;
	bool m_areRowsKnown = false; // nothing has come, gone or changed its number since they were arranged
	bool m_isStale = false;      // the tree stands where the spheres no longer are
	TreeRefit m_refit;
	bool m_isRefitKnown = false; // of the tree as it is
	NodeColliders m_colliders;   // of bodies with levels only
	btScalar m_largestRadius = btScalar( 0 ), m_smallestRadius = btScalar( SIMD_INFINITY );
	btVector3 m_sweepLow = btVector3( 0, 0, 0 ), m_sweepHigh = btVector3( 0, 0, 0 );
};

} // namespace pliant
