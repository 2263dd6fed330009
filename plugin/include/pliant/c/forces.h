#pragma once

// Forces of games: wind, water, fields of accelerations, explosions, and gas in hollow bodies. pliant/game/forces.h says more.

#include "pliant/c/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/// Wind, or air at rest, in the whole world: pliant::WindSettings.
typedef struct pliant_wind
{
	uint32_t size;        ///< of the structure, bytes
	uint32_t reserved;    ///< 0
	pliant_vec3 velocity; ///< of the air, m/s; at most 1000. Default 0.
	double density;       ///< of the air, kg/m^3, 0 to 1e4. Default 1.2.
	double drag;          ///< force along the wind, 0 to 100. Default 1.
	double lift;          ///< force across it, 0 to 100. Default 0.
} pliant_wind;

/// Water below a plane: pliant::WaterSettings. Acts on soft bodies.
typedef struct pliant_water
{
	uint32_t size;        ///< of the structure, bytes
	uint32_t reserved;    ///< 0
	pliant_vec3 surface;  ///< a point of the water's surface, world, m. Default 0.
	pliant_vec3 up;       ///< its normal, of any length but 0. Default ( 0, 1, 0 ).
	double density;       ///< kg/m^3, 0 to 1e5. Default 1000.
	double drag;          ///< 0 to 100. Default 1.
	pliant_vec3 velocity; ///< of the water, m/s; at most 1000. Default 0.
} pliant_water;

/// An explosion: pliant::Explosion.
typedef struct pliant_explosion
{
	uint32_t size;        ///< of the structure, bytes
	int32_t is_sheltered; ///< flag: static and kinematic objects shelter what is behind them. Default 0.
	pliant_vec3 centre;   ///< world, m. Default 0.
	double radius;        ///< no effect further away, m, above 0. Default 5.
	double impulse;       ///< on a surface at the centre that faces it, N s/m^2, 0 and above. Default 100.
	double falloff;       ///< it falls off with ( 1 - distance / radius )^falloff, 0 to 10. Default 1.
} pliant_explosion;

/// pliant_body_set_gas.
enum
{
	PLIANT_GAS_NONE = 0, ///< none
	PLIANT_GAS_CONSTANT, ///< always the same pressure
	PLIANT_GAS_IDEAL     ///< isothermal ideal gas with the pressure at its volume when it was set
};

/// Fills wind with its defaults. `size`: sizeof( pliant_wind ).
PLIANT_API pliant_result pliant_wind_init( pliant_wind* wind, uint32_t size );
/// Fills water with its defaults. `size`: sizeof( pliant_water ).
PLIANT_API pliant_result pliant_water_init( pliant_water* water, uint32_t size );

/// Sets the world's wind and wakes what it acts on; null: none, the default. Errors: PLIANT_BAD_SETTINGS.
PLIANT_API pliant_result pliant_world_set_wind( pliant_world* world, const pliant_wind* wind );
/// Sets the world's water in the same way.
PLIANT_API pliant_result pliant_world_set_water( pliant_world* world, const pliant_water* water );

/// A field of accelerations, such as the gravity of a planet. `position`: 3 numbers, world, m. Writes 3 numbers, m/s^2, initially 0.
/// Called from several threads at the same time; it may call functions that read the world, but none that changes it.
typedef void ( *pliant_acceleration )( const double* position, double* acceleration, void* context );
/// Sets the world's field of accelerations, which adds to its gravity, also on rigid bodies, and wakes all bodies of the world; null: none,
/// the default. `context`: passed to it.
PLIANT_API pliant_result pliant_world_set_acceleration( pliant_world* world, pliant_acceleration field, void* context );

/// Fills explosion with its defaults. `size`: sizeof( pliant_explosion ).
PLIANT_API pliant_result pliant_explosion_init( pliant_explosion* explosion, uint32_t size );
/// As pliant_world_explode (pliant/c/world.h), with all settings. `pushed`: number of bodies; may be null.
PLIANT_API pliant_result pliant_world_explode_as( pliant_world* world, const pliant_explosion* explosion, int32_t* pushed );

/// Fills the closed cavities of a hollow soft body with gas of `law`, PLIANT_GAS_..., and of `pressure`, Pa, above `outside`, -1e9 to 1e9;
/// `outside`, Pa, 0 to 1e9, matters to PLIANT_GAS_IDEAL only. Errors: PLIANT_BAD_SETTINGS; PLIANT_BAD_ARGUMENT for a body without a cavity.
PLIANT_API pliant_result pliant_body_set_gas( pliant_world* world, pliant_id body, int32_t law, double pressure, double outside );
/// The volume of a cavity with gas, m^3; 0 for a missing cavity. `cavity`: from 0 on.
PLIANT_API pliant_result pliant_body_get_gas_volume( const pliant_world* world, pliant_id body, int32_t cavity, double* volume );
/// The pressure above that outside in a cavity, 0 and up, in the last step, Pa; 0 for a cavity that is not there.
PLIANT_API pliant_result pliant_body_get_gas_pressure( const pliant_world* world, pliant_id body, int32_t cavity, double* pressure );

#ifdef __cplusplus
}
#endif
