#pragma once

// Forces that games put into a world: fields of gravity, wind, water, gas in hollow bodies, explosions.

#include "pliant/export.h"
#include "pliant/result.h"

#include <LinearMath/btVector3.h>

class btCollisionObject;

namespace pliant {

class ForceFields;
class SoftBodyHost;

/// A point of a soft body's surface, as a force field sees it. The surface is that of the body's cells, with the faces of cracks, without
/// cavities.
struct SurfacePoint
{
	btVector3 position;                         ///< world, m
	btVector3 velocity;                         ///< m/s
	btVector3 area;                             ///< its part of the surface, outwards, m^2; the sum over a body is zero
	btScalar mass = btScalar( 0 );              ///< its part of the nodes' masses, kg
	btScalar step = btScalar( 0 );              ///< length of the substep, s
	btScalar displacedFraction = btScalar( 1 ); ///< volume of the body as a fraction of that inside of the surface
};

/// The material of a node, or a closed cavity, as a force field sees it.
struct VolumePoint
{
	btVector3 position;              ///< world, m
	btVector3 gravity;               ///< that acts there, gravity fields included, m/s^2
	btScalar volume = btScalar( 0 ); ///< m^3
	btScalar size = btScalar( 0 );   ///< edge of a cube that it fills, m
};

/// A force on everything in a world. Derive from it and call addForceField of the world. It acts in every substep of awake bodies, on
/// those that are neither static nor kinematic. The game owns it; it leaves its world when it is destroyed. The functions are called from
/// several threads at the same time, and may ask bodies and the world but change nothing: calls that do are refused with BadArgument or,
/// where they return no status, ignored; nothing may be deleted. A number that is not finite stops soft bodies (SoftBody::isHealthy) and
/// does nothing to rigid ones.
class PLIANT_API ForceField
{
public:
	virtual ~ForceField();
	ForceField( const ForceField& ) = delete;
	ForceField& operator=( const ForceField& ) = delete;

	/// Whether it acts on an object: a soft body or, for accelerations, a rigid one. Default: on all.
	[[nodiscard]] virtual bool actsOn( const btCollisionObject& object ) const;
	/// The acceleration at a world position, m, in m/s^2. Also acts on rigid bodies, at their centre of mass once a step, except on those
	/// with BT_DISABLE_WORLD_GRAVITY; not on multibodies. Adds to the world's gravity. Default: none.
	[[nodiscard]] virtual btVector3 acceleration( const btVector3& position ) const;
	/// The force on a point of a soft body's surface, N. Default: none.
	[[nodiscard]] virtual btVector3 surfaceForce( const SurfacePoint& point ) const;
	/// The force on a part of a soft body's volume, N. Default: none.
	[[nodiscard]] virtual btVector3 volumeForce( const VolumePoint& point ) const;

