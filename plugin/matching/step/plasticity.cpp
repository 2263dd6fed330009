#include "matching/step/plasticity.h"

#include "lattice/lattice.h"
#include "matching/constants.h"
#include "matching/rotation.h"
#include "matching/volume_law.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

using Matrix3fRows = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;

constexpr int kSymmetric[6][2] = { { 0, 0 }, { 1, 1 }, { 2, 2 }, { 1, 2 }, { 0, 2 }, { 0, 1 } };

/// Scales to a product of 1.
Vec3d unitVolume( const Vec3d& stretches )
{
	return stretches / std::cbrt( stretches.prod() );
}

double distanceFromOne( const Vec3d& stretches )
{
	return ( stretches - Vec3d::Ones() ).norm();
}

/// M = Q U: U as unitStretch returns it, and Q.
struct UnitStretch
{
	Eigen::Matrix3d stretch, rotation;
};

UnitStretch unitStretchOf( const Eigen::Matrix3d& m, double limit )
{
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver( m.transpose() * m );
	const Eigen::Matrix3d& axes = solver.eigenvectors();
	const Vec3d own = solver.eigenvalues().cwiseMax( 0.0 ).cwiseSqrt();
	Vec3d stretches = unitVolume( own );
	if ( distanceFromOne( stretches ) > limit )
	{
		// Along 1 + t ( S_p - 1 ), scaled to det = 1, the distance from 1 grows with t, but not linearly where an axis has nearly vanished.
		const Vec3d direction = stretches - Vec3d::Ones();
		double inside = 0.0, beyond = 1.0;
		for ( int halving = 0; halving < 3 * kLimitRounds; ++halving )
		{
			const double t = 0.5 * ( inside + beyond );
			( distanceFromOne( unitVolume( Vec3d::Ones() + t * direction ) ) <= limit ? inside : beyond ) = t;
		}
		stretches = unitVolume( Vec3d::Ones() + inside * direction );
	}
	return UnitStretch{ axes * stretches.asDiagonal() * axes.transpose(), m * axes * own.cwiseInverse().asDiagonal() * axes.transpose() };
}

} // namespace

Eigen::Matrix3d unitStretch( const Eigen::Matrix3d& m, double limit )
{
	return unitStretchOf( m, limit ).stretch;
}

double FlowingRegion::energy( const Eigen::Matrix3d& fitted, const Eigen::Matrix3d& stretch ) const
{
	const Eigen::Matrix3d back = stretch.inverse();
	const Eigen::Matrix3d strain = fitted.transpose() * total * back - Eigen::Matrix3d::Identity();
	const double shape = 0.5 * ( strain * stretch * moment ).cwiseProduct( strain * stretch ).sum();
	if ( volumeKeeping == 0.0 )
	{
		return shape;
	}
	const double extents = inPlane.trace(), mean = volumeMean( back * inverse * back, extents );
	const Eigen::Matrix3d one = Eigen::Matrix3d::Identity(), out = one - inPlane, own = ( inverse + out ).inverse() - out; // J
	const double size = volumeStrain( one + strain, volumeWeights( own, mean, extents ) ).size;
	return shape + volumeKeeping * mean * volumeEnergy( size );
}

