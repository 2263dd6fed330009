#include "matching/rotation.h"

#include "matching/constants.h"

#include <Eigen/Eigenvalues>

#include <cmath>

namespace pliant {

namespace {

// tr( R( q )^T a ) = q^T K q for a unit quaternion q = ( w, x, y, z ) (Horn 1987).
Eigen::Matrix4d hornMatrix( const Eigen::Matrix3d& a )
{
	Eigen::Matrix4d k;
	k( 0, 0 ) = a( 0, 0 ) + a( 1, 1 ) + a( 2, 2 );
	k( 1, 1 ) = a( 0, 0 ) - a( 1, 1 ) - a( 2, 2 );
	k( 2, 2 ) = -a( 0, 0 ) + a( 1, 1 ) - a( 2, 2 );
	k( 3, 3 ) = -a( 0, 0 ) - a( 1, 1 ) + a( 2, 2 );
	k( 0, 1 ) = k( 1, 0 ) = a( 2, 1 ) - a( 1, 2 );
	k( 0, 2 ) = k( 2, 0 ) = a( 0, 2 ) - a( 2, 0 );
	k( 0, 3 ) = k( 3, 0 ) = a( 1, 0 ) - a( 0, 1 );
	k( 1, 2 ) = k( 2, 1 ) = a( 0, 1 ) + a( 1, 0 );
	k( 1, 3 ) = k( 3, 1 ) = a( 0, 2 ) + a( 2, 0 );
	k( 2, 3 ) = k( 3, 2 ) = a( 1, 2 ) + a( 2, 1 );
	return k;
}

} // namespace

Eigen::Quaterniond fitRotation( const Eigen::Matrix3d& a, const Eigen::Quaterniond& previous )
{
	const double largest = a.cwiseAbs().maxCoeff();
	if ( !( largest > 0.0 ) || !std::isfinite( largest ) || !a.allFinite() )
	{
		return previous;
	}

	// The optimum is the eigenvector of K's largest eigenvalue. Newton on the quartic is faster, but this path handles the hard cases.
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver( hornMatrix( a / largest ) );
	const Eigen::Vector4d& lambda = solver.eigenvalues(); // ascending
	const Eigen::Vector4d before( previous.w(), previous.x(), previous.y(), previous.z() );

	// A gap of zero below the largest eigenvalue means that a whole subspace of quaternions is equally good: use the projection of the
	// previous rotation on it, so that a rod or a mirrored body does not flip from step to step.
	Eigen::Vector4d projection = Eigen::Vector4d::Zero();
	for ( int i = 0; i < 4; ++i )
	{
		if ( lambda[3] - lambda[i] <= kOpenRotationGap )
		{
			projection += solver.eigenvectors().col( i ) * solver.eigenvectors().col( i ).dot( before );
		}
	}
	Eigen::Vector4d q = solver.eigenvectors().col( 3 );
	if ( lambda[3] - lambda[2] <= kOpenRotationGap && projection.norm() > kOpenRotationGap )
	{
		q = projection;
	}
	if ( q.dot( before ) < 0.0 )
	{
		q = -q;
	}
	return Eigen::Quaterniond( q[0], q[1], q[2], q[3] ).normalized();
}

Eigen::Quaternionf fitRotation( const Eigen::Matrix3f& a, const Eigen::Quaternionf& previous )
{
	return fitRotation( Eigen::Matrix3d( a.cast<double>() ), previous.cast<double>() ).cast<float>();
}

} // namespace pliant
