#pragma once

// What impacts break of bodies in their rigid state, without these deforming.

class btPersistentManifold;

namespace pliant {

class SoftBody;

/// A contact of a brittle body in its rigid state before Bullet's solver.
struct RigidApproach
{
	SoftBody* body;
	const btPersistentManifold* manifold;
	int number;      ///< in the order of the manifolds
	int point;       ///< its number in the manifold
	bool isFirst;    ///< the body is the manifold's first
	double velocity; ///< with which the sides approach, without the forces of the substep, m/s
};

/// Whether an impact of this energy, J, could break a body if a single cell took all of it.
bool couldBreak( const SoftBody& body, double energy );

} // namespace pliant
