// Two layers of spheres are two egg boxes: what lies a fifth of a diameter aside stands on a slope of 0.2, and slides into the other's hollows, for seconds. Spheres of twice
// the radius touch the same faces with half the slope. Their centres lie half-way to the nodes behind, so what acts along the line between
// two centres is taken up by two nodes each, and neither momentum nor spin is lost, as with the nodes' own.

#include "world/round_surface.h"

#include "world/constants.h"
#include "world/soft_body_impl.h"

#include <algorithm>

namespace pliant {

bool meetRound( const SoftBody& a, const SoftBody& b )
{
	const auto isRound = []( const SoftBody& body ) {
		const SoftBody::Impl& impl = body.impl();
		// What came apart has faces that fit into each other cell by cell.
		return impl.isImplicit && !impl.body->levels() && !impl.family && impl.fractureVersion == 0;
	};
	return &a != &b && isRound( a ) && isRound( b );
}

RoundSphere roundSphere( const SoftBody& body, int node, const Vec3d& towards )
{
	const Lattice& lattice = body.impl().body->lattice();
	const NodeState& nodes = body.impl().body->nodes();
	int behind[6] = { -1, -1, -1, -1, -1, -1 }; // by axis, low and high
	for ( std::uint32_t l = lattice.linkStart[std::size_t( node )]; l < lattice.linkStart[std::size_t( node ) + 1]; ++l )
	{
		const std::uint32_t other = lattice.linkTo[l];
		const Eigen::Vector3i step = ( lattice.coordinate[other] - lattice.coordinate[std::size_t( node )] ).cast<int>();
		if ( step.squaredNorm() == 1 )
		{
			const int axis = step.x() != 0 ? 0 : step.y() != 0 ? 1 : 2;
			behind[2 * axis + ( step[axis] > 0 ? 1 : 0 )] = int( other );
		}
	}
	// The open face that looks there most. Where none does, the sphere is the node's own, and between it becomes so by and by.
	RoundSphere round;
	double most = kLeastLook;
	const Vec3d at = nodes.x.get( node ).cast<double>(), way = towards.normalized();
	for ( int side = 0; side < 6; ++side )
	{
		const int inner = behind[side];
		if ( inner < 0 || behind[side ^ 1] >= 0 || nodes.freedom[inner] == 0.0f )
		{
			continue;
		}
		const Vec3d inwards = nodes.x.get( inner ).cast<double>() - at;
		const double looks = -inwards.normalized().dot( way );
		if ( looks > most )
		{
			most = looks;
			round.inner = inner;
			round.share = kRoundShare * std::min( 1.0, ( looks - kLeastLook ) / ( kFullLook - kLeastLook ) );
			round.inwards = round.share * inwards;
		}
	}
	return round;
}

} // namespace pliant
