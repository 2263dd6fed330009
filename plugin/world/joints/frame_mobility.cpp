// Connection of frames to Bullet's solver: the mobility of their rigid bodies there, and the transfer of impulses to and from their nodes
// (frames.h).

#include "world/bodies/frame_patch.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/joints/frames.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <utility>

namespace pliant {

namespace {

/// B: the velocity change of a node by an impulse and angular impulse about the frame's origin.
Vec3d changeOf( const Frame& frame, const Eigen::Matrix3d& inverseInertia, const Vector6& impulse, const Vec3d& arm )
{
	const Vec3d turn = inverseInertia * ( impulse.tail<3>() - frame.mean.cross( impulse.head<3>() ) );
	return impulse.head<3>() / frame.mass + turn.cross( arm - frame.mean );
}

/// The frame's velocity, B^T v, of a field v( node ).
template <class Velocity>
Vector6 velocityOf( const Frame& frame, const Eigen::Matrix3d& inverseInertia, const Velocity& velocity )
{
	const NodeState& nodes = frame.body->impl().body->nodes();
	Vec3d momentum = Vec3d::Zero(), spin = Vec3d::Zero();
	for ( const Frame::Node& part : frame.patch )
	{
		const Vec3d own = double( nodes.mass[part.node] ) * velocity( part.node );
		momentum += own;
		spin += ( nodes.worldPosition( part.node ) - frame.at - frame.mean ).cross( own );
	}
	Vector6 fit;
	fit.tail<3>() = inverseInertia * spin;
	fit.head<3>() = momentum / frame.mass - fit.tail<3>().cross( frame.mean );
	return fit;
}

/// W of masses alone.
Matrix6 freeMobility( const Frame& frame, const Eigen::Matrix3d& inverseInertia )
{
	Matrix6 mobility;
	const Eigen::Matrix3d arm = crossMatrix( frame.mean );
	mobility.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() / frame.mass - arm * inverseInertia * arm;
	mobility.topRightCorner<3, 3>() = arm * inverseInertia;
	mobility.bottomLeftCorner<3, 3>() = mobility.topRightCorner<3, 3>().transpose();
	mobility.bottomRightCorner<3, 3>() = inverseInertia;
	return mobility;
}

/// Solves for the response of an implicit body to unit impulses, from that of the last substep, and sets W.
void respond( Frame& frame, const Eigen::Matrix3d& inverseInertia, TaskRunner* runner )
{
	Body& core = *frame.body->impl().body;
	const NodeState& nodes = core.nodes();
	const std::size_t padded = std::size_t( nodes.padded ), size = 3 * padded;
	if ( frame.response.size() != 6 * size )
	{
		frame.response.assign( 6 * size, 0.0f );
	}
	AlignedArray<float> impulse, velocity( size );
	for ( int k = 0; k < 6; ++k )
	{
		impulse.assign( size, 0.0f );
		for ( const Frame::Node& part : frame.patch )
		{
			const Vec3d arm = nodes.worldPosition( part.node ) - frame.at;
			const Vec3d own = double( nodes.mass[part.node] * nodes.freedom[part.node] ) *
				changeOf( frame, inverseInertia, Vector6::Unit( k ), arm );
			for ( std::size_t j = 0; j < 3; ++j )
			{
				impulse[j * padded + std::size_t( part.node )] = float( own[int( j )] );
			}
		}
		const auto column = frame.response.begin() + std::ptrdiff_t( std::size_t( k ) * size );
		for ( std::size_t i = 0; i < size; ++i )
		{
			velocity[i] = nodes.freedom[i % padded] * column[std::ptrdiff_t( i )];
		}
		core.respond( impulse.data(), velocity.data(), runner );
		std::copy( velocity.begin(), velocity.end(), column );
		frame.mobility.col( k ) = velocityOf( frame, inverseInertia, [&]( int node ) {
			const std::size_t i = std::size_t( node );
			return Vec3d( double( velocity[i] ), double( velocity[padded + i] ), double( velocity[2 * padded + i] ) );
		} );
	}
	frame.mobility = ( 0.5 * ( frame.mobility + frame.mobility.transpose() ) ).eval();
}

/// Gives the rigid body the least mass and inertia with which no joint moves it less than the patch. Its mass may differ along the world's
/// axes, by its linear factor, and its inertia about its own.
void setMobility( Frame& frame, int framesOfBody )
{
	Matrix6 own = Matrix6::Identity();
	own.bottomRightCorner<3, 3>() = frame.rotation.toRotationMatrix();
	const Matrix6 local = own.transpose() * frame.mobility * own;
	Vector6 diagonal = local.diagonal().cwiseMax( kLeastFrameMobility );
	if ( diagonal.head<3>().minCoeff() > kIsotropicFrame * diagonal.head<3>().maxCoeff() )
	{
		diagonal.head<3>().setConstant( diagonal.head<3>().maxCoeff() ); // with a linear factor Bullet's feedback would be less by it
	}
	const Vector6 scale = diagonal.cwiseSqrt().cwiseInverse();
	const Matrix6 relative = scale.asDiagonal() * local * scale.asDiagonal();
	const Vector6 fractions = Eigen::SelfAdjointEigenSolver<Matrix6>( relative, Eigen::EigenvaluesOnly ).eigenvalues();
	const double excess = double( framesOfBody ) * std::max( 1.0, fractions[5] );
	diagonal *= excess;
	const bool isImplicit = frame.body && frame.body->impl().isImplicit;
	const double learning = kFrameLearning * std::max( fractions[0], kLeastFrameFraction ) / excess;
	frame.learning = isImplicit ? learning : excess < kMostLearntExcess ? 1.0 : 0.0;
	const double largest = diagonal.head<3>().maxCoeff();
	frame.rigid->setMassProps( btScalar( 1.0 / largest ), toBt( diagonal.tail<3>().cwiseInverse() ) );
	frame.rigid->setLinearFactor( toBt( ( diagonal.head<3>() / largest ).cwiseSqrt() ) ); // which Bullet's solver applies twice
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

/// 1/kg along the world's axes, as Bullet's solver has it.
Vec3d linearMobility( const btRigidBody& rigid )
{
	const Vec3d factor = toVec3d( rigid.getLinearFactor() );
	return double( rigid.getInvMass() ) * factor.cwiseProduct( factor );
}

/// D^-1.
Vector6 impulseFor( const btRigidBody& rigid, const Vector6& change )
{
	Vector6 impulse;
	impulse.head<3>() = change.head<3>().cwiseQuotient( linearMobility( rigid ) );
	impulse.tail<3>() = toMatrix3d( rigid.getInvInertiaTensorWorld() ).inverse() * change.tail<3>();
	return impulse;
}

Vector6 velocityFor( const btRigidBody& rigid, const Vector6& impulse )
{
	Vector6 change;
	change.head<3>() = impulse.head<3>().cwiseProduct( linearMobility( rigid ) );
	change.tail<3>() = toMatrix3d( rigid.getInvInertiaTensorWorld() ) * impulse.tail<3>();
	return change;
}

/// Adds the response of an implicit body to an impulse and angular impulse on the frame. The iteration is truncated: a rigid motion of each
/// connected part restores its momentum.
void addResponse( Frame& frame, const Eigen::Matrix3d& inverseInertia, const Vector6& impulse )
{
	NodeState& nodes = nodesOf( *frame.body );
	ImplicitMotion& motion = *frame.body->impl().body->implicit();
	const std::size_t padded = std::size_t( nodes.padded );
	const ConnectedParts& parts = motion.parts();
	std::vector<Vector6> missing( std::size_t( parts.count() ), Vector6::Zero() );
	const auto add = [&]( int node, const Vec3d& change ) {
		const int part = parts.partOf( node );
		const Vec3d own = double( nodes.mass[node] * nodes.freedom[node] ) * change;
		missing[std::size_t( part )].head<3>() += own;
		missing[std::size_t( part )].tail<3>() += ( nodes.x.get( node ).cast<double>() - motion.centre( part ) ).cross( own );
	};
	for ( const Frame::Node& part : frame.patch )
	{
		add( part.node, changeOf( frame, inverseInertia, impulse, nodes.worldPosition( part.node ) - frame.at ) );
	}
	for ( int i = 0; i < nodes.count; ++i )
	{
		Vec3d change = Vec3d::Zero();
		for ( std::size_t k = 0; k < 6; ++k )
		{
			const float* const column = frame.response.data() + 3 * padded * k + std::size_t( i );
			change += impulse[int( k )] * Vec3d( double( column[0] ), double( column[padded] ), double( column[2 * padded] ) );
		}
		add( i, -change );
		nodes.v.set( i, nodes.v.get( i ) + change.cast<float>() );
	}
	for ( int part = 0; part < parts.count(); ++part )
	{
		if ( !motion.isHeld( part ) )
		{
			motion.addMotion( motion.rigidMotion( missing[std::size_t( part )], part ), part );
		}
	}
}

} // namespace

void setFreeMobility( Frame& frame )
{
	frame.mobility = freeMobility( frame, frame.inertia.inverse() );
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
			const double learning = frame.learning;
			setMobility( frame, frame.body->impl().isImplicit ? int( count ) : 1 );
			frame.learning = learning;
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
			const Vec3d change = changeOf( frame, inverseInertia, frame.force, nodes.worldPosition( part.node ) - frame.at );
			const Vec3d own = ( isOn ? 1.0 : -1.0 ) * double( nodes.mass[part.node] ) * change;
			nodes.force.set( part.node, nodes.force.get( part.node ) + own.cast<float>() );
		}
	} );
}

