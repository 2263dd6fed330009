#include "adapt/moments/energy_match.h"

#include "adapt/constants.h"
#include "adapt/moments/quadratics.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// sum E_k: variance of the six quadratics about a position offset by `t` from the monomials' origin, over the finest regions. With the row
/// of the shifted quadratic, e_q + t_a e_b + t_b e_a, each is
///   C_qq + 2 ( t_a C_qb + t_b C_qa ) + t_a^2 C_bb + 2 t_a t_b C_ab + t_b^2 C_aa.
double quadraticVariance( const std::array<float, 45>& packed, const Vec3d& t )
{
	const auto c = [&packed]( int row, int column ) { return double( packed[std::size_t( row * ( row + 1 ) / 2 + column )] ); };
	double sum = 0.0;
	for ( int k = 0; k < 6; ++k )
	{
		const int q = 3 + k, a = kQuadraticFirst[k], b = kQuadraticSecond[k]; // a <= b < q
		sum += c( q, q ) + 2.0 * ( t[a] * c( q, b ) + t[b] * c( q, a ) ) + t[a] * t[a] * c( b, b ) + 2.0 * t[a] * t[b] * c( b, a ) +
			t[b] * t[b] * c( a, a );
	}
	return sum;
}

bool isSolid( const Eigen::Matrix3d& moment )
{
	const double third = moment.trace() / 3.0;
	return moment.determinant() > kSolidFraction * third * third * third;
}

/// Sylvester's criterion: every leading minor of a symmetric matrix is positive.
bool isPositive( const Eigen::Matrix3d& m )
{
	return m( 0, 0 ) > 0.0 && m( 0, 0 ) * m( 1, 1 ) - m( 0, 1 ) * m( 0, 1 ) > 0.0 && m.determinant() > 0.0;
}

/// Most regions are solid and need no eigenvalues.
void invertMoment( RegionRest& rest )
{
	if ( isSolid( rest.moment ) )
	{
		rest.inverse = rest.moment.inverse();
		return;
	}
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver( rest.moment );
	const double floor = kMomentFraction * solver.eigenvalues()[2];
	for ( int i = 0; i < 3; ++i )
	{
		const Vec3d axis = solver.eigenvectors().col( i );
		if ( solver.eigenvalues()[i] > floor )
		{
			rest.inverse += axis * axis.transpose() / solver.eigenvalues()[i];
			continue;
		}
		rest.outside += axis * axis.transpose();
		rest.isFlat = true;
	}
}

} // namespace

Eigen::Matrix3d fineMoment( const FineMoments& fine, std::uint32_t node )
{
	const std::array<float, 45>& c = fine.covariance[node];
	Eigen::Matrix3d j;
	j << c[0], c[1], c[3], c[1], c[2], c[4], c[3], c[4], c[5];
	return j;
}

RegionRest measureRegion( const Octree& octree, const Cut& cut, const RegionMatrix& matrix, std::uint32_t region, float cellSize )
{
	// c0_r = sum u x0 / M_r,  J_r = sum u ( x0 - c0_r ) ( x0 - c0_r )^T
	RegionRest rest;
	Vec3d first = Vec3d::Zero();
	for ( std::uint32_t k = matrix.start[region]; k < matrix.start[region + 1]; ++k )
	{
		const double u = matrix.mass[k] * matrix.unit[matrix.member[k]];
		rest.mass += u;
		first += u * octree.restCentre[cut.node[matrix.member[k]]].cast<double>();
	}
	const Vec3d centre = first / rest.mass;                 // m
	Vec3d diagonal = Vec3d::Zero(), beside = Vec3d::Zero(); // of the symmetric J: xx, yy, zz and yz, xz, xy
	for ( std::uint32_t k = matrix.start[region]; k < matrix.start[region + 1]; ++k )
	{
		const Vec3d q = ( octree.restCentre[cut.node[matrix.member[k]]].cast<double>() - centre ) / double( cellSize );
		const Vec3d uq = matrix.mass[k] * matrix.unit[matrix.member[k]] * q;
		diagonal += uq.cwiseProduct( q );
		beside += Vec3d( uq[1] * q[2], uq[0] * q[2], uq[0] * q[1] );
	}
	rest.moment << diagonal[0], beside[2], beside[1], beside[2], diagonal[1], beside[0], beside[1], beside[0], diagonal[2];
	rest.centre = centre / double( cellSize );
	invertMoment( rest );
	return rest;
}

double ohtaBeta( double mass, int halfWidth, int dimensions )
{
	const double w2 = 2.0 * halfWidth;
	return std::clamp( 1.0 - std::pow( ( w2 + 1.0 ) / ( w2 + std::pow( mass, 1.0 / dimensions ) ), dimensions ), 0.0, kLargestSoftness );
}

