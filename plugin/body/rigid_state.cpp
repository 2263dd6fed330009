#include "body/rigid_state.h"

#include "body/body.h"
#include "body/breaking.h"
#include "body/free_rotation.h"
#include "fracture/shards/shard_cracks.h"
#include "matching/constants.h"
#include "matching/matcher.h"
#include "matching/rotation.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {

namespace {

/// Applies the inverse of the inertia tensor in the world's axes.
Vec3d freeAngularVelocity( const Vec3d& moments, const Eigen::Quaterniond& rotation, const Vec3d& spin )
{
	const Vec3d own = rotation.conjugate() * spin;
	Vec3d turning;
	for ( int k = 0; k < 3; ++k )
	{
		turning[k] = moments[k] > 0.0 ? own[k] / moments[k] : 0.0;
	}
	return rotation * turning;
}

Vec3d spinOf( const Vec3d& moments, const Eigen::Quaterniond& rotation, const Vec3d& angularVelocity )
{
	return rotation * Vec3d( moments.cwiseProduct( rotation.conjugate() * angularVelocity ) );
}

/// Whether pinned nodes leave a body no rigid motion: they are spread in two directions, or there are no others. `cell`: size, m.
bool areHeldFirmly( const NodeState& nodes, double cell )
{
	Vec3d sum = Vec3d::Zero();
	Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
	int held = 0;
	for ( int i = 0; i < nodes.count; ++i )
	{
		if ( nodes.freedom[i] == 0.0f )
		{
			const Vec3d at = nodes.x.get( i ).cast<double>();
			sum += at;
			squares += at * at.transpose();
			++held;
		}
	}
	if ( held == 0 || held == nodes.count )
	{
		return held > 0;
	}
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread( squares / held - sum * sum.transpose() / ( held * double( held ) ) );
	return spread.eigenvalues()[1] > kFirmSpread * kFirmSpread * cell * cell;
}

} // namespace

RigidMotion advanced( const RigidState& state, const RigidMotion& motion, double h )
{
	RigidMotion next = motion;
	next.centre += h * motion.velocity;
	const Vec3d spin = spinOf( state.moments, motion.rotation, motion.angularVelocity );
	next.rotation = ( freeRotation( state.moments, motion.rotation, spin, h ) * motion.rotation ).normalized();
	next.angularVelocity = freeAngularVelocity( state.moments, next.rotation, spin );
	return next;
}

double Body::speedOfSound() const
{
	return std::sqrt( double( m_material.youngsModulus ) / double( m_material.density ) );
}

bool Body::isInelastic() const
{
	const bool isRigidCluster = m_material.method == Method::SingleCluster && m_material.clusterMode == ClusterMode::Rigid;
	return m_nodes.count == 1 || isRigidCluster;
}

double Body::largestInvisibleVelocity( bool breaks ) const
{
	return ( breaks || isInelastic() ? largestInvisibleStrain() : double( m_material.rigidStrain ) ) * speedOfSound();
}

double Body::weakestBreakStrain() const
{
	const bool breaks = m_breaking && m_fracture.rule != BreakRule::Never && !( m_breaking->shards && m_breaking->shards->isOne() );
	return breaks ? double( m_breaking->limits.weakest * breakStrain( m_fracture, m_material ) ) : std::numeric_limits<double>::infinity();
}

double Body::largestInvisibleStrain() const
{
	return isInelastic() ? std::numeric_limits<double>::infinity()
						 : std::min( double( m_material.rigidStrain ), kRigidBreakFraction * weakestBreakStrain() );
}

// A vibration of velocity v strains a body by v / c, c its speed of sound.
bool Body::vibratesLess( double limit ) const
{
	const BodySums whole = sums();
	const Vec3d turning = angularVelocity();
	const double fastest = limit * speedOfSound();
	for ( int i = 0; i < m_nodes.count; ++i )
	{
		const Vec3d arm = m_nodes.x.get( i ).cast<double>() - whole.centre;
		const Vec3d rigid = whole.momentum / whole.mass + turning.cross( arm );
		if ( ( m_nodes.v.get( i ).cast<double>() - rigid ).squaredNorm() > fastest * fastest )
		{
			return false;
		}
	}
	return true;
}

