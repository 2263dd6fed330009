#include "matching/raised_inverse.h"

#include "matching/constants.h"

#include <cmath>

namespace pliant {

namespace {

constexpr int kSize = 9;

/// Rotates the plane of axes p and q so that a( p, q ) becomes zero; `axes` accumulates the rotations.
void rotate( Moment9& a, Moment9& axes, int p, int q )
{
	if ( a( p, q ) == 0.0 )
	{
		return;
	}
	// t = tan of the angle: the smaller root of t^2 + 2 theta t - 1 = 0
	const double theta = ( a( q, q ) - a( p, p ) ) / ( 2.0 * a( p, q ) );
	const double t = ( theta < 0.0 ? -1.0 : 1.0 ) / ( std::abs( theta ) + std::sqrt( theta * theta + 1.0 ) );
	const double c = 1.0 / std::sqrt( t * t + 1.0 ), s = t * c;
	for ( int k = 0; k < kSize; ++k )
	{
		const double kp = a( k, p ), kq = a( k, q );
		a( k, p ) = c * kp - s * kq;
		a( k, q ) = s * kp + c * kq;
	}
	for ( int k = 0; k < kSize; ++k )
	{
		const double pk = a( p, k ), qk = a( q, k );
		a( p, k ) = c * pk - s * qk;
		a( q, k ) = s * pk + c * qk;
		const double ap = axes( k, p ), aq = axes( k, q );
		axes( k, p ) = c * ap - s * aq;
		axes( k, q ) = s * ap + c * aq;
	}
	a( p, q ) = a( q, p ) = 0.0;
}

/// True where the off-diagonal entries are too small to change the diagonal.
bool isDiagonal( const Moment9& a )
{
	const double largest = a.diagonal().cwiseAbs().maxCoeff();
	double offDiagonal = 0.0;
	for ( int p = 0; p < kSize; ++p )
	{
		for ( int q = p + 1; q < kSize; ++q )
		{
			offDiagonal += a( p, q ) * a( p, q );
		}
	}
	return largest + std::sqrt( offDiagonal ) == largest;
}

} // namespace

Moment9 raisedInverse( const Moment9& moment, double floorFraction )
{
	Moment9 a = moment, axes = Moment9::Identity();
	for ( int sweep = 0; sweep < kJacobiSweeps && !isDiagonal( a ); ++sweep )
	{
		for ( int p = 0; p < kSize; ++p )
		{
			for ( int q = p + 1; q < kSize; ++q )
			{
				rotate( a, axes, p, q );
			}
		}
	}
	const double largest = a.diagonal().maxCoeff();
	if ( !( largest > 0.0 ) )
	{
		return Moment9::Zero();
	}
	const Eigen::Matrix<double, kSize, 1> raised = a.diagonal().cwiseMax( floorFraction * largest );
	return axes * raised.cwiseInverse().asDiagonal() * axes.transpose();
}

} // namespace pliant
