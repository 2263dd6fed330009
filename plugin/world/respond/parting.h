#pragma once

// Two things that come into the world inside one another. Node by node each contact knows the way out that is nearest to that node, and
// between two bodies that stand one in the other these ways cancel: they never part. What cancels is kept by nobody but by springs, and
// what does not is shot out. So such a pair goes apart in one direction, the shortest way for both as wholes, and no faster than
// kPartingSpeed; until then all of its contacts press along that.

#include "lattice/lattice.h"

#include <vector>

class btCollisionObject;

namespace pliant {

class SoftBody;
struct NodeHit;

class Parting
{
public:
	/// What a pair's search has found in this step of `step` s; `other` is soft where `otherSoft` is not null. Where the pair has just met
	/// (`isNew`), or one of the two has been put where it is, and they are too deep in one another for how they move, it begins; it ends
	/// when they are apart.
	void follow( const SoftBody& soft, const btCollisionObject& other, const SoftBody* otherSoft, bool isNew, double step,
		std::vector<NodeHit>& hits );

private:
	bool m_isParting = false;
	unsigned m_placed = 0;             ///< both bodies' counts of placements, when they were last looked at
	Vec3d m_direction = Vec3d::Zero(); ///< that the first goes in
};

} // namespace pliant
