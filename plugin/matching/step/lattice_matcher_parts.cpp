// Corrections of LatticeMatcher for rigid motion: of the whole body, or of each part of one in several parts (connected_parts.h).

#include "matching/step/lattice_matcher.h"
#include "threads/constants.h"

#include "threads/parallel.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// Sums of one part, world axes; positions relative to the frame's centre.
struct PartSums
{
	double mass = 0.0;
	Vec3d centre = Vec3d::Zero();
	Vec3d impulse = Vec3d::Zero(), turn = Vec3d::Zero();  ///< of the velocity changes by matching
	Vec3d momentum = Vec3d::Zero(), spin = Vec3d::Zero(); ///< of the velocities
	Eigen::Matrix3d second = Eigen::Matrix3d::Zero();     ///< sum m p p^T about the centre
};

Vec3d at( const float* const* component, int i )
{
	return { double( component[0][i] ), double( component[1][i] ), double( component[2][i] ) };
}

Vec3d at( float* const* component, int i )
{
	return { double( component[0][i] ), double( component[1][i] ), double( component[2][i] ) };
}

} // namespace

// Two rigid motions are subtracted from the change, both about the current positions, where they act:
// - the rounding errors of the internal forces' net impulse and torque, which should be zero;
// - the part of the wobble damping -k v that brakes the body as a whole: - k ( v - V - Omega x p ) remains.
void LatticeMatcher::correctRigidMotion( MatchView& view, float h ) const
{
	double sum[kImpulseSums] = {};
	for ( const auto& partial : m_partial )
	{
		for ( int k = 0; k < kImpulseSums; ++k )
		{
			sum[k] += partial[k];
		}
	}
	const Eigen::Matrix3d rotation = m_frame.toRotationMatrix();
	const Vec3d centre = Vec3d::Map( sum + 6 ) / m_mass; // cells, body frame
	const Vec3d pivot = rotation * centre * m_cellSize;

	// I = sum m ( |p|^2 1 - p p^T ) about the mass centre
	Eigen::Matrix3d second;
	second << sum[9], sum[14], sum[13], sum[14], sum[10], sum[12], sum[13], sum[12], sum[11];
	second -= m_mass * centre * centre.transpose();
	const Eigen::Matrix3d inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
	const Eigen::Matrix3d inverseInertia = flooredInverse( inertia, kInertiaFloor ); // 1 / (kg cells^2)

	Vec3d shift = Vec3d::Zero(), turn = Vec3d::Zero();
	if ( m_keepsMomentum )
	{
		const Vec3d impulse = Vec3d::Map( sum );
		shift += rotation * impulse / m_mass * view.velocityPerCell;
		turn += rotation * ( inverseInertia * ( Vec3d::Map( sum + 3 ) - centre.cross( impulse ) ) ) / h;
	}
	const Vec3d momentum = Vec3d::Map( sum + 15 );
	const Vec3d spin = Vec3d::Map( sum + 18 ) - pivot.cross( momentum );
	const double perSquareMetre = 1.0 / ( double( m_cellSize ) * m_cellSize );
	shift -= view.wobbleFraction * momentum / m_mass;
	turn -= view.wobbleFraction * ( rotation * ( inverseInertia * ( rotation.transpose() * spin ) ) ) * perSquareMetre;
	for ( int k = 0; k < 3; ++k )
	{
		view.shift[k] = float( shift[k] );
		view.turn[k] = float( turn[k] );
		view.pivot[k] = float( view.frameCentre[k] + pivot[k] );
	}
}

void LatticeMatcher::updateParts( const MatchView& view, bool isOnePart )
{
	if ( isOnePart )
	{
		m_parts = ConnectedParts{};
		return;
	}
	if ( m_parts.areSeveral() && m_partsVersion == m_tablesVersion )
	{
		return;
	}
	m_parts = findConnectedParts( *m_tables, view );
	m_partsVersion = m_tablesVersion;
	m_partLength.assign( std::size_t( m_parts.count() ), 0.0f );
	for ( int p = 0; p < m_parts.count(); ++p )
	{
		Vec3d low = Vec3d::Constant( HUGE_VAL ), high = -low;
		m_parts.forNodes( p, view.nodeCount, [&]( int i ) {
			low = low.cwiseMin( at( view.x0, i ) );
			high = high.cwiseMax( at( view.x0, i ) );
		} );
		m_partLength[std::size_t( p )] = float( ( high - low ).maxCoeff() ) + m_cellSize;
	}
}

// As correctRigidMotion and the kernel `apply` for a body in one part.
void LatticeMatcher::applyToPart( const MatchView& view, const MatchStep& step, int part )
{
	const Eigen::Matrix3d perCell = m_frame.toRotationMatrix() * double( view.velocityPerCell );
	const Vec3d frame( double( view.frameCentre[0] ), double( view.frameCentre[1] ), double( view.frameCentre[2] ) );
	// The lowest vibration frequency, for which the rate is meant, is inversely proportional to the length.
	const double rate = double( step.wobbleDamping ) * double( step.wobbleLength ) / double( m_partLength[std::size_t( part )] );
	const double wobble = step.wobbleDamping > 0.0f ? std::min( double( step.mostWobble ), 1.0 - std::exp( -rate * double( step.h ) ) )
													: 0.0;
	PartSums sums;
	m_parts.forNodes( part, view.nodeCount, [&]( int i ) {
		sums.mass += double( view.mass[i] );
		sums.centre += double( view.mass[i] ) * ( at( view.x, i ) - frame );
	} );
	sums.centre /= sums.mass;
	m_parts.forNodes( part, view.nodeCount, [&]( int i ) {
		const Vec3d arm = at( view.x, i ) - frame - sums.centre;
		const Vec3d impulse = double( view.mass[i] ) * ( perCell * at( view.change, i ) ),
					momentum = double( view.mass[i] ) * at( view.v, i );
		sums.impulse += impulse;
		sums.turn += arm.cross( impulse );
		sums.momentum += momentum;
		sums.spin += arm.cross( momentum );
		sums.second += double( view.mass[i] ) * arm * arm.transpose();
	} );
	const double conserved = m_keepsMomentum ? 1.0 : 0.0;
	const Eigen::Matrix3d inverse = inverseOfPart( sums.second.trace() * Eigen::Matrix3d::Identity() - sums.second, sums.mass );
	const Vec3d shift = ( conserved * sums.impulse - wobble * sums.momentum ) / sums.mass,
				turn = inverse * ( conserved * sums.turn - wobble * sums.spin );
	m_parts.forNodes( part, view.nodeCount, [&]( int i ) {
		const Vec3d arm = at( view.x, i ) - frame - sums.centre, v = at( view.v, i );
		const Vec3d now = v + double( view.freedom[i] ) * ( perCell * at( view.change, i ) - shift - turn.cross( arm ) - wobble * v );
		for ( int k = 0; k < 3; ++k )
		{
			view.v[k][i] = float( now[k] );
		}
	} );
}

void LatticeMatcher::applyToParts( const MatchView& view, const MatchStep& step, TaskRunner* runner )
{
	const int count = m_parts.count(), tasks = std::min( count, kMaxChunks );
	auto task = [&]( int k ) {
		for ( int part = k * count / tasks; part < ( k + 1 ) * count / tasks; ++part )
		{
			applyToPart( view, step, part );
		}
	};
	runTasks( view.nodeCount < kMinChunkSize ? nullptr : runner, tasks, task );
}

} // namespace pliant
