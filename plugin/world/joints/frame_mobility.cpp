// Connection of frames to Bullet's solver: the mobility of their rigid bodies there, and the transfer of impulses to and from their nodes
// (frames.h).

#include "world/bodies/frame_patch.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/joints/frames.h"

#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>
#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <utility>

namespace pliant {

namespace {

/// Gives the rigid body the least mass, and inertia about its own axes, with which no joint moves it less than the patch.
void setMobility( Frame& frame, int framesOfBody )
{
	Matrix6 own = Matrix6::Identity();
	own.bottomRightCorner<3, 3>() = frame.rotation.toRotationMatrix();
	const Matrix6 local = own.transpose() * frame.mobility * own;
	Vector6 diagonal = local.diagonal().cwiseMax( kLeastFrameMobility );
	diagonal.head<3>().setConstant( diagonal.head<3>().maxCoeff() );
	const Vector6 scale = diagonal.cwiseSqrt().cwiseInverse();
	const Matrix6 relative = scale.asDiagonal() * local * scale.asDiagonal();
	const Vector6 fractions = Eigen::SelfAdjointEigenSolver<Matrix6>( relative, Eigen::EigenvaluesOnly ).eigenvalues();
	const double excess = double( framesOfBody ) * std::max( 1.0, fractions[5] );
	diagonal *= excess;
	frame.rigid->setMassProps( btScalar( 1.0 / diagonal[0] ), toBt( diagonal.tail<3>().cwiseInverse() ) );
	frame.rigid->updateInertiaTensor();
}

void setVelocity( btRigidBody& rigid, const Vector6& velocity )
{
	rigid.setLinearVelocity( toBt( velocity.head<3>() ) );
	rigid.setAngularVelocity( toBt( velocity.tail<3>() ) );
}

Vector6 velocityOf( const btRigidBody& rigid )
{
	Vector6 velocity;
	velocity << toVec3d( rigid.getLinearVelocity() ), toVec3d( rigid.getAngularVelocity() );
	return velocity;
}

/// D^-1.
Vector6 impulseFor( const btRigidBody& rigid, const Vector6& change )
{
	Vector6 impulse;
	impulse.head<3>() = change.head<3>() / double( rigid.getInvMass() );
	impulse.tail<3>() = toMatrix3d( rigid.getInvInertiaTensorWorld() ).inverse() * change.tail<3>();
	return impulse;
}

Vector6 velocityFor( const btRigidBody& rigid, const Vector6& impulse )
{
	Vector6 change;
	change.head<3>() = impulse.head<3>() * double( rigid.getInvMass() );
	change.tail<3>() = toMatrix3d( rigid.getInvInertiaTensorWorld() ) * impulse.tail<3>();
	return change;
}

} // namespace

void setFreeMobility( Frame& frame )
{
	frame.mobility = freeMobility( frame );
	setMobility( frame, 1 );
}

void Frames::restoreMobilities()
{
	for ( Frame& frame : m_frames )
	{
		if ( frame.body )
		{
			const auto count = std::count_if(
				m_frames.begin(), m_frames.end(), [&frame]( const Frame& other ) { return other.body == frame.body; } );
			setMobility( frame, frame.body->impl().isImplicit ? int( count ) : 1 );
		}
	}
}

void Frames::press( SoftBody& body, bool isOn )
{
	forFramesOf( body, [isOn]( Frame& frame ) {
		NodeState& nodes = nodesOf( *frame.body );
		if ( nodes.force.x.empty() )
		{
			nodes.force.resize( nodes.padded );
		}
		const Eigen::Matrix3d inverseInertia = frame.inertia.inverse();
		for ( const Frame::Node& part : frame.patch )
		{
			const Vec3d change = velocityChange( frame, inverseInertia, frame.force, nodes.worldPosition( part.node ) - frame.at );
			const Vec3d own = ( isOn ? 1.0 : -1.0 ) * double( nodes.mass[part.node] ) * change;
			nodes.force.set( part.node, nodes.force.get( part.node ) + own.cast<float>() );
		}
	} );
}

void Frames::measureMobility( SoftBody& body, const Response& response, TaskRunner* runner )
{
	std::vector<Frame*> frames;
	forFramesOf( body, [&frames]( Frame& frame ) { frames.push_back( &frame ); } );
	if ( body.impl().isImplicit )
	{
		measureResponses( frames, response, runner );
	}
	for ( Frame* const frame : frames )
	{
		const Matrix6 mobility = mobilityBetween( *frame, *frame );
		frame->mobility = 0.5 * ( mobility + mobility.transpose() );
		// The masses of several frames of an explicit body are their own; an implicit body's frames move one another.
		setMobility( *frame, body.impl().isImplicit ? int( frames.size() ) : 1 );
		frame->isSolved = true;
	}
}

std::vector<JointGroup::Compliant> Frames::coupledPatches( double h ) const
{
	std::vector<JointGroup::Compliant> all;
	std::vector<std::vector<const Frame*>> framesOf;
	for ( const Frame& frame : m_frames )
	{
		if ( !frame.isSolved )
		{
			continue;
		}
		const auto same = std::find_if(
			framesOf.begin(), framesOf.end(), [&frame]( const auto& others ) { return others.front()->body == frame.body; } );
		same == framesOf.end() ? framesOf.push_back( { &frame } ) : same->push_back( &frame );
	}
	for ( const std::vector<const Frame*>& frames : framesOf )
	{
		JointGroup::Compliant& patches = all.emplace_back();
		const Eigen::Index size = 6 * Eigen::Index( frames.size() );
		patches.mobility = Eigen::MatrixXd::Zero( size, size );
		patches.velocities.resize( size );
		Eigen::VectorXd known( size ); // beyond the solved rows, less what acts on the patches already, N and N m
		for ( std::size_t a = 0; a < frames.size(); ++a )
		{
			const Eigen::Index at = 6 * Eigen::Index( a );
			patches.bodies.push_back( frames[a]->rigid.get() );
			patches.velocities.segment<6>( at ) = velocityOfPatch( *frames[a] );
			known.segment<6>( at ) = frames[a]->unseen - frames[a]->force;
			for ( std::size_t b = 0; b < frames.size(); ++b )
			{
				patches.mobility.block<6, 6>( at, 6 * Eigen::Index( b ) ) = a == b ? frames[a]->mobility
																				   : mobilityBetween( *frames[a], *frames[b] );
			}
		}
		patches.mobility = ( 0.5 * ( patches.mobility + patches.mobility.transpose() ) ).eval();
		patches.velocities += h * patches.mobility * known;
	}
	return all;
}

void Frames::solve(
	const btAlignedObjectArray<btTypedConstraint*>& joints, const std::vector<unsigned char>& touches, const btContactSolverInfo& info )
{
	const double h = double( info.m_timeStep );
	const std::vector<JointGroup::Compliant> patches = coupledPatches( h );
	std::vector<char> isDone( m_frames.size() );
	for ( std::size_t k = 0; k < m_frames.size(); ++k )
	{
		JointGroup group;
		if ( !m_frames[k].isSolved || isDone[k] || !group.collectCompliant( *m_frames[k].rigid, joints, patches, touches, info ) )
		{
			continue;
		}
		for ( std::size_t other = k; other < m_frames.size(); ++other )
		{
			if ( m_frames[other].isSolved && group.contains( *m_frames[other].rigid ) )
			{
				isDone[other] = 1;
				m_frames[other].impulse = group.jointImpulseOn( *m_frames[other].rigid );
			}
		}
	}
	for ( Frame& frame : m_frames )
	{
		if ( frame.isSolved )
		{
			frame.impulse += h * frame.unseen;
			applyImpulse( frame, frame.impulse - h * frame.force );
		}
	}
}

void Frames::raiseIterations( const btAlignedObjectArray<btTypedConstraint*>& joints, const btContactSolverInfo& info )
{
	const auto isSolved = [this]( const btRigidBody& body ) {
		const Frame* const frame = find( body );
		return frame && frame->isSolved;
	};
	for ( int k = 0; k < joints.size(); ++k )
	{
		btTypedConstraint& joint = *joints[k];
		if ( joint.getOverrideNumSolverIterations() < 0 && ( isSolved( joint.getRigidBodyA() ) || isSolved( joint.getRigidBodyB() ) ) )
		{
			joint.setOverrideNumSolverIterations( std::max( kFrameIterations, info.m_numIterations ) );
			m_raised.push_back( &joint );
		}
	}
}

void Frames::give()
{
	for ( Frame& frame : m_frames )
	{
		if ( frame.isSolved )
		{
			setVelocity( *frame.rigid, velocityOfPatch( frame ) - velocityFor( *frame.rigid, frame.impulse ) );
			frame.given = velocityOf( *frame.rigid ); // in Bullet's precision
		}
	}
}

void Frames::hold( const SoftBody& body )
{
	forFramesOf( body, []( Frame& frame ) {
		frame.mobility.setZero();
		setMobility( frame, 1 );
		setVelocity( *frame.rigid, velocityOfPatch( frame ) );
	} );
}

void Frames::restoreIterations( const btAlignedObjectArray<btTypedConstraint*>& joints )
{
	for ( btTypedConstraint* const joint : m_raised )
	{
		if ( joints.findLinearSearch( joint ) < joints.size() )
		{
			joint->setOverrideNumSolverIterations( -1 ); // Bullet's default: as many as the world's
		}
	}
	m_raised.clear();
}

void Frames::begin( const btAlignedObjectArray<btTypedConstraint*>& joints )
{
	restoreIterations( joints );
	for ( Frame& frame : m_frames )
	{
		frame.isSolved = false;
		frame.impulse.setZero();
	}
}

void Frames::after( SoftBody& body, double h )
{
	forFramesOf( body, [&]( Frame& frame ) {
		if ( std::exchange( frame.isSolved, false ) )
		{
			const Vector6 impulse = impulseFor( *frame.rigid, velocityOf( *frame.rigid ) - frame.given );
			applyImpulse( frame, impulse - frame.impulse );
			frame.unseen += kFrameLearning / h * impulseFor( *frame.rigid, frame.mobility * ( impulse - frame.impulse ) );
			frame.force += kFrameLearning * ( impulse / h - frame.force );
			setVelocity( *frame.rigid, velocityOfPatch( frame ) );
		}
	} );
}

} // namespace pliant
