#pragma once

// The load on a body in its rigid state: by how much it may change before the body deforms again.

#include "lattice/lattice.h"

class btPersistentManifold;
class btVector3;

namespace pliant {

class Body;
class SoftBody;

/// The sum of a manifold's normal impulses, N s.
double impulseOf( const btPersistentManifold& manifold );

/// Whether contacts, gravity, forces or force fields strain the body by more than `Body::largestInvisibleStrain`, or no longer bend it as
/// they did when it became rigid. `gravity`: the body's, m/s^2.
bool hasOtherLoad( const SoftBody& body, const btVector3& gravity );

/// The mean of gravity, central force and force fields, m/s^2.
Vec3d pullOn( const SoftBody& body, const btVector3& gravity );

/// Whether no pin moves its node: it has no target, or follows what does not move.
bool arePinsStill( const SoftBody& body );

/// The velocity, m/s, at which an object of this mass may meet a body in its rigid state without straining it visibly. `mass`: kg,
/// SIMD_INFINITY for what is not moved by the impact.
double largestApproach( const Body& body, double mass );

} // namespace pliant
