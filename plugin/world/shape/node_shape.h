#pragma once

// The spheres of a soft body's nodes: shared shapes, one per colliding node, which a substep's searches test in rows (sphere_rows.h).
// Bullet's queries use the drawn surface (query/surface_shape.h).

#include "body/body.h"
#include "matching/node_state.h"
#include "world/shape/node_colliders.h"
#include "world/shape/sphere_rows.h"

#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>

#include <map>
#include <memory>
#include <vector>

namespace pliant {

class Archive;

class NodeShape : public btCompoundShape
{
public:
	BT_DECLARE_ALIGNED_ALLOCATOR();

	/// Creates spheres for the nodes of the surface and of one layer below it, which stops objects that have passed the surface.
	explicit NodeShape( const Body& body );

	/// Replaces the spheres of nodes that the body's last change of levels removed by those of the new nodes; the others stay in place.
	/// `shift` as below. `isPlacedNext`: place() follows before any position is read.
	void followLevels( const Body& body, const Vec3& shift, bool isPlacedNext = false );

	/// Updates the shape after the body's links changed and nodes may have been lost. `nodeNow`: by previous number, kNoNode where lost;
	/// `nodeBefore`: by present number. Nodes that now lie at the surface receive spheres. Returns false where the shape must be rebuilt:
	/// where nodes no longer lie at the surface, many newly do, or a fifth is lost. `change`: for bodies with levels; its `nodeBefore` is
	/// empty where unknown. All spheres must be placed afterwards.
	bool followCracks( const Body& body, const std::vector<std::uint32_t>& nodeNow, const std::vector<std::uint32_t>& nodeBefore,
		const CollidersChange& change );

	/// Moves the spheres to the nodes. `shift`: the shape's own origin in the nodes' coordinates. `runner` may be null. The compound's
	/// children and tree, by which rows are arranged, stay unchanged until freshen().
	void place( const NodeState& nodes, const Vec3& shift, TaskRunner* runner = nullptr );
	/// Moves children and tree to the spheres, before leaves are added where they belong.
	void freshen();
	/// Nodes move by vectors between `low` and `high` in this step, m: the shape's box grows by it, the spheres' boxes do not.
	void setSweep( const btVector3& low, const btVector3& high );
	const btVector3& sweepLow() const { return m_sweepLow; }
	const btVector3& sweepHigh() const { return m_sweepHigh; }

	int nodeOfChild( int child ) const { return m_nodeOfChild[child]; }
	/// -1 for a node that does not collide.
	int childOfNode( int node ) const { return m_childOfNode[node]; }
	/// Every node has a sphere, in the compound or not: against a plane all nodes are tested, without a tree.
	btSphereShape* sphereOfNode( int node ) const { return m_sphereOfNode[node]; }
	btScalar radius( int child ) const { return m_sphereOfNode[m_nodeOfChild[child]]->getRadius(); }
	/// Bounds of the node radii, m; of a body with levels over all nodes of the octree.
	btScalar largestRadius() const { return m_largestRadius; }
	btScalar smallestRadius() const { return m_smallestRadius; }

	/// The spheres at the nodes' positions, in the shape's own coordinates, for a substep's searches.
	const SphereRows& rows() const { return m_rows; }
	/// Bullet's tree, as of the last freshen().
	const btDbvt& tree() const { return *m_dynamicAabbTree; }

	/// Writes or reads which nodes have spheres, and their sizes, where these do not follow from the lattice alone. `body`: that of the
	/// shape.
	void archive( Archive& archive, const Body& body );

private:
	void addUniform( const Lattice& lattice );
	void buildTree();
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
	void splitLeaf( int child, const std::vector<int>& into, const PlacedNodes& placed );
	btDbvtVolume boxOf( int child ) const;

	std::map<int, std::unique_ptr<btSphereShape>> m_spheres; // by radius step
	std::vector<int> m_nodeOfChild, m_childOfNode;
	std::vector<btSphereShape*> m_sphereOfNode;
	SphereRows m_rows;
	bool m_areRowsKnown = false; // no sphere was added, removed or renumbered since they were arranged
	bool m_isStale = false;      // children and tree are not at the spheres' positions
	NodeColliders m_colliders;   // bodies with levels only
	btScalar m_largestRadius = btScalar( 0 ), m_smallestRadius = btScalar( SIMD_INFINITY );
	btVector3 m_sweepLow = btVector3( 0, 0, 0 ), m_sweepHigh = btVector3( 0, 0, 0 );
};

} // namespace pliant
