// Intersections of cuts with links: a drawn cut follows these, not the cells' borders. Steinemann et al. 2008, section 7.

#include "fracture/cut_links.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// A position on a link, as the fraction of the distance from a to b, and the cut's normal there, both in the current state.
struct Crossing
{
	double fraction = 0.5;
	Vec3d normal = Vec3d::UnitX();
};

/// The ends lie on different sides: s_a / ( s_a - s_b ).
Crossing acrossPlane( const Vec3d& point, const Vec3d& normal, const Vec3d& a, const Vec3d& b )
{
	const double sideA = normal.dot( a - point ), sideB = normal.dot( b - point );
	return Crossing{ sideA != sideB ? sideA / ( sideA - sideB ) : 0.5, normal.normalized() };
}

Crossing crossingOf( const PlaneCut& cut, const Vec3d& a, const Vec3d& b )
{
	return acrossPlane( cut.point, cut.normal, a, b );
}

Crossing crossingOf( const SphereCut& cut, const Vec3d& a, const Vec3d& b )
{
	// | a + t ( b - a ) - c |^2 = r^2; where the link enters and leaves the sphere, its deepest point.
	const Vec3d direction = b - a, from = a - cut.centre;
	const double square = direction.squaredNorm(), half = from.dot( direction ), rest = from.squaredNorm() - cut.radius * cut.radius;
	const double root = std::sqrt( std::max( 0.0, half * half - square * rest ) );
	const bool isInA = rest < 0.0, isInB = ( b - cut.centre ).squaredNorm() < cut.radius * cut.radius;
	const double fraction = isInA == isInB ? -half / square : ( isInA ? -half + root : -half - root ) / square;
	const Vec3d out = from + fraction * direction;
	return Crossing{ fraction, out.isZero( 0.0 ) ? Vec3d( direction.normalized() ) : Vec3d( out.normalized() ) };
}

Crossing crossingOf( const BladeCut& cut, const Vec3d& a, const Vec3d& b )
{
	const Vec3d first = ( cut.p1 - cut.p0 ).cross( cut.q0 - cut.p0 ), second = ( cut.p1 - cut.q0 ).cross( cut.q1 - cut.q0 );
	const auto differs = [&]( const Vec3d& point, const Vec3d& normal ) {
		return ( normal.dot( a - point ) < 0.0 ) != ( normal.dot( b - point ) < 0.0 );
	};
	const bool isFirst = first.squaredNorm() > 0.0 && differs( cut.p0, first );
	const bool isSecond = second.squaredNorm() > 0.0 && differs( cut.q0, second );
	if ( isFirst && isSecond )
	{
		// Both planes separate the ends, but the link crosses one triangle: the one on its side of their common line.
		const Crossing one = acrossPlane( cut.p0, first, a, b );
		const Vec3d at = a + one.fraction * ( b - a ), edge = cut.q0 - cut.p1;
		const bool isOnSide = edge.cross( at - cut.p1 ).dot( edge.cross( cut.p0 - cut.p1 ) ) >= 0.0;
		return isOnSide ? one : acrossPlane( cut.q0, second, a, b );
	}
	return isSecond ? acrossPlane( cut.q0, second, a, b ) : acrossPlane( cut.p0, first, a, b );
}

template <class Cut>
std::vector<CutTrace> findTraces( const Lattice& lattice, const std::vector<Vec3d>& positions, const std::vector<CellLink>& links,
	const Cut& cut, const std::vector<Eigen::Quaternionf>& rotations )
{
	std::vector<CutTrace> traces;
	traces.reserve( links.size() );
	for ( const CellLink& link : links )
	{
		const Crossing at = crossingOf( cut, positions[link.a], positions[link.b] );
		const float fraction = float( std::clamp( at.fraction, 0.0, 1.0 ) );
		CutTrace trace;
		trace.link = link;
		trace.point = ( 1.0f - fraction ) * lattice.restCentre[link.a] + fraction * lattice.restCentre[link.b];
		trace.normal = rotations[fraction < 0.5f ? link.a : link.b].conjugate() * at.normal.cast<float>();
		if ( trace.normal.allFinite() && trace.point.allFinite() )
		{
			const float along = trace.normal.dot( lattice.restCentre[link.b] - lattice.restCentre[link.a] );
			trace.normal = along < 0.0f ? Vec3( -trace.normal ) : trace.normal;
			traces.push_back( trace );
		}
	}
	return traces;
}

} // namespace

std::vector<CutTrace> tracesOf( const Lattice& lattice, const std::vector<Vec3d>& positions, const std::vector<CellLink>& links,
	const PlaneCut& cut, const std::vector<Eigen::Quaternionf>& rotations )
{
	return findTraces( lattice, positions, links, cut, rotations );
}

std::vector<CutTrace> tracesOf( const Lattice& lattice, const std::vector<Vec3d>& positions, const std::vector<CellLink>& links,
	const SphereCut& cut, const std::vector<Eigen::Quaternionf>& rotations )
{
	return findTraces( lattice, positions, links, cut, rotations );
}

std::vector<CutTrace> tracesOf( const Lattice& lattice, const std::vector<Vec3d>& positions, const std::vector<CellLink>& links,
	const BladeCut& cut, const std::vector<Eigen::Quaternionf>& rotations )
{
	return findTraces( lattice, positions, links, cut, rotations );
}

} // namespace pliant