bool flowStretch( const PlasticLaw& law, float h, const FlowingRegion& region, Eigen::Matrix3d& stretch )
{
	// E = R^T F S_p^-1 - 1,  S_e - 1 = sym( E )
	const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
	const Eigen::Matrix3d strain = region.rotation.transpose() * region.total * stretch.inverse() - one;
	const Eigen::Matrix3d stretching = 0.5 * ( strain + strain.transpose() );
	const double size = stretching.norm();
	if ( !( size > double( law.yieldStrain ) ) || !std::isfinite( size ) )
	{
		return false;
	}
	const double before = region.energy( region.rotation, stretch );
	const auto tryFlow = [&]( const Eigen::Matrix3d& flow ) {
		const UnitStretch to = unitStretchOf( ( one + flow ) * stretch, law.limit );
		// A flat region stays in its plane.
		const Eigen::Matrix3d out = one - region.inPlane, next = region.inPlane * to.stretch * region.inPlane + out * to.stretch * out;
		Eigen::Matrix3d rotation = region.rotation * to.rotation;
		if ( region.volumeKeeping > 0.0 ) // the rotation that fits shapes best is not the one of least energy then
		{
			rotation = fitRotation( region.total * region.moment * next, Eigen::Quaterniond( rotation ) ).toRotationMatrix();
		}
		const bool isLess = region.energy( rotation, next ) < before;
		stretch = isLess ? next : stretch;
		return isLess;
	};
	// More than the whole strain would overshoot, and an inverted region must not change its rest shape at once.
	double fraction = std::min( { double( law.creep ) * h, 1.0, kLargestFlow / size } );
	if ( tryFlow( fraction * stretching ) )
	{
		return true;
	}
	const Eigen::Matrix3d resisting = stretch * region.moment * stretch;
	const Eigen::Matrix3d compliance = ( resisting + kFlowFloor * resisting.trace() * one ).inverse();
	const Eigen::Matrix3d downhill = strain - strain.trace() / compliance.trace() * compliance;
	fraction = std::min( fraction, kLargestFlow / downhill.norm() );
	bool hasFlowed = false;
	for ( int k = 0; k < kFlowHalvings && !hasFlowed; ++k, fraction *= 0.5 )
	{
		hasFlowed = tryFlow( fraction * downhill );
	}
	return hasFlowed;
}

PlasticFlow::PlasticFlow( const RegionTables& tables )
{
	allocate( tables );
}

void PlasticFlow::allocate( const RegionTables& tables )
{
	m_tables = &tables;
	for ( int k = 0; k < 6; ++k )
	{
		m_stretch[k].assign( std::size_t( tables.moments.padded ), 0.0f );
		m_inverse[k] = tables.moments.inverseMoment[k];
	}
	for ( int k = 0; k < 9; ++k )
	{
		m_blend[k] = tables.blend[k];
	}
}

bool PlasticFlow::yieldsAnywhere( const MatchView& view, float yieldStrain )
{
	const float limit = yieldStrain * yieldStrain;
	int over = 0;
	for ( int r = 0; r < view.nodeCount; ++r )
	{
		over += view.strain[r] > limit ? 1 : 0;
	}
	return over > 0;
}

void PlasticFlow::show( MatchView& view ) const
{
	for ( int k = 0; k < 6; ++k )
	{
		const auto [row, column] = kSymmetric[k];
		view.plastic[3 * row + column] = view.plastic[3 * column + row] = m_stretch[k].data();
		view.inverseMoment[k] = m_inverse[k].data();
	}
	for ( int k = 0; k < 9; ++k )
	{
		view.blend[k] = m_blend[k].empty() ? nullptr : m_blend[k].data();
	}
}

FlowingRegion PlasticFlow::regionOf( const MatchView& view, int r ) const
{
	const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
	const RegionMoments& moments = m_tables->moments;
	FlowingRegion region;
	region.rotation = Eigen::Quaternionf( view.quaternion[0][r], view.quaternion[1][r], view.quaternion[2][r], view.quaternion[3][r] )
						  .cast<double>()
						  .toRotationMatrix();
	region.moment = loadSymmetric( moments.moment, r );
	region.inverse = loadSymmetric( moments.inverseMoment, r );
	region.inPlane = m_tables->outOfPlane[0].empty() ? one : Eigen::Matrix3d( one - loadSymmetric( m_tables->outOfPlane, r ) );
	region.volumeKeeping = double( view.volumeFraction );
	if ( !m_tables->blend[0].empty() )
	{
		Eigen::Matrix3d blend;
		for ( int k = 0; k < 9; ++k )
		{
			blend( k / 3, k % 3 ) = m_tables->blend[k][r];
		}
		const Eigen::Matrix3d fine = region.moment * blend;
		region.moment = 0.5 * ( fine + fine.transpose() );
		region.volumeKeeping *= 1.0 - double( view.regionBeta ? view.regionBeta[r] : view.beta );
	}
	return region;
}

