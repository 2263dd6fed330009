#include "world/joints/joint_mobility.h"

#include "world/constants.h"

#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>
#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <numeric>

namespace pliant {

namespace {

bool isMovable( const btRigidBody& body )
{
	return body.getInvMass() > 0 && !body.isStaticOrKinematicObject();
}

JointGroup::Vector6 stacked( const btVector3& linear, const btVector3& angular )
{
	JointGroup::Vector6 both;
	both << double( linear.x() ), double( linear.y() ), double( linear.z() ), double( angular.x() ), double( angular.y() ),
		double( angular.z() );
	return both;
}

} // namespace

/// The rows of one joint, as Bullet's solver reads them: each array has kStride numbers for each row.
struct JointGroup::Rows
{
	static constexpr int kStride = 4;
	Rows( int count, double h, double erp, int iterations, double damping )
	{
		for ( std::vector<btScalar>* array : { &linearA, &angularA, &linearB, &angularB, &error, &cfm, &low, &high } )
		{
			array->assign( std::size_t( kStride * count ), btScalar( 0 ) );
		}
		std::fill( low.begin(), low.end(), -SIMD_INFINITY );
		std::fill( high.begin(), high.end(), SIMD_INFINITY );
		info.fps = btScalar( 1 / h );
		info.erp = btScalar( erp );
		info.m_J1linearAxis = linearA.data();
		info.m_J1angularAxis = angularA.data();
		info.m_J2linearAxis = linearB.data();
		info.m_J2angularAxis = angularB.data();
		info.rowskip = kStride;
		info.m_constraintError = error.data();
		info.cfm = cfm.data();
		info.m_lowerLimit = low.data();
		info.m_upperLimit = high.data();
		info.m_numIterations = iterations;
		info.m_damping = btScalar( damping );
	}
	static Vector6 rowOf( const std::vector<btScalar>& linear, const std::vector<btScalar>& angular, int row )
	{
		const btScalar *l = linear.data() + kStride * row, *a = angular.data() + kStride * row;
		return stacked( btVector3( l[0], l[1], l[2] ), btVector3( a[0], a[1], a[2] ) );
	}

