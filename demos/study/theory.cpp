// +-----------------------------------------------------------------------------------------------------------------+
// | Theory without a closed form: a heavy beam, a rubber bar, Cook's membrane.                                       |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/theory.h"

#include <Eigen/LU>
#include <Eigen/SparseCholesky>

#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

namespace pliant_study {

namespace {

constexpr int kBeamSteps = 2000;
constexpr int kHalvings = 60;
constexpr int kCookElements = 64; // along an edge, of the finer mesh

/// Rotations of a beam from its clamp on, for a curvature k there: theta'' = -load ( 1 - s ) cos( theta ), downwards positive. Midpoint
/// rule.
struct BeamEnd
{
	double curvature = 0;
	Eigen::Vector2d at = Eigen::Vector2d::Zero(); ///< at arc length s
};

BeamEnd shoot( double load, double k, double s )
{
	const double h = 1.0 / kBeamSteps;
	double theta = 0;
	BeamEnd end;
	Eigen::Vector2d at = Eigen::Vector2d::Zero();
	for ( int n = 0; n < kBeamSteps; ++n )
	{
		const double from = n * h, thetaMid = theta + h / 2 * k;
		const double kMid = k - h / 2 * load * ( 1 - from ) * std::cos( theta );
		k -= h * load * ( 1 - from - h / 2 ) * std::cos( thetaMid );
		theta += h * kMid;
		const double part = std::min( 1.0, std::max( 0.0, ( s - from ) / h ) );
		at += part * h * Eigen::Vector2d( std::cos( thetaMid ), std::sin( thetaMid ) );
	}
	end.curvature = k;
	end.at = at;
	return end;
}

/// A corner of the membrane's mesh: 48 wide, 44 high at the left, 16 at the right, whose top is 16 higher.
Eigen::Vector2d cookPoint( double u, double v )
{
	return { 48 * u, 44 * v + u * ( 44 - 28 * v ) };
}

using Element = Eigen::Matrix<double, 8, 8>;

/// A bilinear element of plane stress, E = 1, by 2 x 2 Gauss points.
Element elementStiffness( const Eigen::Matrix<double, 4, 2>& corners, double nu )
{
	Eigen::Matrix3d law;
	law << 1, nu, 0, nu, 1, 0, 0, 0, ( 1 - nu ) / 2;
	law /= 1 - nu * nu;
	Element stiffness = Element::Zero();
	const double g = 1 / std::sqrt( 3.0 );
	for ( const auto& [a, b] : { std::array<double, 2>{ -g, -g }, { g, -g }, { g, g }, { -g, g } } )
	{
		Eigen::Matrix<double, 2, 4> slope;
		slope << -( 1 - b ), 1 - b, 1 + b, -( 1 + b ), -( 1 - a ), -( 1 + a ), 1 + a, 1 - a;
		slope /= 4;
		const Eigen::Matrix2d jacobian = slope * corners;
		const Eigen::Matrix<double, 2, 4> d = jacobian.inverse() * slope;
		Eigen::Matrix<double, 3, 8> strain = Eigen::Matrix<double, 3, 8>::Zero();
		for ( Eigen::Index k = 0; k < 4; ++k )
		{
			strain( 0, 2 * k ) = strain( 2, 2 * k + 1 ) = d( 0, k );
			strain( 1, 2 * k + 1 ) = strain( 2, 2 * k ) = d( 1, k );
		}
		stiffness += jacobian.determinant() * strain.transpose() * law * strain;
	}
	return stiffness;
}

/// The upward displacement of ( x, y ), on a mesh of n x n elements.
double cookOn( int n, double nu, double x, double y )
{
	const auto number = [n]( int i, int j ) { return i * ( n + 1 ) + j; };
	const int held = n + 1; // the left edge's nodes come first
	std::vector<Eigen::Triplet<double>> entries;
	for ( int i = 0; i < n; ++i )
	{
		for ( int j = 0; j < n; ++j )
		{
			const int node[] = { number( i, j ), number( i + 1, j ), number( i + 1, j + 1 ), number( i, j + 1 ) };
			Eigen::Matrix<double, 4, 2> corners;
			corners << cookPoint( double( i ) / n, double( j ) / n ).transpose(),
				cookPoint( double( i + 1 ) / n, double( j ) / n ).transpose(),
				cookPoint( double( i + 1 ) / n, double( j + 1 ) / n ).transpose(),
				cookPoint( double( i ) / n, double( j + 1 ) / n ).transpose();
			const Element stiffness = elementStiffness( corners, nu );
			for ( int a = 0; a < 8; ++a )
			{
				for ( int b = 0; b < 8; ++b )
				{
					const int row = 2 * ( node[a / 2] - held ) + a % 2, column = 2 * ( node[b / 2] - held ) + b % 2;
					if ( row >= 0 && column >= 0 )
					{
						entries.emplace_back( row, column, stiffness( a, b ) );
					}
				}
			}
		}
	}
	const int unknowns = 2 * n * ( n + 1 );
	Eigen::SparseMatrix<double> matrix( unknowns, unknowns );
	matrix.setFromTriplets( entries.begin(), entries.end() );
	Eigen::VectorXd load = Eigen::VectorXd::Zero( unknowns );
	for ( int j = 0; j <= n; ++j )
	{
		load[2 * ( number( n, j ) - held ) + 1] = ( j == 0 || j == n ? 0.5 : 1.0 ) / n;
	}
	const Eigen::VectorXd moved = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>( matrix ).solve( load );
	// Bilinear between the corners of the element that contains the point.
	const double u = x / 48 * n, v = ( y - 44 * x / 48 ) / ( 44 - 28 * x / 48 ) * n;
	const int i = std::min( n - 1, int( u ) ), j = std::min( n - 1, int( v ) );
	const double a = u - i, b = v - j;
	const auto up = [&]( int column, int row ) { return column == 0 ? 0.0 : moved[2 * ( number( column, row ) - held ) + 1]; };
	return ( 1 - a ) * ( ( 1 - b ) * up( i, j ) + b * up( i, j + 1 ) ) + a * ( ( 1 - b ) * up( i + 1, j ) + b * up( i + 1, j + 1 ) );
}

} // namespace

Eigen::Vector2d heavyElastica( double load, double s )
{
	// The curvature at the clamp for which none is left at the free end: the moment there is between 0 and the straight beam's, load / 2.
	double low = 0, high = load / 2;
	for ( int k = 0; k < kHalvings; ++k )
	{
		const double middle = ( low + high ) / 2;
		( shoot( load, middle, s ).curvature > 0 ? high : low ) = middle;
	}
	return shoot( load, low, s ).at;
}

double neoHookeanAcross( double stretch, double nu )
{
	const double lambda = 2 * nu / ( 1 - 2 * nu ); // over mu
	double low = 1e-3, high = 10;
	for ( int k = 0; k < kHalvings; ++k )
	{
		const double t = ( low + high ) / 2;
		( t * t - 1 + lambda * std::log( stretch * t * t ) > 0 ? high : low ) = t;
	}
	return low;
}

double cookDeflection( double nu, double x, double y )
{
	const double coarse = cookOn( kCookElements / 2, nu, x, y ), fine = cookOn( kCookElements, nu, x, y );
	return fine + ( fine - coarse ) / 3; // the error is proportional to the square of the elements' size
}

std::string shortNumber( double value )
{
	char text[32];
	std::snprintf( text, sizeof( text ), "%.4g", value );
	return text;
}

} // namespace pliant_study
