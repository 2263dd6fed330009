#pragma once

// What a node has hit, as a point of Bullet's manifolds.

class btManifoldPoint;
class btPersistentManifold;

namespace pliant {

class ContactProxy;
struct NodeHit;

/// The hit as Bullet's solver wants it: the points on both surfaces, the normal on the second object, who it is. What a point is given
/// besides when it is made is given again; its age, its impulses and the game's pointer stay.
void fillPoint(
	const btPersistentManifold& manifold, const ContactProxy& node, const NodeHit& hit, bool nodeIsFirst, btManifoldPoint& point );

/// Where it lies: what a copy would be made of has just been written in parts, and would be waited for.
void renewPoint( btPersistentManifold& manifold, const ContactProxy& node, const NodeHit& hit, bool nodeIsFirst, int at );

/// The old point that a hit carries on: of the same triangle or part. A manifold of one point keeps it wherever it slides.
int findPoint( const btPersistentManifold& manifold, const NodeHit& hit, int hitCount, bool nodeIsFirst );

/// The game may change a new or renewed point, as with any contact of Bullet's. What it is shown of the other object is the child or the
/// triangle that is touched, as Bullet shows it. `leaf`: NodeHit::other().
void tellAdded( const btPersistentManifold& manifold, btManifoldPoint& point, int leaf );

} // namespace pliant