	btTypedConstraint::btConstraintInfo2 info;
	std::vector<btScalar> linearA, angularA, linearB, angularB, error, cfm, low, high;
};

bool JointGroup::isHeld( const btRigidBody& body, const Joints& joints )
{
	const btVector3 one( 1, 1, 1 );
	if ( !( body.getLinearFactor() == one ) || !( body.getAngularFactor() == one ) )
	{
		return false;
	}
	for ( int k = 0; k < joints.size(); ++k )
	{
		if ( joints[k]->isEnabled() && ( &joints[k]->getRigidBodyA() == &body || &joints[k]->getRigidBodyB() == &body ) )
		{
			return true;
		}
	}
	return false;
}

int JointGroup::indexOf( const btRigidBody* body ) const
{
	const auto found = std::find( m_bodies.begin(), m_bodies.end(), body );
	return found == m_bodies.end() ? -1 : int( found - m_bodies.begin() );
}

void JointGroup::addBodies( btRigidBody& body, const Joints& joints )
{
	m_bodies.assign( 1, &body );
	for ( std::size_t next = 0; next < m_bodies.size() && m_bodies.size() <= kMostJoined; ++next )
	{
		for ( int k = 0; k < joints.size(); ++k )
		{
			btRigidBody *const a = &joints[k]->getRigidBodyA(), *const b = &joints[k]->getRigidBodyB();
			btRigidBody* const other = a == m_bodies[next] ? b : b == m_bodies[next] ? a : nullptr;
			if ( other && joints[k]->isEnabled() && isMovable( *other ) && indexOf( other ) < 0 )
			{
				m_bodies.push_back( other );
			}
		}
		addCoupledFrames( *m_bodies[next] );
	}
}

/// Adds all frames of the soft body of one of them: what moves one moves the others.
void JointGroup::addCoupledFrames( const btRigidBody& body )
{
	if ( !m_compliant )
	{
		return;
	}
	for ( const Compliant& each : *m_compliant )
	{
		if ( std::find( each.bodies.begin(), each.bodies.end(), &body ) != each.bodies.end() )
		{
			for ( const btRigidBody* const own : each.bodies )
			{
				indexOf( own ) < 0 ? m_bodies.push_back( const_cast<btRigidBody*>( own ) ) : void();
			}
		}
	}
}

void JointGroup::addRows( btTypedConstraint& joint, const std::vector<Load>& loads )
{
	btTypedConstraint::btConstraintInfo1 size;
	joint.getInfo1( &size );
	Rows rows( size.m_numConstraintRows, m_h, m_erp, m_iterations, m_damping );
	joint.getInfo2( &rows.info );
	const int a = indexOf( &joint.getRigidBodyA() ), b = indexOf( &joint.getRigidBodyB() );
	for ( int row = 0; row < size.m_numConstraintRows; ++row )
	{
		const Vector6 inA = Rows::rowOf( rows.linearA, rows.angularA, row ), inB = Rows::rowOf( rows.linearB, rows.angularB, row );
		const std::size_t at = std::size_t( Rows::kStride * row );
		double load = 0.0;
		for ( const Load& each : loads )
		{
			load += each.body == &joint.getRigidBodyA() ? inA.dot( each.impulse ) : 0.0;
			load += each.body == &joint.getRigidBodyB() ? inB.dot( each.impulse ) : 0.0;
		}
		const double limit = std::min( -double( rows.low[at] ), double( rows.high[at] ) );
		const bool holds = limit > 0.0 && 2.0 * std::abs( load ) <= limit; // a stop acts one way only; a motor near its limit does not hold
		if ( !holds && !m_compliant )
		{
			continue;
		}
		const Eigen::Index index = m_rows.rows();
		m_rows.conservativeResize( index + 1, 6 * Eigen::Index( m_bodies.size() ) );
		m_rows.row( index ).setZero();
		double target = double( rows.error[at] );
		for ( int side = 0; side < 2; ++side )
		{
			const btRigidBody& body = side == 0 ? joint.getRigidBodyA() : joint.getRigidBodyB();
			const Vector6& jacobian = side == 0 ? inA : inB;
			const int own = side == 0 ? a : b;
			if ( own >= 0 )
			{
				m_rows.block<1, 6>( index, 6 * own ) = jacobian.transpose();
			}
			else
			{
				target -= body.isKinematicObject() ? jacobian.dot( stacked( body.getLinearVelocity(), body.getAngularVelocity() ) ) : 0.0;
			}
		}
		m_targets.conservativeResize( index + 1 );
		m_targets[index] = target;
		m_softness.conservativeResize( index + 1 );
		m_softness[index] = double( rows.cfm[at] );
		m_low.conservativeResize( index + 1 );
		m_low[index] = double( rows.low[at] );
		m_high.conservativeResize( index + 1 );
		m_high[index] = double( rows.high[at] );
		m_jointOfRow.push_back( &joint );
	}
}

bool JointGroup::collect( btRigidBody& body, const Joints& joints, const std::vector<Load>& loads, double h, double erp )
{
	m_h = h;
	m_erp = erp;
	if ( !gather( body, joints, loads ) )
	{
		return false;
	}
	finish();
	return true;
}

bool JointGroup::collectCompliant( btRigidBody& body, const Joints& joints, const std::vector<Compliant>& compliant,
	const std::vector<unsigned char>& touches, const btContactSolverInfo& info )
{
	m_h = double( info.m_timeStep );
	m_erp = double( info.m_erp );
	m_iterations = info.m_numIterations;
	m_damping = double( info.m_damping );
	m_compliant = &compliant;
	m_touches = &touches;
	if ( !gather( body, joints, {} ) )
	{
		return false;
	}
	solveWithinLimits();
	return true;
}

/// Sets bodies, rows and masses. Returns false for a group that is too large.
bool JointGroup::gather( btRigidBody& body, const Joints& joints, const std::vector<Load>& loads )
{
	addBodies( body, joints );
	if ( m_bodies.size() > kMostJoined )
	{
		return false;
	}
	m_rows.resize( 0, 6 * Eigen::Index( m_bodies.size() ) );
	m_targets = m_softness = m_low = m_high = Eigen::VectorXd();
	m_jointOfRow.clear();
	for ( int k = 0; k < joints.size(); ++k )
	{
		if ( joints[k]->isEnabled() && ( contains( joints[k]->getRigidBodyA() ) || contains( joints[k]->getRigidBodyB() ) ) )
		{
			addRows( *joints[k], loads );
		}
	}
	setMasses();
	return true;
}

/// Sets M^-1 and V + h M^-1 F.
void JointGroup::setMasses()
{
	const Eigen::Index size = 6 * Eigen::Index( m_bodies.size() );
	m_inverse = Eigen::MatrixXd::Zero( size, size );
	m_velocities.resize( size );
	for ( std::size_t k = 0; k < m_bodies.size(); ++k )
	{
		const btRigidBody& body = *m_bodies[k];
		const Eigen::Index at = 6 * Eigen::Index( k );
		m_velocities.segment<6>( at ) = stacked( body.getLinearVelocity(), body.getAngularVelocity() );
		const std::size_t index = std::size_t( body.getWorldArrayIndex() );
		const bool isTouching = m_touches && index < m_touches->size() && ( *m_touches )[index] != 0;
		const btVector3 &moves = body.getLinearFactor(), &turns = body.getAngularFactor();
		for ( int i = 0; i < 3; ++i )
		{
			m_inverse( at + i, at + i ) = double( moves[i] * body.getInvMass() );
			for ( int j = 0; j < 3; ++j )
			{
				m_inverse( at + 3 + i, at + 3 + j ) = double( turns[i] * body.getInvInertiaTensorWorld()[i][j] * turns[j] );
			}
		}
		m_velocities.segment<6>( at ) += ( isTouching ? 0.0 : m_h ) *
			( m_inverse.block<6, 6>( at, at ) * stacked( body.getTotalForce(), body.getTotalTorque() ) );
	}
	const std::vector<Compliant> none;
	for ( const Compliant& each : m_compliant ? *m_compliant : none )
	{
		for ( std::size_t a = 0; a < each.bodies.size() && contains( *each.bodies[a] ); ++a )
		{
			const Eigen::Index at = 6 * indexOf( each.bodies[a] ), own = 6 * Eigen::Index( a );
			m_velocities.segment<6>( at ) = each.velocities.segment<6>( own );
			for ( std::size_t b = 0; b < each.bodies.size(); ++b )
			{
				m_inverse.block<6, 6>( at, 6 * indexOf( each.bodies[b] ) ) = each.mobility.block<6, 6>( own, 6 * Eigen::Index( b ) );
			}
		}
	}
}

void JointGroup::finish()
{
	m_mobility = m_inverse;
	m_jointImpulses = Eigen::VectorXd::Zero( m_rows.rows() );
	if ( m_rows.rows() == 0 )
	{
		return;
	}
	const Eigen::MatrixXd moved = m_inverse * m_rows.transpose();
	Eigen::MatrixXd gram = m_rows * moved;
	gram.diagonal() += m_softness;
	gram.diagonal() *= 1.0 + kJointRounding; // rows may be redundant
	const Eigen::LDLT<Eigen::MatrixXd> factors( gram );
	m_jointResponse = -factors.solve( moved.transpose() );
	m_mobility += moved * m_jointResponse;
	m_mobility = ( 0.5 * ( m_mobility + m_mobility.transpose() ) ).eval();
	m_velocities += moved * factors.solve( m_targets - m_rows * m_velocities );
}

// ( J M^-1 J^T + C ) p = b - J V for the rows within their limits. A row that would exceed a limit keeps it, until the others would move it
// back.
void JointGroup::solveWithinLimits()
{
	const Eigen::Index count = m_rows.rows();
	m_jointImpulses = Eigen::VectorXd::Zero( count );
	Eigen::MatrixXd gram = m_rows * m_inverse * m_rows.transpose();
	gram.diagonal() += m_softness;
	gram.diagonal() *= 1.0 + kJointRounding; // rows may be redundant
	const Eigen::VectorXd missing = m_targets - m_rows * m_velocities;
	std::vector<Eigen::Index> open( static_cast<std::size_t>( count ) );
	std::iota( open.begin(), open.end(), Eigen::Index( 0 ) );
	for ( int round = 0; round < kJointRounds && !open.empty(); ++round )
	{
		const Eigen::Index size = Eigen::Index( open.size() );
		const Eigen::VectorXd left = missing - gram * m_jointImpulses;
		Eigen::MatrixXd part( size, size );
		Eigen::VectorXd right( size );
		for ( Eigen::Index i = 0; i < size; ++i )
		{
			right[i] = left[open[std::size_t( i )]];
			for ( Eigen::Index j = 0; j < size; ++j )
			{
				part( i, j ) = gram( open[std::size_t( i )], open[std::size_t( j )] );
			}
		}
		const Eigen::VectorXd change = part.ldlt().solve( right );
		bool isWithin = true;
		for ( Eigen::Index i = 0; i < size; ++i )
		{
			const Eigen::Index row = open[std::size_t( i )];
			const double wanted = m_jointImpulses[row] + change[i];
			m_jointImpulses[row] = std::min( std::max( wanted, m_low[row] ), m_high[row] ); // a motor of a negative impulse has no range
			isWithin = isWithin && m_jointImpulses[row] == wanted;
		}
		const Eigen::VectorXd residual = missing - gram * m_jointImpulses;
		const auto isOpen = [&]( Eigen::Index row ) {
			return !( m_jointImpulses[row] <= m_low[row] && residual[row] <= 0.0 ) &&
				!( m_jointImpulses[row] >= m_high[row] && residual[row] >= 0.0 );
		};
		const std::size_t before = open.size();
		open.clear();
		for ( Eigen::Index row = 0; row < count; ++row )
		{
			isOpen( row ) ? open.push_back( row ) : void();
		}
		if ( isWithin && open.size() == before )
		{
			return;
		}
	}
}

JointGroup::Vector6 JointGroup::jointImpulseOn( const btRigidBody& body ) const
{
	return m_rows.middleCols<6>( 6 * indexOf( &body ) ).transpose() * m_jointImpulses;
}

Eigen::MatrixXd JointGroup::mobilityOf( const std::vector<const btRigidBody*>& some ) const
{
	const Eigen::Index size = 6 * Eigen::Index( some.size() );
	Eigen::MatrixXd mobility( size, size );
	for ( std::size_t a = 0; a < some.size(); ++a )
	{
		for ( std::size_t b = 0; b < some.size(); ++b )
		{
			mobility.block<6, 6>( 6 * Eigen::Index( a ), 6 * Eigen::Index( b ) ) = m_mobility.block<6, 6>(
				6 * indexOf( some[a] ), 6 * indexOf( some[b] ) );
		}
	}
	return mobility;
}

void JointGroup::applyImpulses( const std::vector<Load>& impulses )
{
	Eigen::VectorXd all = Eigen::VectorXd::Zero( m_mobility.rows() );
	for ( const Load& each : impulses )
	{
		all.segment<6>( 6 * indexOf( each.body ) ) += each.impulse;
	}
	const Eigen::VectorXd change = m_mobility * all;
	for ( std::size_t k = 0; k < m_bodies.size(); ++k )
	{
		const Eigen::Matrix<btScalar, 6, 1> own = change.segment<6>( 6 * Eigen::Index( k ) ).cast<btScalar>();
		m_bodies[k]->setLinearVelocity( m_bodies[k]->getLinearVelocity() + btVector3( own[0], own[1], own[2] ) );
		m_bodies[k]->setAngularVelocity( m_bodies[k]->getAngularVelocity() + btVector3( own[3], own[4], own[5] ) );
	}
	if ( m_rows.rows() > 0 )
	{
		m_jointImpulses = m_jointResponse * all;
	}
}

void JointGroup::reportImpulses() const
{
	for ( Eigen::Index row = 0; row < m_jointImpulses.size(); ++row )
	{
		btTypedConstraint& joint = *m_jointOfRow[std::size_t( row )];
		const bool isLast = row + 1 == m_jointImpulses.size() || m_jointOfRow[std::size_t( row ) + 1] != &joint;
		if ( isLast ) // Bullet keeps the impulse of a joint's last row
		{
			joint.internalSetAppliedImpulse( joint.internalGetAppliedImpulse() + btScalar( m_jointImpulses[row] ) );
		}
		if ( std::abs( m_jointImpulses[row] ) >= double( joint.getBreakingImpulseThreshold() ) )
		{
			joint.setEnabled( false );
		}
		btJointFeedback* const feedback = joint.getJointFeedback();
		for ( int side = 0; side < 2 && feedback; ++side )
		{
			const int own = indexOf( side == 0 ? &joint.getRigidBodyA() : &joint.getRigidBodyB() );
			if ( own >= 0 )
			{
				const Eigen::Matrix<btScalar, 6, 1> force = ( m_jointImpulses[row] / m_h * m_rows.block<1, 6>( row, 6 * own ).transpose() )
																.cast<btScalar>();
				( side == 0 ? feedback->m_appliedForceBodyA : feedback->m_appliedForceBodyB ) += btVector3( force[0], force[1], force[2] );
				( side == 0 ? feedback->m_appliedTorqueBodyA : feedback->m_appliedTorqueBodyB ) += btVector3(
					force[3], force[4], force[5] );
			}
		}
	}
}

JointGroup::Vector6 JointGroup::freeVelocityOf( const btRigidBody& body ) const
{
	return m_velocities.segment<6>( 6 * indexOf( &body ) );
}

} // namespace pliant