Body::StrainSize Body::strainSize() const
{
	StrainSize size;
	double sum = 0.0, count = 0.0;
	const auto add = [&]( double strain, bool canBreak ) {
		size.largest = std::max( size.largest, std::abs( strain ) );
		size.ofBreakable = canBreak ? std::max( size.ofBreakable, strain ) : size.ofBreakable;
		sum += strain * strain;
		count += 1.0;
	};
	const bool canBreak = m_breaking && m_fracture.rule != BreakRule::Never;
	const std::vector<std::uint32_t>* const shards = canBreak && m_breaking->shards ? &m_breaking->shards->shards() : nullptr;
	if ( m_levels )
	{
		std::vector<float> gradients( std::size_t( m_nodes.padded ) * 9 );
		nodeDeformations( gradients.data() );
		for ( int i = 0; i < m_nodes.count; ++i )
		{
			const Eigen::Map<const Eigen::Matrix3f> f( gradients.data() + 9 * std::size_t( i ) );
			add( 0.5 * double( ( f * f.transpose() - Eigen::Matrix3f::Identity() ).norm() ), canBreak ); // Green's strain
		}
	}
	for ( int i = 0; i < m_nodes.count && !m_levels; ++i )
	{
		for ( std::uint32_t k = m_lattice->linkStart[i]; k < m_lattice->linkStart[i + 1]; ++k )
		{
			if ( const int j = int( m_lattice->linkTo[k] ); j > i )
			{
				const double rest = ( m_nodes.x0.get( j ) - m_nodes.x0.get( i ) ).norm();
				const double strain = ( double( ( m_nodes.x.get( j ) - m_nodes.x.get( i ) ).norm() ) - rest ) / rest;
				size.hasFold = size.hasFold || strain > kFoldedStretch || strain < -kFoldedSquash;
				add( strain, canBreak && ( !shards || ( *shards )[std::size_t( i )] != ( *shards )[std::size_t( j )] ) );
			}
		}
	}
	size.mean = count > 0.0 ? std::sqrt( sum / count ) : 0.0;
	return size;
}

bool Body::isHardlyStrained( const StrainSize& strain ) const
{
	return strain.mean <= largestInvisibleStrain() && strain.ofBreakable <= kRigidBreakFraction * weakestBreakStrain();
}

// A body under a load that strains a part of it visibly, such as a shard in a heap, may be rigid while the load stays, if it is calm. So
// may a pinned body at rest.
bool Body::canBecomeRigid( bool isAtRest ) const
{
	const double limit = largestInvisibleStrain();
	const bool isHeld = m_nodes.hasHeldNodes();
	if ( m_rigid || m_material.rigidStrain == 0.0f || !m_isOnePart || hasBrokenLinks() || hasFlowed() ||
		!( isHeld ? isAtRest && areHeldFirmly( m_nodes, double( m_lattice->cellSize ) ) : vibratesLess( limit ) ) )
	{
		return false;
	}
	const StrainSize strain = strainSize();
	return isFolded( strain ) ||
		( isHardlyStrained( strain ) && ( isHeld || !isBent( strain ) || ( isAtRest && vibratesLess( kCalmFraction * limit ) ) ) );
}

// A thin piece that an impact has crushed may rest folded: a flat region whose nodes lie on the wrong side of a line is half a turn from
// its goal, and stays. Nothing else strains a calm free body by so much if it breaks at less.
bool Body::isFolded( const StrainSize& strain ) const
{
	return strain.hasFold && !m_nodes.hasHeldNodes() && m_breaking &&
		double( m_breaking->limits.weakest * breakStrain( m_fracture, m_material ) ) < kFoldedStretch &&
		vibratesLess( kCalmFraction * largestInvisibleStrain() );
}

// The elastic energy of the fold is lost, its momentum is not.
void Body::unfold( const Vec3d& centre )
{
	const Eigen::Quaterniond rotation = bestFit().rotation;
	for ( int i = 0; i < m_nodes.count; ++i )
	{
		m_nodes.x.set( i, ( centre + rotation * m_nodes.x0.get( i ).cast<double>() ).cast<float>() );
	}
	m_matcher->reset( m_nodes, rotation );
	m_energyDebt = LevelDebt{};
}

