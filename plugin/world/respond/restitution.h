#pragma once

// Restitution that adds no energy: corrects the velocity that nodes bounce from, and an island's work. docs/design/contacts.md.

#include "lattice/lattice.h"

#include <LinearMath/btScalar.h>

#include <vector>

class btDispatcher;
class btManifoldPoint;
class btPersistentManifold;
class btRigidBody;
struct btContactSolverInfo;

namespace pliant {

/// Contacts of explicit soft bodies in one call of Bullet's solver.
class RestitutionCorrection
{
public:
	/// Called before it: nodes bounce from their velocities before the substep's matching and forces.
	void aim( btDispatcher& dispatcher, const btContactSolverInfo& info );
	/// Called after it: where the contacts of an island added energy, scales their impulses down until they do not.
	void settle();

private:
	struct Bounce
	{
		btPersistentManifold* manifold;
		int point;
		int island;   ///< Bullet's island tag
		bool bounces; ///< approaches fast enough to bounce
		Vec3d before; ///< velocity of the first body relative to the second before matching and forces, m/s
	};
	using Range = std::pair<std::size_t, std::size_t>;

	static void aimAt( Bounce& bounce, const btContactSolverInfo& info );
	void settle( const Range& island );
	/// Sum of P . u, twice the work.
	double doubledWork( const Range& island, bool isBefore ) const;
	void applyImpulses( const Range& island, double fraction );

	std::vector<Bounce> m_bounces;
};

} // namespace pliant
