#include "surface/render/skin_blend.h"

#include "matching/rotation.h"
#include "surface/kernels/skin_kernels.h"

namespace pliant {

namespace {

using Rows = Eigen::Map<Eigen::Matrix<float, 3, 4, Eigen::RowMajor>>;
using ConstRows = Eigen::Map<const Eigen::Matrix<float, 3, 4, Eigen::RowMajor>>;

ConstRows rowsOf( const AlignedArray<float>& maps, std::size_t node )
{
	return ConstRows( maps.data() + node * std::size_t( kSkinMapFloats ) );
}

Rows rowsOf( AlignedArray<float>& maps, std::size_t node )
{
	return Rows( maps.data() + node * std::size_t( kSkinMapFloats ) );
}

/// The best-fitting rigid motion from one state to another.
struct Fit
{
	Eigen::Vector3d before = Eigen::Vector3d::Zero(), now = Eigen::Vector3d::Zero(); ///< centres
	Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
};

/// `apart`: added to the positions before. A node is a cube of edge `cell` at least: its second moment is m cell^2 / 12 along each axis.
Fit fitOf(
	const NodeState& nodes, const AlignedArray<float>& before, const AlignedArray<float>& now, const Eigen::Vector3d& apart, double cell )
{
	const auto at = [&nodes]( const ConstRows& map, int i ) {
		return Eigen::Vector3d( ( map * nodes.x0.get( i ).homogeneous() ).cast<double>() );
	};
	Fit fit;
	double mass = 0.0;
	for ( int i = 0; i < nodes.count; ++i )
	{
		const double m = double( nodes.mass[i] );
		mass += m;
		fit.before += m * at( rowsOf( before, std::size_t( i ) ), i );
		fit.now += m * at( rowsOf( now, std::size_t( i ) ), i );
	}
	fit.before /= mass;
	fit.now /= mass;
	Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
	for ( int i = 0; i < nodes.count; ++i )
	{
		const ConstRows b = rowsOf( before, std::size_t( i ) ), n = rowsOf( now, std::size_t( i ) );
		sum += double( nodes.mass[i] ) *
			( ( at( n, i ) - fit.now ) * ( at( b, i ) - fit.before ).transpose() +
				( cell * cell / 12.0 ) * n.leftCols<3>().cast<double>() * b.leftCols<3>().cast<double>().transpose() );
	}
	fit.turn = fitRotation( sum, fit.turn );
	fit.before += apart;
	return fit;
}

} // namespace

void SkinBlend::keep( AlignedArray<float>& maps, const Eigen::Vector3d& origin )
{
	m_before.swap( maps );
	m_origin = origin;
	m_isKept = true;
}

void SkinBlend::renumber( const std::vector<std::uint32_t>& source, const Eigen::Vector3d& shift )
{
	if ( m_isKept )
	{
		*this = ofPiece( source, shift );
	}
}

SkinBlend SkinBlend::ofPiece( const std::vector<std::uint32_t>& source, const Eigen::Vector3d& shift ) const
{
	SkinBlend piece;
	if ( !m_isKept )
	{
		return piece;
	}
	piece.m_before.resize( source.size() * std::size_t( kSkinMapFloats ) );
	for ( std::size_t i = 0; i < source.size(); ++i )
	{
		Rows to = rowsOf( piece.m_before, i );
		to = rowsOf( m_before, source[i] );
		to.col( 3 ) += to.leftCols<3>() * shift.cast<float>();
	}
	piece.m_origin = m_origin;
	piece.m_isKept = true;
	return piece;
}

void SkinBlend::followLevels( const std::vector<std::uint32_t>& source, const AlignedArray<float>& before, const AlignedArray<float>& now )
{
	if ( !m_isKept )
	{
		return;
	}
	renumber( source );
	for ( std::size_t i = 0; i < source.size(); ++i )
	{
		rowsOf( m_before, i ) += rowsOf( now, i ) - rowsOf( before, source[i] );
	}
}

void SkinBlend::between(
	const NodeState& nodes, const AlignedArray<float>& maps, double fraction, double cell, AlignedArray<float>& blended ) const
{
	const Eigen::Vector3d apart = m_origin - nodes.origin;
	const Fit fit = fitOf( nodes, m_before, maps, apart, cell );
	const Eigen::Quaterniond part = Eigen::Quaterniond::Identity().slerp( fraction, fit.turn );
	const Eigen::Matrix3d ofBefore = ( 1.0 - fraction ) * part.toRotationMatrix();
	const Eigen::Matrix3d ofNow = fraction * ( part * fit.turn.conjugate() ).toRotationMatrix();
	const Eigen::Vector3d centre = ( 1.0 - fraction ) * fit.before + fraction * fit.now;
	// s( t ) = centre + ofBefore ( s_b + apart - c_b ) + ofNow ( s_n - c_n )
	const Eigen::Vector3f constant = ( centre + ofBefore * ( apart - fit.before ) - ofNow * fit.now ).cast<float>();
	const Eigen::Matrix3f a = ofBefore.cast<float>(), b = ofNow.cast<float>();
	blended.resize( maps.size() );
	for ( std::size_t i = 0; i < std::size_t( nodes.count ); ++i )
	{
		Rows to = rowsOf( blended, i );
		to = a * rowsOf( m_before, i ) + b * rowsOf( maps, i );
		to.col( 3 ) += constant;
	}
}

} // namespace pliant
