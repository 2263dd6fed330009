#include "matching/step/far_region.h"

#include "matching/constants.h"
#include "matching/regions/region_moments.h"
#include "matching/stiffness.h"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace pliant {

void FarMoments::add( const FarMoments& other, double fraction )
{
	mass += fraction * other.mass;
	first += fraction * other.first;
	second += fraction * other.second;
}

// Two properties are matched to those of a solid of modulus E_l = alpha_l rho d^2 mu / h^2, mu = M_r's full second moment:
// - uniform stretch: b J = mu M along the region's longest axis. Pinned cells have a larger weight, so that b < 1 there: a region supported
// at its end is stiffer than a free one. b is at most 1, which keeps every level a contraction.
// - bending: u = ( x_a x_b, - x_a^2 / 2 ) strains by x_b along a, which costs mu J_bb; its non-affine part is J_aa J_bb + J_aa^2 / 5 per
// mass. 1 - eta is the ratio. Without it a bar thinner than a block would bend as stiffly as one of the block's thickness.
FarRegion weighFarRegion( const FarMoments& weighted, const FarMoments& plain, int level )
{
	FarRegion region;
	region.mass = weighted.mass;
	region.centre = weighted.first / weighted.mass;
	region.moment = weighted.aboutCentre();
	const double mu = farSecondMoment( level );
	const double longest = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>( region.moment ).eigenvalues()[2];
	region.pull = longest > mu * plain.mass ? mu * plain.mass / longest : 1.0;

	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver( Eigen::Matrix3d( plain.aboutCentre() / plain.mass ) );
	double remaining = 1.0;
	for ( int a = 0; a < 3; ++a )
	{
		for ( int b = 0; b < 3; ++b )
		{
			const double along = std::max( solver.eigenvalues()[a], 0.0 ), across = std::max( solver.eigenvalues()[b], 0.0 );
			const double curved = region.pull * ( along * across + kCurveFraction * along * along ),
						 strained = mu * ( across + kSolidCellMoment );
			if ( a != b && strained < remaining * curved )
			{
				remaining = strained / curved;
			}
		}
	}
	region.eta = 1.0 - remaining;
	return region;
}

namespace {

/// For the bending u = ( x_a x_b, - x_a^2 / 2 ) about the region's own centre, sums over its cells weighted for pins: the part of the best
/// affine motion beyond the best rotation, and the non-affine part.
struct Bending
{
	double affine = 0.0, residual = 0.0;
};

Bending bendRegion( const RegionCells& cells, const FarRegion& region, const Vec3d& centre, const Vec3d& a, const Vec3d& b )
{
	Vec3d sum = Vec3d::Zero();
	double square = 0.0;
	Eigen::Matrix3d mixed = Eigen::Matrix3d::Zero();
	for ( std::size_t i = 0; i < cells.position.size(); ++i )
	{
		const Vec3d p = cells.position[i] - centre;
		const Vec3d u = p.dot( a ) * p.dot( b ) * a - 0.5 * p.dot( a ) * p.dot( a ) * b;
		sum += cells.weight[i] * u;
		square += cells.weight[i] * u.squaredNorm();
		mixed += cells.weight[i] * u * ( cells.position[i] - region.centre ).transpose();
	}
	Eigen::Matrix3d outside;
	const Eigen::Matrix3d gradient = mixed * inverseInPlane( region.moment, kMomentFloor, outside );
	const double affine = ( gradient * region.moment * gradient.transpose() ).trace();
	// The rotation nearest to G q: ( tr J - J ) omega = sum of w q x G q, and | G q - omega x q |^2 = | G q |^2 - omega . ( that sum ).
	const Eigen::Matrix3d moved = gradient * region.moment;
	const Vec3d torque( moved( 2, 1 ) - moved( 1, 2 ), moved( 0, 2 ) - moved( 2, 0 ), moved( 1, 0 ) - moved( 0, 1 ) );
	const Eigen::Matrix3d inertia = region.moment.trace() * Eigen::Matrix3d::Identity() - region.moment;
	const Vec3d turn = flooredInverse( inertia, kMomentFloor ) * torque;
	return { std::max( affine - turn.dot( torque ), 0.0 ), std::max( square - sum.squaredNorm() / region.mass - affine, 0.0 ) };
}

} // namespace

double etaOfPinned( const RegionCells& cells, const FarRegion& region, const FarMoments& plain, double mu )
{
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver( plain.aboutCentre() );
	const Vec3d centre = plain.first / plain.mass;
	double remaining = 1.0;
	for ( int a = 0; a < 3; ++a )
	{
		for ( int b = 0; b < 3; ++b )
		{
			const double strained = mu * ( std::max( solver.eigenvalues()[b], 0.0 ) + kSolidCellMoment * plain.mass );
			const Bending bending = a == b
				? Bending{}
				: bendRegion( cells, region, centre, solver.eigenvectors().col( a ), solver.eigenvectors().col( b ) );
			if ( region.pull * ( bending.affine + remaining * bending.residual ) > strained )
			{
				remaining = std::clamp( ( strained / region.pull - bending.affine ) / bending.residual, 0.0, 1.0 );
			}
		}
	}
	return 1.0 - remaining;
}

} // namespace pliant
