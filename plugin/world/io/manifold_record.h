#pragma once

// Contacts as bytes: Bullet's manifolds, with the impulses that the solver starts from.

#include "archive/archive.h"
#include "world/step/step_impulses.h"

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <vector>

namespace pliant {

/// One manifold, without the objects that it belongs to.
struct ManifoldRecord
{
	/// The point's numbers, and its integers; user data are the game's.
	struct Point
	{
		static constexpr int kScalars = 35, kIntegers = 6;
		btScalar scalar[kScalars];
		int integer[kIntegers];
		void archive( Archive& archive );
	};
	int rank = 0; ///< in the dispatcher's list: the solver's order
	int count = 0;
	btScalar breakingThreshold = 0, processingThreshold = 0;
	Point point[MANIFOLD_CACHE_SIZE]; ///< the first `count` are set
	bool hasImpulses = false;         ///< of a step with substeps
	StepImpulses::Contact impulses{ nullptr, { nullptr, nullptr }, 0.0 };

	static ManifoldRecord of( const btPersistentManifold& manifold, int rank, StepImpulses& impulses );
	/// Writes it to a manifold of the same objects.
	void applyTo( btPersistentManifold& manifold, StepImpulses& to ) const;
	void archive( Archive& archive );
};

/// The manifolds of a world in the order that the solver takes them.
class ManifoldOrder
{
public:
	void add( int rank, btPersistentManifold& manifold ) { m_known.push_back( { rank, &manifold } ); }
	/// Gives them the places that they have together in the dispatcher's list, in the order of their ranks.
	void applyTo( btDispatcher& dispatcher );

private:
	struct Known
	{
		int rank;
		btPersistentManifold* manifold;
	};
	std::vector<Known> m_known;
};

} // namespace pliant
