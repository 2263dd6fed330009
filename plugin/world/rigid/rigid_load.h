#pragma once

// The load on a body in its rigid state: by how much it may change before the body deforms again.

#include "lattice/lattice.h"

class btPersistentManifold;
class btVector3;

namespace pliant {

class Body;
class SoftBody;

/// Returns the sum of a manifold's normal impulses, N s.
double impulseOf( const btPersistentManifold& manifold );

/// Whether contacts, gravity, forces and force fields strain the body by more than `Body::largestInvisibleStrain`, or no longer bend it as
/// when it became rigid. `gravity`: the body's, m/s^2.
bool hasLoadChanged( const SoftBody& body, const btVector3& gravity );

/// Returns the acceleration by gravity, central force and force fields, m/s^2.
Vec3d accelerationOn( const SoftBody& body, const btVector3& gravity );

/// Whether no pin moves its node: pins without target, and pins to bodies that are at rest.
bool arePinsStill( const SoftBody& body );

/// Returns the velocity, m/s, at which an object of this mass may meet a body in its rigid state without straining it visibly. `mass`: kg,
/// SIMD_INFINITY for objects that the impact does not move. `passes`: impactsPass.
double largestApproach( const Body& body, double mass, bool passes );

/// Whether an impact on a free body in its rigid state is over within a step of `h`, s, and nothing of its deformation is left to see: it
/// breaks what it breaks without the body deforming (rigid_impacts.cpp). So does one on a body in which nothing deforms.
bool impactsPass( const SoftBody& body, double h );

} // namespace pliant
