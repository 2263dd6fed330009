// Two layers of spheres interlock like two egg boxes: a face displaced by a fifth of a diameter rests on a slope of 0.2 and slides into the
// other's hollows, for seconds. Spheres of twice the radius touch the same faces at half the slope. Their centres lie midway to the nodes
// behind, so that two nodes on each side share the impulse along the line between centres, and momentum and angular momentum are conserved.

#include "world/touch/round_surface.h"

#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"

#include <algorithm>
#include <cmath>

namespace pliant {

bool useRoundSpheres( const SoftBody& a, const SoftBody& b )
{
	const auto isRound = []( const SoftBody& body ) {
		const SoftBody::Impl& impl = body.impl();
		// Fragments have faces that fit into each other cell by cell.
		return !body.isStaticOrKinematicObject() && impl.isWhole() && !impl.isMetAsDrawn();
	};
	return &a != &b && isRound( a ) && isRound( b );
}

RoundSphere roundSphere( const SoftBody& body, int node, const Vec3d& towards )
{
	const std::array<std::int32_t, 6>& beside = body.impl().surfaceNow().neighbours()[std::size_t( node )];
	const NodeState& nodes = body.impl().body->nodes();
	RoundSphere round;
	// The open face nearest to that direction. Without one the sphere is the node's own; the transition between the two is gradual.
	double most = kLeastRoundCosine;
	const Vec3d at = nodes.x.get( node ).cast<double>();
	const double distance2 = towards.squaredNorm();
	for ( std::size_t side = 0; side < beside.size(); ++side )
	{
		const int inner = beside[side];
		if ( inner < 0 || beside[side ^ 1] >= 0 )
		{
			continue; // no node behind, or no open face in front
		}
		const Vec3d inwards = nodes.x.get( inner ).cast<double>() - at;
		const double along = -inwards.dot( towards ), both2 = inwards.squaredNorm() * distance2;
		if ( !( along > 0.0 && along * along > most * most * both2 ) || nodes.freedom[inner] == 0.0f )
		{
			continue;
		}
		most = along / std::sqrt( both2 );
		round.inner = inner;
		round.fraction = kRoundFraction * std::min( 1.0, ( most - kLeastRoundCosine ) / ( kFullRoundCosine - kLeastRoundCosine ) );
		round.inwards = round.fraction * inwards;
	}
	return round;
}

} // namespace pliant
