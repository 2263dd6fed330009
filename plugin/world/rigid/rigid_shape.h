#pragma once

// The collision shape of a body in its rigid state: convex hulls around the spheres of its nodes.

#include "body/body.h"

#include <BulletCollision/CollisionShapes/btConvexHullShape.h>

#include <memory>
#include <vector>

namespace pliant {

class NodeShape;

/// One hull where that fits the material, else a compound of several.
class RigidShape
{
public:
	/// For a body in its rigid state, in the axes of its frame. `spheres`: the body's.
	RigidShape( const Body& body, const NodeShape& spheres );

	btCollisionShape& shape() const { return m_compound ? *m_compound : static_cast<btCollisionShape&>( *m_hulls.front() ); }

private:
	std::vector<std::unique_ptr<btConvexHullShape>> m_hulls;
	std::unique_ptr<btCollisionShape> m_compound;
};

} // namespace pliant
