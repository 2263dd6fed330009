#include "world/joints/frames.h"

#include "matching/rotation.h"
#include "world/bodies/frame_patch.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"

#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <utility>

namespace pliant {

namespace {

Vec3d positionOf( const SoftBody& body, int node )
{
	return body.impl().body->nodes().worldPosition( node );
}

/// Measures mass, centre and inertia of a patch at its nodes' present positions.
void measure( Frame& frame )
{
	const NodeState& nodes = nodesOf( *frame.body );
	frame.mass = 0.0;
	Vec3d moment = Vec3d::Zero();
	for ( const Frame::Node& part : frame.patch )
	{
		frame.mass += double( nodes.mass[part.node] );
		moment += double( nodes.mass[part.node] ) * ( nodes.worldPosition( part.node ) - frame.at );
	}
	frame.mean = moment / frame.mass;
	frame.inertia.setZero();
	for ( const Frame::Node& part : frame.patch )
	{
		const Eigen::Matrix3d cross = crossMatrix( nodes.worldPosition( part.node ) - frame.at - frame.mean );
		frame.inertia -= double( nodes.mass[part.node] ) * cross * cross;
	}
}

/// Whether the nodes lie so far from a line that they define a rotation.
bool spans( const Frame& frame )
{
	const Eigen::Vector3d moments = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>( frame.inertia, Eigen::EigenvaluesOnly ).eigenvalues();
	return moments[0] > kLeastFrameInertia * moments[2];
}

/// Adds nodes of the body to a patch: all within the frame's radius, and the nearest others until they define a rotation. Returns false if
/// the body has too few.
bool fillPatch( Frame& frame, bool takesAllInside )
{
	const int count = frame.body->nodeCount();
	const Vec3d middle = frame.at + frame.rotation * frame.middle;
	std::vector<std::pair<double, int>> near;
	for ( int node = 0; node < count; ++node )
	{
		near.emplace_back( ( positionOf( *frame.body, node ) - middle ).norm(), node );
	}
	std::sort( near.begin(), near.end() );
	const auto has = [&frame]( int node ) {
		return std::any_of( frame.patch.begin(), frame.patch.end(), [node]( const Frame::Node& part ) { return part.node == node; } );
	};
	const auto isEnough = [&frame] {
		if ( frame.patch.size() < 3 )
		{
			return false;
		}
		measure( frame );
		return spans( frame );
	};
	for ( const auto& [distance, node] : near )
	{
		if ( !( takesAllInside && distance <= frame.radius ) && isEnough() )
		{
			return true;
		}
		if ( !has( node ) )
		{
			const Vec3d rest = frame.rotation.conjugate() * ( positionOf( *frame.body, node ) - frame.at );
			frame.patch.push_back( Frame::Node{ node, rest } );
		}
	}
	return isEnough();
}

/// A point and axes through which impulses and angular impulses move the frame with as little coupling as a rigid body's: those of the
/// patch's mass, for a body that is so stiff in the implicit step that all of it follows, of the body's.
struct Middle
{
	Vec3d at = Vec3d::Zero();
	Eigen::Quaterniond axes = Eigen::Quaterniond::Identity();
};

Middle middleOf( const Frame& patch )
{
	const SoftBody& body = *patch.body;
	const Material& material = body.material();
	Frame whole;
	whole.body = patch.body;
	for ( int node = 0; node < body.nodeCount(); ++node )
	{
		whole.patch.push_back( Frame::Node{ node, Vec3d::Zero() } );
	}
	measure( whole );
	double follows = 0.0; // how much of the body follows in a step
	if ( material.elasticity != Elasticity::Explicit && body.impl().body->canStepImplicitly() )
	{
		// A step's impulse spreads over a length of h sqrt( E / rho ).
		const double step = double( kNominalStep ), spread = step * step * double( material.youngsModulus / material.density );
		follows = spread / ( spread + whole.inertia.trace() / whole.mass );
	}
	const Frame& nearer = follows > 0.5 ? whole : patch;
	Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>( nearer.inertia ).eigenvectors();
	axes.col( 2 ) = axes.col( 0 ).cross( axes.col( 1 ) );
	return Middle{
		patch.at + patch.mean + kFrameInward * follows * ( whole.at + whole.mean - patch.at - patch.mean ), Eigen::Quaterniond( axes ) };
}

/// Makes the rigid body an ordinary one of the patch's mass: its soft body has left.
void release( Frame& frame, const btDiscreteDynamicsWorld& world )
{
	frame.body = nullptr;
	frame.patch.clear();
	frame.rigid->setFlags( 0 );
	frame.rigid->setGravity( world.getGravity() );
	const double size = std::max( frame.radius, 1e-3 );
	const btScalar moment = btScalar( 0.4 * frame.mass * size * size );
	frame.rigid->setMassProps( btScalar( frame.mass ), btVector3( moment, moment, moment ) );
	frame.rigid->updateInertiaTensor();
	frame.rigid->activate( true );
}

} // namespace

Frame::Frame() = default;
Frame::Frame( Frame&& ) noexcept = default;
Frame& Frame::operator=( Frame&& ) noexcept = default;
Frame::~Frame() = default;

const Frame* Frames::find( const btRigidBody& rigid ) const
{
	const auto found = std::find_if(
		m_frames.begin(), m_frames.end(), [&rigid]( const Frame& frame ) { return frame.rigid.get() == &rigid; } );
	return found == m_frames.end() ? nullptr : &*found;
}

bool Frames::has( const SoftBody& body ) const
{
	return std::any_of( m_frames.begin(), m_frames.end(), [&body]( const Frame& frame ) { return frame.body == &body; } );
}

const std::vector<const btCollisionObject*>& Frames::partners( const btAlignedObjectArray<btTypedConstraint*>& joints )
{
	m_partners.clear();
	for ( int k = 0; !m_frames.empty() && k < joints.size(); ++k )
	{
		const btRigidBody &a = joints[k]->getRigidBodyA(), &b = joints[k]->getRigidBodyB();
		const bool isA = find( a ), isB = find( b );
		if ( isA != isB && ( isA ? b : a ).getWorldArrayIndex() >= 0 )
		{
			m_partners.push_back( isA ? &b : &a );
		}
	}
	return m_partners;
}

void Frame::copyState( const Frame& from )
{
	radius = from.radius;
	middle = from.middle;
	patch = from.patch;
	at = from.at;
	rotation = from.rotation;
	mean = from.mean;
	mass = from.mass;
	inertia = from.inertia;
	force = from.force;
	unseen = from.unseen;
	mobility = from.mobility;
}

void Frames::restore(
	std::size_t number, const btRigidBody& rigid, const Frame& state, SoftBody* body, const btDiscreteDynamicsWorld& world )
{
	const auto found = std::find_if(
		m_frames.begin(), m_frames.end(), [&rigid]( const Frame& frame ) { return frame.rigid.get() == &rigid; } );
	std::swap( m_frames[number], *found );
	Frame& frame = m_frames[number];
	frame.copyState( state );
	frame.body = body;
	frame.isSolved = false;
	if ( !body )
	{
		release( frame, world );
		return;
	}
	frame.rigid->setFlags( BT_DISABLE_WORLD_GRAVITY );
	frame.rigid->setGravity( btVector3( 0, 0, 0 ) );
}

btRigidBody* Frames::add( btDiscreteDynamicsWorld& world, SoftBody& body, const Vec3d& at, double radius )
{
	Frame frame;
	frame.body = &body;
	double farthest = 0.0;
	for ( int node = 0; node < body.nodeCount(); ++node )
	{
		farthest = std::max( farthest, ( positionOf( body, node ) - at ).norm() );
	}
	frame.radius = std::min( radius, kFarthestOfFrame * farthest ); // the rigid body of a huge one would be out of Bullet's range
	frame.at = at;
	for ( int node = 0; node < body.nodeCount(); ++node )
	{
		if ( ( positionOf( body, node ) - at ).norm() <= radius )
		{
			frame.patch.push_back( Frame::Node{ node, Vec3d::Zero() } );
		}
	}
	if ( frame.patch.size() < 3 )
	{
		return nullptr;
	}
	measure( frame );
	if ( !spans( frame ) )
	{
		return nullptr;
	}
	const Middle middle = middleOf( frame );
	frame.at = middle.at;
	frame.rotation = middle.axes.normalized();
	frame.middle = frame.rotation.conjugate() * ( at - frame.at );
	for ( Frame::Node& part : frame.patch )
	{
		part.rest = frame.rotation.conjugate() * ( positionOf( body, part.node ) - frame.at );
	}
	measure( frame );
	frame.shape = std::make_unique<btSphereShape>( btScalar( frame.radius ) );
	btRigidBody::btRigidBodyConstructionInfo info( btScalar( frame.mass ), nullptr, frame.shape.get(), btVector3( 1, 1, 1 ) );
	info.m_startWorldTransform = toBt( frame.rotation, frame.at );
	frame.rigid = std::make_unique<btRigidBody>( info );
	frame.rigid->setFlags( BT_DISABLE_WORLD_GRAVITY );
	world.addRigidBody( frame.rigid.get(), 0, 0 ); // in no pair; without contact response it would be in no island
	frame.rigidIndex = frame.rigid->getWorldArrayIndex();
	setFreeMobility( frame );
	m_frames.push_back( std::move( frame ) );
	return m_frames.back().rigid.get();
}

bool Frames::remove( btDiscreteDynamicsWorld& world, const btRigidBody& rigid )
{
	const Frame* const found = find( rigid );
	if ( !found )
	{
		return false;
	}
	for ( int k = world.getNumConstraints(); k-- > 0; )
	{
		btTypedConstraint* const joint = world.getConstraint( k );
		if ( &joint->getRigidBodyA() == &rigid || &joint->getRigidBodyB() == &rigid )
		{
			joint->getRigidBodyA().activate( true );
			joint->getRigidBodyB().activate( true );
			world.removeConstraint( joint );
		}
	}
	if ( found->isInWorld )
	{
		world.removeRigidBody( found->rigid.get() );
	}
	m_frames.erase( m_frames.begin() + ( found - m_frames.data() ) );
	return true;
}

void Frames::removeAll( btDiscreteDynamicsWorld& world )
{
	// The game may have deleted its joints before its world, which Bullet's own destructor allows.
	for ( const Frame& frame : m_frames )
	{
		if ( frame.isInWorld )
		{
			world.removeRigidBody( frame.rigid.get() );
		}
	}
	m_frames.clear();
}

void Frames::forget( const btCollisionObject& object, const btDiscreteDynamicsWorld& world )
{
	for ( Frame& frame : m_frames )
	{
		if ( frame.rigid.get() == &object )
		{
			frame.isInWorld = false;
			frame.body = nullptr;
		}
		else if ( frame.body && static_cast<const btCollisionObject*>( frame.body ) == &object )
		{
			release( frame, world );
		}
	}
}

// The rotation that fits the patch best; where its nodes leave it open, that of the last substep.
void Frames::place( const SoftBody& body )
{
	forFramesOf( body, []( Frame& frame ) {
		const NodeState& nodes = nodesOf( *frame.body );
		double mass = 0.0;
		Vec3d centre = Vec3d::Zero(), restCentre = Vec3d::Zero();
		for ( const Frame::Node& part : frame.patch )
		{
			mass += double( nodes.mass[part.node] );
			centre += double( nodes.mass[part.node] ) * nodes.worldPosition( part.node );
			restCentre += double( nodes.mass[part.node] ) * part.rest;
		}
		centre /= mass;
		restCentre /= mass;
		Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
		for ( const Frame::Node& part : frame.patch )
		{
			spread += double( nodes.mass[part.node] ) * ( nodes.worldPosition( part.node ) - centre ) *
				( part.rest - restCentre ).transpose();
		}
		frame.rotation = fitRotation( spread, frame.rotation ).normalized();
		frame.at = centre - frame.rotation * restCentre;
		measure( frame );
		frame.rigid->setCenterOfMassTransform( toBt( frame.rotation, frame.at ) );
	} );
}

void Frames::follow( const SoftBody& body, const btDiscreteDynamicsWorld& world )
{
	forFramesOf( body, [&world]( Frame& frame ) {
		frame.patch.clear();
		if ( !fillPatch( frame, true ) )
		{
			release( frame, world );
		}
	} );
}

void Frames::claim( const SoftBody& parent, SoftBody& piece, const std::vector<std::uint32_t>& nodeNow )
{
	forFramesOf( parent, [&]( Frame& frame ) {
		std::vector<Frame::Node> patch;
		for ( const Frame::Node& part : frame.patch )
		{
			const std::uint32_t now = nodeNow[std::size_t( part.node )];
			if ( now != kNoNode )
			{
				patch.push_back( Frame::Node{ int( now ), part.rest } );
			}
		}
		if ( patch.size() > frame.claimedPatch.size() )
		{
			frame.claimant = &piece;
			frame.claimedPatch = std::move( patch );
		}
	} );
}

void Frames::settle( const SoftBody& parent, const btDiscreteDynamicsWorld& world )
{
	forFramesOf( parent, [&world]( Frame& frame ) {
		frame.body = std::exchange( frame.claimant, nullptr );
		frame.patch = std::exchange( frame.claimedPatch, {} );
		if ( !frame.body || !fillPatch( frame, false ) )
		{
			release( frame, world );
		}
	} );
}

} // namespace pliant
