#pragma once

// Contacts as bytes: Bullet's manifolds, with the impulses that the solver starts from.

#include "archive/archive.h"
#include "world/step/step_impulses.h"

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pliant {

/// One manifold in a snapshot, without its objects: it is written from Bullet's object and read in place.
class ManifoldRecord
{
public:
	/// `impulses`: of a step with substeps; null where there are none.
	static void write( Archive& archive, const btPersistentManifold& manifold, int rank, const StepImpulses::Contact* impulses );
	void archive( Archive& archive );
	/// Writes it to a manifold of the same objects.
	void applyTo( btPersistentManifold& manifold, StepImpulses& to ) const;
	/// Its index in the dispatcher's list: the solver's order.
	int rank() const { return m_head.rank; }

private:
	struct Head
	{
		std::int32_t rank = 0;
		std::int16_t count = 0, impulses = 0; ///< points, and points with impulses of a substep
		double sum = 0.0;                     ///< StepImpulses::Contact's
		btScalar breakingThreshold = 0, processingThreshold = 0;
	};
	static_assert( sizeof( Head ) == 16 + 2 * sizeof( btScalar ) );

	Head m_head;
	const std::byte *m_points = nullptr, *m_impulses = nullptr; ///< in the bytes that are read
};

/// The manifolds of a world in the order that the solver takes them.
class ManifoldOrder
{
public:
	void add( int rank, btPersistentManifold& manifold ) { m_known.push_back( { rank, &manifold } ); }
	/// Redistributes the indices that they have together in the dispatcher's list, in the order of their ranks.
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
