#pragma once

// Restitution that brings no energy in: what nodes bounce off, and a last look at what all contacts of an island did together.
// docs/design/contacts.md.

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
	/// Before it: nodes bounce off the speeds they had before the substep's matching and forces.
	void aim( btDispatcher& dispatcher, const btContactSolverInfo& info );
	/// After it: where the contacts of an island brought energy in, their impulses are made smaller until they do not.
	void settle();

private:
	struct Bounce
	{
		btPersistentManifold* manifold;
		int point;
		int island;   ///< Bullet's tag
		bool bounces; ///< off something that it meets fast enough
		Vec3d before; ///< speed of the first body against the second, m/s
	};
	using Range = std::pair<std::size_t, std::size_t>;

	static void aimAt( Bounce& bounce, const btContactSolverInfo& info );
	void settle( const Range& island );
	/// Sum of P . u, twice a work.
	double pressed( const Range& island, bool isBefore ) const;
	void push( const Range& island, double fraction );

	std::vector<Bounce> m_bounces;
};

} // namespace pliant