void Frames::before( SoftBody& body, double h, TaskRunner* runner )
{
	int count = 0;
	forFramesOf( body, [&count]( const Frame& ) { ++count; } );
	forFramesOf( body, [&]( Frame& frame ) {
		const NodeState& nodes = nodesOf( *frame.body );
		const Eigen::Matrix3d inverseInertia = frame.inertia.inverse();
		if ( body.impl().isImplicit )
		{
			respond( frame, inverseInertia, runner );
		}
		else
		{
			frame.mobility = freeMobility( frame, inverseInertia );
		}
		// The masses of several frames of an explicit body are their own; an implicit body's frames move one another.
		setMobility( frame, body.impl().isImplicit ? count : 1 );
		frame.given = velocityOf( frame, inverseInertia, [&]( int node ) { return Vec3d( nodes.v.get( node ).cast<double>() ); } ) -
			velocityFor( *frame.rigid, h * frame.force );
		setVelocity( *frame.rigid, frame.given );
		frame.given = velocityOf( *frame.rigid ); // in Bullet's precision
		frame.isSolved = true;
	} );
}

void Frames::hold( const SoftBody& body )
{
	forFramesOf( body, []( Frame& frame ) {
		const NodeState& nodes = nodesOf( *frame.body );
		frame.mobility.setZero();
		setMobility( frame, 1 );
		setVelocity( *frame.rigid,
			velocityOf( frame, frame.inertia.inverse(), [&]( int node ) { return Vec3d( nodes.v.get( node ).cast<double>() ); } ) );
	} );
}

void Frames::after( SoftBody& body, double h )
{
	forFramesOf( body, [&]( Frame& frame ) {
		if ( !std::exchange( frame.isSolved, false ) )
		{
			return;
		}
		const Vector6 impulse = impulseFor( *frame.rigid, velocityOf( *frame.rigid ) - frame.given );
		const Vector6 change = impulse - h * frame.force;
		frame.force += frame.learning * ( impulse / h - frame.force );
		const Eigen::Matrix3d inverseInertia = frame.inertia.inverse();
		NodeState& nodes = nodesOf( body );
		if ( body.impl().isImplicit )
		{
			addResponse( frame, inverseInertia, change );
		}
		for ( const Frame::Node& part : frame.patch )
		{
			const Vec3d own = changeOf( frame, inverseInertia, change, nodes.worldPosition( part.node ) - frame.at );
			const float moves = body.impl().isImplicit ? 0.0f : nodes.freedom[part.node];
			nodes.v.set( part.node, nodes.v.get( part.node ) + moves * own.cast<float>() );
		}
		setVelocity(
			*frame.rigid, velocityOf( frame, inverseInertia, [&]( int node ) { return Vec3d( nodes.v.get( node ).cast<double>() ); } ) );
	} );
}

} // namespace pliant