double energyBeta( const Eigen::Matrix3d& fineMoment, const Eigen::Matrix3d& moment )
{
	const double whole = moment.trace();
	return whole > 0.0 ? std::clamp( 1.0 - fineMoment.trace() / whole, 0.0, kLargestSoftness ) : 0.0;
}

Eigen::Matrix3d energyBlend( const Eigen::Matrix3d& fineMoment, const Eigen::Matrix3d& moment )
{
	// Where no direction reaches a limit, C is the product itself.
	if ( isSolid( moment ) && isPositive( moment - fineMoment ) && isPositive( fineMoment - ( 1.0 - kLargestSoftness ) * moment ) )
	{
		return moment.inverse() * fineMoment;
	}
	return energyBlendByDirections( fineMoment, moment );
}

Eigen::Matrix3d energyBlendByDirections( const Eigen::Matrix3d& fineMoment, const Eigen::Matrix3d& moment )
{
	// In coordinates where J_r is the identity, J_fine is symmetric: its eigenvalues are the fractions 1 - beta, one per direction.
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver( moment );
	const double largest = solver.eigenvalues()[2];
	if ( !( largest > 0.0 ) )
	{
		return Eigen::Matrix3d::Identity();
	}
	const Eigen::Matrix3d& v = solver.eigenvectors();
	Eigen::Matrix3d fine = v.transpose() * fineMoment * v; // along the axes of J_r
	Vec3d root = Vec3d::Zero();
	for ( int i = 0; i < 3; ++i )
	{
		const double value = solver.eigenvalues()[i];
		root[i] = 1.0;
		if ( value > kMomentFraction * largest )
		{
			root[i] = std::sqrt( value );
			continue;
		}
		// A flat region's nodes carry no information normal to its plane: the cells' motion there must not affect its plane.
		fine.row( i ).setZero();
		fine.col( i ).setZero();
		fine( i, i ) = 1.0;
	}
	const Vec3d inverseRoot = root.cwiseInverse();
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> fractions(
		Eigen::Matrix3d( inverseRoot.asDiagonal() * fine * inverseRoot.asDiagonal() ) );
	const Vec3d limited = fractions.eigenvalues().cwiseMax( 1.0 - kLargestSoftness ).cwiseMin( 1.0 );
	const Eigen::Matrix3d fraction = fractions.eigenvectors() * limited.asDiagonal() * fractions.eigenvectors().transpose();
	// J^-1/2 ( J^-1/2 J_fine J^-1/2 ) J^1/2 = J^-1 J_fine
	return v * inverseRoot.asDiagonal() * fraction * root.asDiagonal() * v.transpose();
}

double quadraticEta( const Octree& octree, const Cut& cut, const RegionMatrix& matrix, std::uint32_t region, const FineMoments& fine,
	const RegionRest& rest, float cellSize, double beta )
{
	const std::uint32_t node = cut.node[region];
	const Vec3d t = octree.restCentre[node].cast<double>() / double( cellSize ) - rest.centre;
	const double wanted = quadraticVariance( fine.covariance[node], t );

	// The same quadratics, averaged over each node's cells, as the region samples them: variance = affine part a_k + residual rho_k. A
	// fourth coordinate of 1 sums the means together with the slopes, in whole vector registers.
	Eigen::Matrix<double, 4, 6> sums = Eigen::Matrix<double, 4, 6>::Zero();
	double square = 0.0;
	for ( std::uint32_t m = matrix.start[region]; m < matrix.start[region + 1]; ++m )
	{
		const std::uint32_t a = cut.node[matrix.member[m]];
		const double u = matrix.mass[m] * matrix.unit[matrix.member[m]];
		const Vec3d q = octree.restCentre[a].cast<double>() / double( cellSize ) - rest.centre;
		const Eigen::Vector4d homogeneous( q[0], q[1], q[2], 1.0 );
		for ( int k = 0; k < 6; ++k )
		{
			const double phi = q[kQuadraticFirst[k]] * q[kQuadraticSecond[k]] + octree.spread[a][k];
			sums.col( k ) += u * phi * homogeneous;
			square += u * phi * phi;
		}
	}
	const Eigen::Matrix<double, 3, 6> slope = sums.topRows<3>();
	const double variance = square - sums.row( 3 ).squaredNorm() / rest.mass;
	const double affine = slope.cwiseProduct( rest.inverse * slope ).sum();
	const double residual = variance - affine;
	if ( !( residual > kMomentFraction * variance ) )
	{
		return beta;
	}
	return std::clamp( 1.0 - ( wanted - ( 1.0 - beta ) * affine ) / residual, 0.0, kLargestSoftness );
}

} // namespace pliant
