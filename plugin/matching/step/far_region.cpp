#include "matching/step/far_region.h"

#include "matching/regions/region_moments.h"
#include "matching/stiffness.h"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace pliant {

namespace {

/// Second moment of one cell as a solid, cells^2: what a plate of one cell has across.
constexpr double kSolidCell = 1.0 / 12.0;

/// Of the square of the second moment of a stretch of material, what x^2 / 2 is off any straight line: L^4 / 720 of ( L^2 / 12 )^2.
constexpr double kCurveFraction = 0.2;

} // namespace

void FarMoments::add( const FarMoments& other, double fraction )
{
	mass += fraction * other.mass;
	first += fraction * other.first;
	second += fraction * other.second;
}

// Two things are matched, both to what a solid of modulus E_l = alpha_l rho d^2 mu / h^2 has, mu = M_r's full second moment:
// - an even stretch: b J = mu M along the region's longest axis. Pinned cells count heavy, so that b < 1 there: a region held at its end is
//   stiffer than a free one. b is never above 1, which keeps every level a contraction.
// - bending: u = ( x_a x_b, - x_a^2 / 2 ) strains by x_b along a, which holds mu J_bb; what no affine motion explains of it is
//   J_aa J_bb + J_aa^2 / 5 per mass. 1 - eta is the ratio. Without it a bar thinner than a block would bend as stiffly as one as thick.
FarRegion weighFarRegion( const FarMoments& heavy, const FarMoments& plain, int level )
{
	FarRegion region;
	region.mass = heavy.mass;
	region.centre = heavy.first / heavy.mass;
	region.moment = heavy.aboutCentre();
	const double mu = farSecondMoment( level );
	const double longest = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>( region.moment ).eigenvalues()[2];
	region.pull = longest > mu * plain.mass ? mu * plain.mass / longest : 1.0;

	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver( Eigen::Matrix3d( plain.aboutCentre() / plain.mass ) );
	double keep = 1.0;
	for ( int a = 0; a < 3; ++a )
	{
		for ( int b = 0; b < 3; ++b )
		{
			const double along = std::max( solver.eigenvalues()[a], 0.0 ), across = std::max( solver.eigenvalues()[b], 0.0 );
			const double curved = region.pull * ( along * across + kCurveFraction * along * along ),
						 strained = mu * ( across + kSolidCell );
			if ( a != b && strained < keep * curved )
			{
				keep = strained / curved;
			}
		}
	}
	region.eta = 1.0 - keep;
	return region;
}

namespace {

/// Of the bending u = ( x_a x_b, - x_a^2 / 2 ) about the region's own centre, sums over its cells with pinned ones heavy: what the best
/// affine motion makes of it beside the best turn, and what no affine motion explains.
struct Bending
{
	double affine = 0.0, residual = 0.0;
};

Bending bendRegion( const RegionCells& cells, const FarRegion& region, const Vec3d& centre, const Vec3d& a, const Vec3d& b )
{
	Vec3d sum = Vec3d::Zero();
	double square = 0.0;
	Eigen::Matrix3d mixed = Eigen::Matrix3d::Zero();
	for ( std::size_t i = 0; i < cells.place.size(); ++i )
	{
		const Vec3d p = cells.place[i] - centre;
		const Vec3d u = p.dot( a ) * p.dot( b ) * a - 0.5 * p.dot( a ) * p.dot( a ) * b;
		sum += cells.weight[i] * u;
		square += cells.weight[i] * u.squaredNorm();
		mixed += cells.weight[i] * u * ( cells.place[i] - region.centre ).transpose();
	}
	Eigen::Matrix3d outside;
	const Eigen::Matrix3d gradient = mixed * inverseInPlane( region.moment, kMomentFloor, outside );
	const double affine = ( gradient * region.moment * gradient.transpose() ).trace();
	// The turn nearest to G q: ( tr J - J ) omega = sum of w q x G q, and | G q - omega x q |^2 = | G q |^2 - omega . ( that sum ).
	const Eigen::Matrix3d moved = gradient * region.moment;
	const Vec3d torque( moved( 2, 1 ) - moved( 1, 2 ), moved( 0, 2 ) - moved( 2, 0 ), moved( 1, 0 ) - moved( 0, 1 ) );
	const Eigen::Matrix3d inertia = region.moment.trace() * Eigen::Matrix3d::Identity() - region.moment;
	const Vec3d turn = flooredInverse( inertia, kMomentFloor ) * torque;
	return { std::max( affine - turn.dot( torque ), 0.0 ), std::max( square - sum.squaredNorm() / region.mass - affine, 0.0 ) };
}

} // namespace

double etaOfHeld( const RegionCells& cells, const FarRegion& region, const FarMoments& plain, double mu )
{
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver( plain.aboutCentre() );
	const Vec3d centre = plain.first / plain.mass;
	double keep = 1.0;
	for ( int a = 0; a < 3; ++a )
	{
		for ( int b = 0; b < 3; ++b )
		{
			const double strained = mu * ( std::max( solver.eigenvalues()[b], 0.0 ) + kSolidCell * plain.mass );
			const Bending bending = a == b
				? Bending{}
				: bendRegion( cells, region, centre, solver.eigenvectors().col( a ), solver.eigenvectors().col( b ) );
			if ( region.pull * ( bending.affine + keep * bending.residual ) > strained )
			{
				keep = std::clamp( ( strained / region.pull - bending.affine ) / bending.residual, 0.0, 1.0 );
			}
		}
	}
	return 1.0 - keep;
}

} // namespace pliant