bool PlasticFlow::flow( const MatchView& view, const Kernels& kernels, const MatchStep& step, int begin, int end )
{
	const float limit = step.plastic.yieldStrain * step.plastic.yieldStrain;
	bool hasFlowed = false;
	for ( int block = begin; block < end; block += kLanes )
	{
		const int last = std::min( block + kLanes, view.nodeCount );
		// | F_e - R |^2 is an upper bound of | S_e - 1 |^2: where it is small no region yields.
		const bool yields = std::any_of(
			view.strain + block, view.strain + std::max( block, last ), [limit]( float s ) { return s > limit; } );
		if ( !yields )
		{
			continue;
		}
		float gradients[9 * kLanes];
		kernels.deformations( view, block, block + kLanes, gradients );
		for ( int r = block; r < last; ++r )
		{
			if ( !( view.strain[r] > limit ) )
			{
				continue;
			}
			FlowingRegion region = regionOf( view, r );
			region.total = Eigen::Map<const Matrix3fRows>( gradients + 9 * ( r - block ) ).cast<double>();
			Eigen::Matrix3d now = stretch( r );
			if ( flowStretch( step.plastic, step.h, region, now ) )
			{
				store( r, now );
				hasFlowed = true;
			}
		}
	}
	return hasFlowed;
}

Eigen::Matrix3d PlasticFlow::stretch( int region ) const
{
	return loadSymmetric( m_stretch, region ) + Eigen::Matrix3d::Identity();
}

void PlasticFlow::store( int region, Eigen::Matrix3d stretch )
{
	if ( !m_tables->outOfPlane[0].empty() )
	{
		// A flat region stays in its plane: the off-plane part of the stretch, which only a change of levels can introduce, is dropped.
		const Eigen::Matrix3d out = loadSymmetric( m_tables->outOfPlane, region ), in = Eigen::Matrix3d::Identity() - out;
		stretch = Eigen::Matrix3d( in * stretch * in + out * stretch * out );
	}
	// J'^+ = S_p^-1 J^+ S_p^-1,  J'^+ J'_fine = S_p^-1 ( J^+ J_fine ) S_p
	const Eigen::Matrix3d back = stretch.inverse();
	const Eigen::Matrix3d inverse = back * loadSymmetric( m_tables->moments.inverseMoment, region ) * back;
	for ( int k = 0; k < 6; ++k )
	{
		const auto [row, column] = kSymmetric[k];
		m_stretch[k][region] = float( stretch( row, column ) - ( row == column ? 1.0 : 0.0 ) );
		m_inverse[k][region] = float( inverse( row, column ) );
	}
	if ( m_blend[0].empty() )
	{
		return;
	}
	Eigen::Matrix3d blend;
	for ( int k = 0; k < 9; ++k )
	{
		blend( k / 3, k % 3 ) = m_tables->blend[k][region];
	}
	blend = Eigen::Matrix3d( back * blend * stretch );
	for ( int k = 0; k < 9; ++k )
	{
		m_blend[k][region] = float( blend( k / 3, k % 3 ) );
	}
}

void PlasticFlow::carryOver( const RegionTables& before, const RegionTables& now, const FlowSources& sources )
{
	std::vector<Eigen::Matrix3d> sum( sources.source.size(), Eigen::Matrix3d::Zero() );
	std::vector<double> mass( sources.source.size(), 0.0 );
	std::vector<int> count( sources.source.size(), 0 );
	for ( int i = 0; i < before.moments.count; ++i )
	{
		if ( const std::uint32_t to = sources.nodeNow[i]; to != kNoNode )
		{
			sum[to] += double( sources.massBefore[i] ) * loadSymmetric( m_stretch, i );
			mass[to] += sources.massBefore[i];
			++count[to];
		}
	}
	for ( std::size_t r = 0; r < sum.size(); ++r )
	{
		sum[r] = mass[r] > 0.0 ? Eigen::Matrix3d( sum[r] / mass[r] ) : loadSymmetric( m_stretch, int( sources.source[r] ) );
	}
	allocate( now );
	for ( int r = 0; r < int( sum.size() ); ++r )
	{
		if ( !sum[r].isZero( 0.0 ) )
		{
			const Eigen::Matrix3d stretch = sum[r] + Eigen::Matrix3d::Identity();
			store( r,
				count[r] > 1 ? unitStretch( stretch )
							 : stretch ); // the mean of volume-preserving stretches is only nearly volume-preserving
		}
	}
}

void PlasticFlow::inherit( const PlasticFlow& from, const std::vector<std::uint32_t>& source )
{
	for ( std::size_t r = 0; r < source.size(); ++r )
	{
		const Eigen::Matrix3d stretch = from.stretch( int( source[r] ) );
		if ( !stretch.isIdentity( 0.0 ) )
		{
			store( int( r ), stretch );
		}
	}
}

} // namespace pliant
