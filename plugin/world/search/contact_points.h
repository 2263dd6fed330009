#pragma once

// Conversion of a node's hit to a point of Bullet's manifolds.

class btManifoldPoint;
class btPersistentManifold;

namespace pliant {

class ContactProxy;
struct NodeHit;

/// Writes the hit as Bullet's solver expects it: the points on both surfaces, the normal on the second object, identifiers and combined
/// surface properties. Age, impulses and the game's pointer are kept.
void fillPoint(
	const btPersistentManifold& manifold, const ContactProxy& node, const NodeHit& hit, bool nodeIsFirst, btManifoldPoint& point );

/// Renews the point in place: a copy of a point just written in parts would stall on store forwarding.
void renewPoint( btPersistentManifold& manifold, const ContactProxy& node, const NodeHit& hit, bool nodeIsFirst, int at );

/// The old point that a hit continues: of the same triangle or part, or -1. A manifold of one point keeps it wherever it slides.
int findPoint( const btPersistentManifold& manifold, const NodeHit& hit, int hitCount, bool nodeIsFirst );

/// Calls the game's callback, which may change a new or renewed point as with any contact of Bullet's. It is shown the child or triangle of
/// the other object that is touched. `leaf`: NodeHit::other().
void notifyAdded( const btPersistentManifold& manifold, btManifoldPoint& point, int leaf );

} // namespace pliant