	/// Wakes the bodies that the field acts on. Call it when the field has changed; the change itself wakes nothing, as with the world's
	/// gravity.
	void wake();

protected:
	// The functions that a class implements: the sum of some of these.
	static constexpr int kAcceleration = 1; ///< acceleration()
	static constexpr int kSurfaceForce = 2; ///< surfaceForce()
	static constexpr int kVolumeForce = 4;  ///< volumeForce()
	/// `kinds`: the sum of the constants above for the functions that the class implements; the others are never called.
	explicit ForceField( int kinds ) : m_kinds( kinds ) {}

private:
	friend class ForceFields;
	int m_kinds;
	ForceFields* m_owner = nullptr;
};

/// Settings of Wind. Values out of range are refused (BadSettings).
struct WindSettings
{
	btVector3 velocity = btVector3( 0, 0, 0 ); ///< of the air, m/s; at most 1000
	btScalar density = btScalar( 1.2 );        ///< of the air, kg/m^3, 0 to 1e4
	/// Force along the wind: 1/2 density drag v^2 on the area that faces it, v relative to the surface. 0 to 100.
	btScalar drag = btScalar( 1 );
	/// Force across the wind on surfaces at an angle to it. 0 to 100.
	btScalar lift = btScalar( 0 );
};

/// Wind, or air at rest, in the whole world. Surfaces do not shelter each other.
class PLIANT_API Wind : public ForceField
{
public:
	/// Settings out of range count as the default ones.
	explicit Wind( const WindSettings& settings = {} );
	/// Does not wake sleeping bodies: see ForceField::wake. Errors: BadSettings.
	Status set( const WindSettings& settings );
	/// The settings.
	[[nodiscard]] const WindSettings& settings() const { return m_settings; }
	/// The air's velocity at a world position, m/s: replace it for gusts, fans and whirls. Default: the same everywhere.
	[[nodiscard]] virtual btVector3 velocityAt( const btVector3& position ) const;
	/// As ForceField's.
	[[nodiscard]] btVector3 surfaceForce( const SurfacePoint& point ) const override;

private:
	WindSettings m_settings;
};

/// Settings of Water. Values out of range are refused (BadSettings).
struct WaterSettings
{
	btVector3 surface = btVector3( 0, 0, 0 );  ///< a point of the water's surface, m
	btVector3 up = btVector3( 0, 1, 0 );       ///< the surface's normal; any length above 0
	btScalar density = btScalar( 1000 );       ///< kg/m^3, 0 to 1e5
	btScalar drag = btScalar( 1 );             ///< as WindSettings::drag, below the surface. 0 to 100
	btVector3 velocity = btVector3( 0, 0, 0 ); ///< of the water, m/s; at most 1000
};

/// Water below a plane: buoyancy, by the gravity that acts on the body, and drag. A closed body displaces its cavities too. Its pressure
/// does not squeeze bodies. Acts on soft bodies.
class PLIANT_API Water : public ForceField
{
public:
	/// Settings out of range count as the default ones.
	explicit Water( const WaterSettings& settings = {} );
	/// Does not wake sleeping bodies: see ForceField::wake. Errors: BadSettings.
	Status set( const WaterSettings& settings );
	/// The settings.
	[[nodiscard]] const WaterSettings& settings() const { return m_settings; }
	/// As ForceField's: drag.
	[[nodiscard]] btVector3 surfaceForce( const SurfacePoint& point ) const override;
	/// As ForceField's: buoyancy.
	[[nodiscard]] btVector3 volumeForce( const VolumePoint& point ) const override;

private:
	WaterSettings m_settings;
	btVector3 m_up;
};

/// The gravity of a sphere: falls with the square of the distance outside of it, and with the distance inside.
class PLIANT_API Planet : public ForceField
{
public:
	/// `gravity`: at the distance `radius` from the centre, m/s^2. With a bad number or a radius not above 0 it does nothing.
	Planet( const btVector3& centre, btScalar radius, btScalar gravity );
	/// As ForceField's.
	[[nodiscard]] btVector3 acceleration( const btVector3& position ) const override;

private:
	btVector3 m_centre;
	btScalar m_radius, m_gravity;
};

/// How gas in a body's cavities behaves.
enum class GasLaw : int
{
	None,     ///< no gas. Default.
	Constant, ///< always Gas::pressure
	Ideal     ///< isothermal ideal gas with Gas::pressure at its volume when setGas was called
};

/// Gas in the cavities of a hollow body (SoftBody::setGas). Values out of range are refused (BadSettings).
struct Gas
{
	GasLaw law = GasLaw::None;             ///< how the pressure follows the volume; default: no gas
	btScalar pressure = btScalar( 0 );     ///< gauge pressure, Pa, -1e9 to 1e9; with GasLaw::Ideal above -outside
	btScalar outside = btScalar( 101325 ); ///< pressure outside, Pa, 0 to 1e9; matters to GasLaw::Ideal only
};

/// An explosion: a shock wave that runs over the world at once. Values out of range are refused (BadSettings).
struct Explosion
{
	btVector3 centre = btVector3( 0, 0, 0 ); ///< world, m
	btScalar radius = btScalar( 5 );         ///< no effect further away, m; above 0
	btScalar impulse = btScalar( 100 );      ///< on a surface at the centre that faces it, N s/m^2; 0 and above
	/// How it falls off: with ( 1 - distance / radius )^falloff. 0 (everywhere the same) to 10.
	btScalar falloff = btScalar( 1 );
	/// Static and kinematic objects shelter the surfaces behind them. Casts a ray for each point of a surface that faces the centre.
	bool isSheltered = false;
};

} // namespace pliant
