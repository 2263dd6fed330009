#include "world/game/force_fields.h"

#include "world/bodies/soft_body_impl.h"

#include <BulletDynamics/Dynamics/btDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cmath>

namespace pliant {

ForceFields::~ForceFields()
{
	for ( ForceField* field : m_fields )
	{
		field->m_owner = nullptr;
	}
}

bool ForceFields::add( ForceField& field )
{
	if ( field.m_owner )
	{
		return false;
	}
	field.m_owner = this;
	m_fields.push_back( &field );
	wake( field );
	return true;
}

bool ForceFields::remove( ForceField& field )
{
	if ( field.m_owner != this )
	{
		return false;
	}
	wake( field );
	leave( field );
	return true;
}

void ForceFields::leave( ForceField& field )
{
	field.m_owner = nullptr;
	std::erase( m_fields, &field );
}

void ForceFields::wake( const ForceField& field )
{
	const btCollisionObjectArray& objects = m_world.getCollisionObjectArray();
	const Acting acting( *this );
	for ( int k = 0; k < objects.size(); ++k )
	{
		btCollisionObject& object = *objects[k];
		const bool isRigid = btRigidBody::upcast( &object ) && ( field.m_kinds & ForceField::kAcceleration ) != 0;
		if ( ( isRigid || asSoftBody( &object ) ) && !object.isStaticOrKinematicObject() && field.actsOn( object ) )
		{
			object.activate();
		}
	}
}

void ForceFields::forget( const btRigidBody& body )
{
	std::erase_if( m_given, [&body]( const Given& given ) { return given.body == &body; } );
}

btVector3 ForceFields::accelerationAt( const btCollisionObject& object, const btVector3& position ) const
{
	btVector3 sum( 0, 0, 0 );
	for ( const ForceField* field : m_fields )
	{
		if ( ( field->m_kinds & ForceField::kAcceleration ) != 0 && field->actsOn( object ) )
		{
			sum += field->acceleration( position );
		}
	}
	return sum;
}

// Bullet keeps forces until the end of stepSimulation: in a further step of it only the difference is added.
void ForceFields::pushRigid()
{
	if ( m_fields.empty() && m_given.empty() )
	{
		return;
	}
	for ( const Given& given : m_given )
	{
		given.body->applyCentralForce( -given.force );
	}
	m_given.clear();
	const btCollisionObjectArray& objects = m_world.getCollisionObjectArray();
	const Acting acting( *this );
	for ( int k = 0; k < objects.size() && !m_fields.empty(); ++k )
	{
		btRigidBody* const body = btRigidBody::upcast( objects[k] );
		if ( !body || body->isStaticOrKinematicObject() || !body->isActive() || ( body->getFlags() & BT_DISABLE_WORLD_GRAVITY ) != 0 )
		{
			continue;
		}
		const btVector3 force = accelerationAt( *body, body->getCenterOfMassPosition() ) / body->getInvMass();
		if ( !force.isZero() && isFinite( force ) ) // values that a game's field returns
		{
			body->applyCentralForce( force );
			m_given.push_back( Given{ body, force } );
		}
	}
}

void ForceFields::push( SoftBody& body, const btVector3& gravity, double h ) const
{
	SoftBody::Impl& impl = body.impl();
	NodeState& nodes = impl.body->nodes();
	const bool hasGas = impl.forces && impl.forces->gas.law != GasLaw::None;
	int kinds = 0;
	for ( const ForceField* field : m_fields )
	{
		kinds |= field->actsOn( body ) ? field->m_kinds : 0;
	}
	if ( kinds == 0 && !hasGas )
	{
		impl.body->fieldForce() = Vec3Array{};
		impl.fieldAcceleration.setZero();
		return;
	}
	Vec3Array& to = impl.body->fieldForce();
	to.resize( nodes.padded );
	btVector3 total( 0, 0, 0 );
	for ( int i = 0; i < nodes.count && ( kinds & ( ForceField::kAcceleration | ForceField::kVolumeForce ) ) != 0; ++i )
	{
		const btVector3 position = impl.position( i ), acceleration = accelerationAt( body, position );
		btVector3 force = acceleration * btScalar( nodes.mass[i] );
		total += force;
		if ( ( kinds & ForceField::kVolumeForce ) != 0 )
		{
			const double size = double( body.bodyTemplate().cellSize() ) * std::exp2( double( body.nodeLevel( i ) ) );
			force += volumeForceAt( body,
				VolumePoint{ position, gravity + acceleration, btScalar( nodes.mass[i] / body.material().density ), btScalar( size ) } );
		}
		to.set( i, toVec3( force ) );
	}
	impl.fieldAcceleration = total / btScalar( impl.mass );
	if ( hasGas || ( kinds & ( ForceField::kSurfaceForce | ForceField::kVolumeForce ) ) != 0 )
	{
		pushSurface( body, gravity, h, kinds );
	}
}

btVector3 ForceFields::volumeForceAt( const SoftBody& body, const VolumePoint& point ) const
{
	btVector3 sum( 0, 0, 0 );
	for ( const ForceField* field : m_fields )
	{
		if ( ( field->m_kinds & ForceField::kVolumeForce ) != 0 && field->actsOn( body ) )
		{
			sum += field->volumeForce( point );
		}
	}
	return sum;
}

// A cavity displaces fluid by its volume; the force acts on its wall.
void ForceFields::pushCavities( const SoftBody& body, const btVector3& gravity, SurfaceForces& forces ) const
{
	const Body& core = *body.impl().body;
	const BodyBoundary& boundary = forces.boundary;
	for ( int surface = 0; surface < boundary.cells().surfaceCount(); ++surface )
	{
		if ( boundary.cells().restVolume[std::size_t( surface )] >= 0.0 )
		{
			continue;
		}
		const auto isWall = [&]( int p ) { return boundary.cells().surface[std::size_t( p )] == std::uint32_t( surface ); };
		double area = 0.0;
		Vec3d centre = Vec3d::Zero();
		for ( int p = 0; p < boundary.count(); ++p )
		{
			const double part = isWall( p ) ? boundary.area( p ).norm() : 0.0;
			area += part;
			centre += part * boundary.position( p );
		}
		const double volume = std::max( -boundary.volume( surface ), 0.0 );
		const btVector3 position = toBt( core.nodes().origin + centre / area );
		const Vec3d force = toVec3d( volumeForceAt( body,
			VolumePoint{ position, gravity + accelerationAt( body, position ), btScalar( volume ), btScalar( std::cbrt( volume ) ) } ) );
		for ( int p = 0; p < boundary.count(); ++p )
		{
			if ( isWall( p ) )
			{
				forces.add( core, p, force * ( boundary.area( p ).norm() / area ) );
			}
		}
	}
}

void SurfaceForces::begin( const Body& body )
{
	nodeForce.assign( std::size_t( body.nodeCount() ), Vec3d::Zero() );
	m_missing = Vec3d::Zero();
}

// Forces on points go to the nodes that carry them. The nodes' torque about the mass centre then lacks that of the points' distances from
// the nodes, which is added to the body as a whole.
void SurfaceForces::add( const Body& body, int point, const Vec3d& force )
{
	boundary.forNodes( body, point, [&]( int node, double fraction ) {
		nodeForce[std::size_t( node )] += fraction * force;
		m_missing += fraction * ( boundary.position( point ) - body.nodes().x.get( node ).cast<double>() ).cross( force );
	} );
}

void SurfaceForces::finish( const Body& body )
{
	m_centre = body.sums().centre;
	m_turn = body.angularVelocityOf( m_missing );
}

Vec3d SurfaceForces::forceOn( const Body& body, int node ) const
{
	const Vec3d arm = body.nodes().x.get( node ).cast<double>() - m_centre;
	return nodeForce[std::size_t( node )] + double( body.nodes().mass[node] ) * m_turn.cross( arm );
}

void ForceFields::pushSurface( SoftBody& body, const btVector3& gravity, double h, int kinds ) const
{
	SoftBody::Impl& impl = body.impl();
	const Body& core = *impl.body;
	const NodeState& nodes = core.nodes();
	if ( !impl.forces )
	{
		impl.forces = std::make_unique<SurfaceForces>();
	}
	SurfaceForces& forces = *impl.forces;
	BodyBoundary& boundary = forces.boundary;
	boundary.update( core, impl.fractureVersion );
	forces.begin( core );
	for ( int p = 0; p < boundary.count() && ( kinds & ForceField::kSurfaceForce ) != 0; ++p )
	{
		// A cavity is out of the wind.
		if ( boundary.cells().restVolume[boundary.cells().surface[std::size_t( p )]] < 0.0 )
		{
			continue;
		}
		SurfacePoint at;
		at.position = toBt( nodes.origin + boundary.position( p ) );
		at.velocity = toBt( boundary.velocity( core, p ) );
		at.area = toBt( boundary.area( p ) );
		at.mass = btScalar( boundary.mass( core, p ) );
		at.step = btScalar( h );
		at.displacedFraction = btScalar( boundary.cells().displaced );
		for ( const ForceField* field : m_fields )
		{
			if ( ( field->m_kinds & ForceField::kSurfaceForce ) != 0 && field->actsOn( body ) )
			{
				forces.add( core, p, toVec3d( field->surfaceForce( at ) ) );
			}
		}
	}
	if ( ( kinds & ForceField::kVolumeForce ) != 0 )
	{
		pushCavities( body, gravity, forces );
	}
	if ( forces.gas.law != GasLaw::None )
	{
		forces.pushWalls( core, impl.fractureVersion, h );
	}
	forces.finish( core );
	Vec3Array& to = impl.body->fieldForce();
	for ( int i = 0; i < nodes.count; ++i )
	{
		to.set( i, to.get( i ) + forces.forceOn( core, i ).cast<float>() );
	}
}

} // namespace pliant
