#include "matching/step/settle_region.h"

#include "matching/rotation.h"

namespace pliant {

void settleRegion( const Kernels& kernels, const MatchView& view, int r )
{
	float a[9];
	kernels.regionMatrix( view, r, a );
	float* const( &q )[4] = view.quaternion;
	const Eigen::Quaternionf before( q[0][r], q[1][r], q[2][r], q[3][r] );
	const Eigen::Quaternionf now = fitRotation( Eigen::Matrix3f( Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>( a ) ), before );
	q[0][r] = now.w();
	q[1][r] = now.x();
	q[2][r] = now.y();
	q[3][r] = now.z();
	kernels.finishRegion( view, r );
}

} // namespace pliant
