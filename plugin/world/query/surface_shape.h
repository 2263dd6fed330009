#pragma once

// The collision shape of a soft body in Bullet: its drawn surface, or the border of its cells if nothing is drawn. Rays, sweeps and contact
// tests meet it; a substep's own searches use the node spheres (node_shape.h). The triangles are computed at the time of a query.

#include "lattice/faces/boundary_faces.h"
#include "world/query/sphere_sweep.h"
#include "world/query/triangle_tree.h"

#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btConcaveShape.h>

#include <atomic>
#include <mutex>
#include <vector>

class btTriangleConvexcastCallback;
class btTriangleRaycastCallback;

namespace pliant {

class SoftBody;

/// Part and index of a hit are -1 and the child index of the nearest colliding node (NodeShape::childOfNode).
class SurfaceShape : public btConcaveShape
{
public:
	BT_DECLARE_ALIGNED_ALLOCATOR();

	explicit SurfaceShape( const SoftBody& owner );

	/// Rays and sweeps, which are recognised by the callback's class, get the triangles that they meet, nearest first; others all triangles
	/// that overlap the box.
	void processAllTriangles( btTriangleCallback* callback, const btVector3& low, const btVector3& high ) const override;

	/// Of the nodes' spheres and the drawn surface beyond them, m.
	void getAabb( const btTransform& at, btVector3& low, btVector3& high ) const override;
	void setLocalScaling( const btVector3& ) override {} ///< soft bodies have a scale of their own: SoftBody::setScale
	const btVector3& getLocalScaling() const override { return m_scaling; }
	void calculateLocalInertia( btScalar, btVector3& inertia ) const override { inertia.setZero(); }
	const char* getName() const override { return "PliantSurface"; }

	struct Piece
	{
		btVector3 corner[3]; ///< counter-clockwise seen from outside
	};
	/// The triangles whose boxes overlap a box, divided until no edge is longer than a cell, so that each is near one node. All in the
	/// shape's coordinates.
	std::vector<Piece> piecesIn( const btVector3& low, const btVector3& high ) const;
	/// The child index of the colliding node nearest to a point in the shape's coordinates; with levels of detail the one whose sphere is.
	int childNear( const btVector3& point ) const;
	/// Whether a point in the shape's coordinates is inside; then also the nearest point of the surface and the unit vector from the point
	/// to it.
	bool contains( const btVector3& point, btVector3& onSurface, btVector3& outwards ) const;

private:
	struct Surface
	{
		std::vector<float> positions, normals; ///< relative to the nodes' origin, m; normals empty: those of the faces
		TriangleView view;
		TriangleTree tree;
		std::vector<std::uint32_t> groupStart, groupTriangle; ///< triangles at the vertices that share a normal; empty where normals are
		BoundaryFaces boundary;                               ///< empty where a mesh is drawn
		unsigned links = 0;                                   ///< SoftBody::Impl::fractureVersion of `boundary`
		std::vector<float> nodeMaps;
	};

	const Surface& now() const;
	void update() const;
	bool placeDrawn() const;
	void placeBoundary() const;
	void castRay( btTriangleRaycastCallback& ray ) const;
	void castConvex( btTriangleConvexcastCallback& sweep ) const;
	Vec3d inNodes( const btVector3& point ) const;
	btVector3 fromNodes( const Vec3d& point ) const;
	void cornersOf( int triangle, Vec3d ( &corner )[3] ) const;
	void cornersOf( int triangle, btVector3 ( &corner )[3] ) const;
	void listCorners() const;
	/// Whether the triangles at a vertex meet at an angle, each counted once.
	bool isOnCrease( std::uint32_t vertex ) const;
	/// Whether the normal at a vertex, which has one, is near that of a face, and on no crease.
	bool isSmoothAt( std::uint32_t vertex, const Vec3d& face ) const;
	Vec3d normalAt( std::uint32_t vertex ) const;
	Vec3d smoothNormal( int triangle, const Vec3d& weights, const Vec3d& face ) const;

	friend struct SweepCall;

	const SoftBody& m_owner;
	btVector3 m_scaling = btVector3( 1, 1, 1 );
	mutable Surface m_surface;
	mutable std::mutex m_lock; // a game may cast rays on several threads
	mutable std::atomic<unsigned> m_moves{ 0 };
	mutable bool m_isKnown = false;
};

/// The compound that is the body's collision shape.
class BodyShape : public btCompoundShape
{
public:
	BT_DECLARE_ALIGNED_ALLOCATOR();

	explicit BodyShape( const SoftBody& owner ) : btCompoundShape( false ), m_surface( owner )
	{
		addChildShape( btTransform::getIdentity(), &m_surface );
	}
	void getAabb( const btTransform& at, btVector3& low, btVector3& high ) const override { m_surface.getAabb( at, low, high ); }
	const SurfaceShape& surface() const { return m_surface; }

private:
	SurfaceShape m_surface;
};

} // namespace pliant
