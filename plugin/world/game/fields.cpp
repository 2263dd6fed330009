// The force fields that the library has.

#include "pliant/game/forces.h"

#include "world/bodies/soft_body_impl.h"
#include "world/game/constants.h"
#include "world/game/force_fields.h"

#include <cmath>

namespace pliant {

namespace {

bool isFlow( const btVector3& velocity )
{
	return isFinite( velocity ) && velocity.length() <= kMostFlow;
}

bool isWithin( btScalar value, btScalar most )
{
	return value >= 0 && value <= most;
}

Status check( const WindSettings& settings )
{
	const bool isGood = isFlow( settings.velocity ) && isWithin( settings.density, kMostAirDensity ) &&
		isWithin( settings.drag, kMostDrag ) && isWithin( settings.lift, kMostDrag );
	return isGood ? Status{} : Status{ ResultCode::BadSettings, "Wind: a setting is out of range." };
}

Status check( const WaterSettings& settings )
{
	const bool isGood = isFinite( settings.surface ) && isFinite( settings.up ) && settings.up.length2() > 0 &&
		isFlow( settings.velocity ) && isWithin( settings.density, kMostWaterDensity ) && isWithin( settings.drag, kMostDrag );
	return isGood ? Status{} : Status{ ResultCode::BadSettings, "Water: a setting is out of range." };
}

/// Velocity of the fluid against a surface from its outside.
struct Flow
{
	btVector3 velocity; ///< m/s
	btScalar density, drag, lift;
};

/// Drag along the flow by the area that faces it; lift across it, away from the surface. No more than takes the point along with the flow
/// within the substep.
btVector3 forceOf( const Flow& flow, const SurfacePoint& point )
{
	const btVector3 past = flow.velocity - point.velocity;
	const btScalar speed = past.length();
	if ( !( speed > 0 ) )
	{
		return btVector3( 0, 0, 0 );
	}
	const btVector3 along = past / speed;
	const btScalar facing = -point.area.dot( along ) * btPow( point.displacedFraction, btScalar( 2 ) / 3 );
	if ( !( facing > 0 ) )
	{
		return btVector3( 0, 0, 0 );
	}
	const btScalar pressure = btScalar( 0.5 ) * flow.density * speed * speed; // Pa
	const btScalar most = point.mass * speed / point.step;                    // N
	btVector3 force = along * btMin( flow.drag * pressure * facing, most );
	if ( flow.lift > 0 )
	{
		const btVector3 across = -point.area.normalized() - along * -point.area.normalized().dot( along );
		btVector3 lift = across * ( flow.lift * pressure * facing );
		const btScalar size = lift.length();
		force += size > most ? lift * ( most / size ) : lift;
	}
	return force;
}

} // namespace

ForceField::~ForceField()
{
	if ( m_owner )
	{
		m_owner->leave( *this );
	}
}

bool ForceField::actsOn( const btCollisionObject& ) const
{
	return true;
}

btVector3 ForceField::acceleration( const btVector3& ) const
{
	return btVector3( 0, 0, 0 );
}

btVector3 ForceField::surfaceForce( const SurfacePoint& ) const
{
	return btVector3( 0, 0, 0 );
}

btVector3 ForceField::volumeForce( const VolumePoint& ) const
{
	return btVector3( 0, 0, 0 );
}

void ForceField::wake()
{
	if ( m_owner && !m_owner->areActing() )
	{
		m_owner->wake( *this );
	}
}

Wind::Wind( const WindSettings& settings ) : ForceField( kSurfaceForce )
{
	static_cast<void>( set( settings ) );
}

Status Wind::set( const WindSettings& settings )
{
	Status status = check( settings );
	m_settings = status.ok() ? settings : m_settings;
	return status;
}

btVector3 Wind::velocityAt( const btVector3& ) const
{
	return m_settings.velocity;
}

btVector3 Wind::surfaceForce( const SurfacePoint& point ) const
{
	return forceOf( Flow{ velocityAt( point.position ), m_settings.density, m_settings.drag, m_settings.lift }, point );
}

Water::Water( const WaterSettings& settings ) : ForceField( kSurfaceForce + kVolumeForce ), m_up( 0, 1, 0 )
{
	static_cast<void>( set( settings ) );
}

Status Water::set( const WaterSettings& settings )
{
	Status status = check( settings );
	if ( status.ok() )
	{
		m_settings = settings;
		m_up = settings.up.normalized();
	}
	return status;
}

btVector3 Water::surfaceForce( const SurfacePoint& point ) const
{
	const bool isUnder = ( m_settings.surface - point.position ).dot( m_up ) > 0;
	const Flow flow{ m_settings.velocity, m_settings.density, m_settings.drag, btScalar( 0 ) };
	return isUnder ? forceOf( flow, point ) : btVector3( 0, 0, 0 );
}

// The weight of the displaced water. Pressure on the surface would give the same force, but squeeze materials whose Poisson number is far
// below that of rubber.
btVector3 Water::volumeForce( const VolumePoint& point ) const
{
	const btScalar depth = ( m_settings.surface - point.position ).dot( m_up );
	const btScalar under = btClamped( depth / point.size + btScalar( 0.5 ), btScalar( 0 ), btScalar( 1 ) );
	return m_up * ( -point.gravity.dot( m_up ) * m_settings.density * point.volume * under );
}

Planet::Planet( const btVector3& centre, btScalar radius, btScalar gravity ) :
	ForceField( kAcceleration ), m_centre( centre ), m_radius( radius ), m_gravity( gravity )
{
	if ( !isFinite( centre ) || !std::isfinite( gravity ) || !std::isfinite( radius ) || !( radius > 0 ) )
	{
		m_centre.setZero();
		m_radius = btScalar( 1 );
		m_gravity = btScalar( 0 );
	}
}

btVector3 Planet::acceleration( const btVector3& position ) const
{
	const btVector3 down = m_centre - position;
	const btScalar distance = down.length();
	if ( !( distance > 0 ) )
	{
		return btVector3( 0, 0, 0 );
	}
	const btScalar fraction = distance < m_radius ? distance / m_radius : m_radius * m_radius / ( distance * distance );
	return down * ( m_gravity * fraction / distance );
}

} // namespace pliant
