#pragma once

// Separation of two objects that were placed inside one another. Each contact's nearest exit is that of its own node; between two
// overlapping bodies these directions cancel, and the bodies never separate: only their springs hold the cancelling part, and the rest
// ejects them. Such a pair therefore separates in one direction, the shortest exit for both as a whole, at most at kPartingSpeed; until
// then all of its contacts press along that direction.

#include "lattice/lattice.h"

#include <vector>

class btCollisionObject;

namespace pliant {

class Archive;
class SoftBody;
struct NodeHit;

class Parting
{
public:
	/// Updates the state from the hits of a step of `step` s; `other` is soft where `otherSoft` is not null. Separation begins where the
	/// pair is new (`isNew`) or one of the two has been placed, and they overlap deeper than their motion explains; it ends when they are
	/// apart.
	void follow( const SoftBody& soft, const btCollisionObject& other, const SoftBody* otherSoft, bool isNew, double step,
		std::vector<NodeHit>& hits );
	/// Writes or reads the state.
	void archive( Archive& archive );

private:
	bool m_isParting = false;
	unsigned m_placementCount = 0;     ///< sum of both bodies' placement counts at the last call
	Vec3d m_direction = Vec3d::Zero(); ///< of the first body's separation
};

} // namespace pliant