void Body::becomeRigid()
{
	const StrainSize strain = strainSize();
	const BodySums whole = sums();
	const bool wasFolded = isFolded( strain );
	if ( wasFolded )
	{
		unfold( whole.centre );
	}
	m_rigid = std::make_unique<RigidState>();
	RigidState& state = *m_rigid;
	state.isBent = isBent( strain ) && !wasFolded;
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes( inertiaAbout( whole.centre ) );
	Eigen::Matrix3d frame = axes.eigenvectors();
	if ( frame.determinant() < 0.0 )
	{
		frame.col( 2 ) = -frame.col( 2 );
	}
	// Nodes are mass points. Where they are nearly on a line, contacts on the material around them would spin it without end.
	const double thin = kInertiaFloor * axes.eigenvalues()[2];
	const double least = kCellInertia * whole.mass * double( m_lattice->cellSize ) * double( m_lattice->cellSize );
	state.mass = whole.mass;
	state.moments = axes.eigenvalues().unaryExpr(
		[thin, least]( double moment ) { return moment > thin ? std::max( moment, least ) : 0.0; } );
	state.motion.rotation = Eigen::Quaterniond( frame ).normalized();
	state.motion.centre = m_nodes.origin + whole.centre;
	state.isHeld = m_nodes.hasHeldNodes();
	if ( !state.isHeld )
	{
		state.motion.velocity = whole.momentum / whole.mass;
		state.motion.angularVelocity = freeAngularVelocity( state.moments, state.motion.rotation, whole.spin );
	}
	state.arm.resize( m_nodes.padded );
	for ( int i = 0; i < m_nodes.count; ++i )
	{
		const Vec3d arm = m_nodes.x.get( i ).cast<double>() - whole.centre;
		state.arm.set( i, ( state.motion.rotation.conjugate() * arm ).cast<float>() );
	}
	moveAsRigid( state.motion );
}

// x_i = c + R q_i,   v_i = V + w x R q_i
void Body::moveAsRigid( const RigidMotion& motion )
{
	m_matcher->turn( ( motion.rotation * m_rigid->motion.rotation.conjugate() ).normalized() );
	m_rigid->motion = motion;
	m_nodes.origin = snapped( motion.centre );
	const Eigen::Matrix3f rotation = motion.rotation.toRotationMatrix().cast<float>();
	const Vec3 centre = ( motion.centre - m_nodes.origin ).cast<float>();
	const Vec3 velocity = motion.velocity.cast<float>(), turning = motion.angularVelocity.cast<float>();
	m_motion = MotionSums{};
	for ( int i = 0; i < m_nodes.count; ++i )
	{
		const Vec3 arm = rotation * m_rigid->arm.get( i );
		m_nodes.x.set( i, centre + arm );
		m_nodes.v.set( i, velocity + turning.cross( arm ) );
		m_motion.squareSpeed += double( m_nodes.mass[i] ) * double( m_nodes.v.get( i ).squaredNorm() );
	}
	m_motion.mass = m_rigid->mass;
	for ( int k = 0; k < 3; ++k )
	{
		m_motion.moment[k] = m_rigid->mass * double( centre[k] );
	}
}

void Body::setRigidVelocities( const Vec3d& linear, const Vec3d& angular )
{
	m_rigid->motion.velocity = linear;
	m_rigid->motion.angularVelocity = angular;
}

void Body::followVelocities()
{
	if ( !m_rigid || m_rigid->isHeld )
	{
		return;
	}
	const BodySums whole = sums();
	RigidMotion motion = m_rigid->motion;
	motion.velocity = whole.momentum / whole.mass;
	motion.angularVelocity = freeAngularVelocity( m_rigid->moments, motion.rotation, whole.spin );
	moveAsRigid( motion );
}

void Body::applyRigidForces( float h, const Vec3d& gravity )
{
	if ( !m_fieldForce.x.empty() )
	{
		for ( int i = 0; i < m_nodes.count; ++i )
		{
			m_nodes.v.set( i, m_nodes.v.get( i ) + ( h / m_nodes.mass[i] ) * m_fieldForce.get( i ) );
		}
		followVelocities();
	}
	setRigidVelocities( m_rigid->motion.velocity + double( h ) * gravity, m_rigid->motion.angularVelocity );
}

void Body::becomeDeformable()
{
	m_rigid.reset();
	keepFiniteState();
}

} // namespace pliant
