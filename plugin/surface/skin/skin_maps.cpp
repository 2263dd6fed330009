// The affine maps by which nodes move the skin. Steinemann et al. 2008, section 7.

#include "surface/constants.h"
#include "surface/skin/four_floats.h"
#include "surface/skin/skin_fade.h"
#include "surface/skin/skinning.h"

namespace pliant {

namespace {

using Matrix3fRows = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;

/// A node's deformation gradient as measured from its neighbours; where that is crushed, inverted or torn, that of its region: R S_p.
Eigen::Matrix3f soundGradient( const float* nine, const Eigen::Matrix3f& wanted )
{
	const Eigen::Matrix3f f = Eigen::Map<const Matrix3fRows>( nine );
	const float strain = ( f - wanted ).squaredNorm();
	const float fraction = strain < kSoundStrain ? 1.0f
		: strain < 4.0f * kSoundStrain           ? ( 4.0f * kSoundStrain - strain ) / ( 3.0f * kSoundStrain )
												 : 0.0f;
	return wanted + fraction * ( fraction > 0.0f ? Eigen::Matrix3f( f - wanted ) : Eigen::Matrix3f( Eigen::Matrix3f::Zero() ) );
}

} // namespace

void skinMaps( const NodeState& state, const SkinPose& pose, float* maps, int first, int last )
{
	for ( int i = first; i < last; ++i )
	{
		const float* const rotation = pose.rotations + 4 * std::size_t( i );
		Eigen::Matrix3f r = Eigen::Quaternionf( rotation[3], rotation[0], rotation[1], rotation[2] ).toRotationMatrix();
		if ( pose.flow )
		{
			// T = [R S_p , c - R S_p c0]   (Steinemann et al. 2008, below eq. 10)
			r *= Eigen::Map<const Matrix3fRows>( pose.flow + 9 * std::size_t( i ) );
		}
		if ( pose.gradients )
		{
			r = soundGradient( pose.gradients + 9 * std::size_t( i ), r );
		}
		const Vec3 shift = state.x.get( i ) - r * state.x0.get( i );
		float* to = maps + std::size_t( i ) * kSkinMapFloats;
		for ( int row = 0; row < 3; ++row )
		{
			store4( to + 4 * row, F4{ r( row, 0 ), r( row, 1 ), r( row, 2 ), shift[row] } );
		}
	}
}

void skinMaps( const NodeState& state, const SkinPose& pose, float* maps )
{
	skinMaps( state, pose, maps, 0, state.count );
	if ( pose.fade )
	{
		pose.fade->ease( state, maps );
	}
}

} // namespace pliant
