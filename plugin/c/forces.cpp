// Wind, water, fields of accelerations, explosions and gas.

#include "pliant/c/forces.h"
#include "c/handles.h"
#include "c/settings.h"

namespace pliant::c {

template <class F>
void fields( F& f, pliant_wind& c, WindSettings& m )
{
	f( c.velocity, m.velocity );
	f( c.density, m.density );
	f( c.drag, m.drag );
	f( c.lift, m.lift );
}

template <class F>
void fields( F& f, pliant_water& c, WaterSettings& m )
{
	f( c.surface, m.surface );
	f( c.up, m.up );
	f( c.density, m.density );
	f( c.drag, m.drag );
	f( c.velocity, m.velocity );
}

template <class F>
void fields( F& f, pliant_explosion& c, Explosion& m )
{
	f( c.is_sheltered, m.isSheltered );
	f( c.centre, m.centre );
	f( c.radius, m.radius );
	f( c.impulse, m.impulse );
	f( c.falloff, m.falloff );
}

namespace {

static_assert(
	int( GasLaw::None ) == PLIANT_GAS_NONE && int( GasLaw::Constant ) == PLIANT_GAS_CONSTANT && int( GasLaw::Ideal ) == PLIANT_GAS_IDEAL );

/// A field that calls a function of the game. Exceptions of the function end here: the tasks that call the field cannot pass them on.
class Acceleration : public ForceField
{
public:
	Acceleration( pliant_acceleration function, void* context ) : ForceField( kAcceleration ), m_function( function ), m_context( context )
	{}
	btVector3 acceleration( const btVector3& position ) const override
	{
		const double at[3] = { double( position.x() ), double( position.y() ), double( position.z() ) };
		double sum[3] = { 0, 0, 0 };
		static_cast<void>( call( [&]() { m_function( at, sum, m_context ); } ) );
		return btVector3( btScalar( sum[0] ), btScalar( sum[1] ), btScalar( sum[2] ) );
	}

private:
	pliant_acceleration m_function;
	void* m_context;
};

/// Changes, makes or ends the one field of a kind.
template <class Settings, class Field, class C>
pliant_result setField( pliant_world* world, std::unique_ptr<Field> pliant_world::*member, const C* given )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		std::unique_ptr<Field>& field = world->*member;
		if ( !given )
		{
			field ? void( host.removeForceField( *field ) ) : void();
			field.reset();
			return Status{};
		}
		const auto settings = take<Settings>( given );
		std::unique_ptr<Field> made = field ? nullptr : std::make_unique<Field>();
		Field& changed = made ? *made : *field;
		Status status = changed.set( settings );
		if ( status.ok() && made )
		{
			status = host.addForceField( changed );
		}
		if ( status.ok() )
		{
			made ? void( field = std::move( made ) ) : changed.wake();
		}
		return status;
	} );
}

} // namespace

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_wind_init( pliant_wind* wind, uint32_t size )
{
	return initSized( inC<pliant_wind>( WindSettings{} ), wind, size );
}

pliant_result pliant_water_init( pliant_water* water, uint32_t size )
{
	return initSized( inC<pliant_water>( WaterSettings{} ), water, size );
}

pliant_result pliant_explosion_init( pliant_explosion* explosion, uint32_t size )
{
	return initSized( inC<pliant_explosion>( Explosion{} ), explosion, size );
}

pliant_result pliant_world_set_wind( pliant_world* world, const pliant_wind* wind )
{
	return setField<WindSettings>( world, &pliant_world::wind, wind );
}

pliant_result pliant_world_set_water( pliant_world* world, const pliant_water* water )
{
	return setField<WaterSettings>( world, &pliant_world::water, water );
}

pliant_result pliant_world_set_acceleration( pliant_world* world, pliant_acceleration field, void* context )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		std::unique_ptr<ForceField> made = field ? std::make_unique<Acceleration>( field, context ) : nullptr;
		const Status status = made ? host.addForceField( *made ) : Status{};
		if ( status.ok() )
		{
			rejectIf( world->acceleration && !host.removeForceField( *world->acceleration ), PLIANT_BAD_ARGUMENT,
				"A field may not replace itself." );
			world->acceleration = std::move( made );
		}
		return status;
	} );
}

pliant_result pliant_world_explode_as( pliant_world* world, const pliant_explosion* explosion, int32_t* pushed )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		requirePointers( explosion );
		return offer( host.explode( take<Explosion>( explosion ) ), pushed );
	} );
}

pliant_result pliant_body_get_gas_volume( const pliant_world* world, pliant_id body, int32_t cavity, double* volume )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { give( double( soft.gasVolume( cavity ) ), volume ); } );
}

pliant_result pliant_body_set_gas( pliant_world* world, pliant_id body, int32_t law, double pressure, double outside )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		rejectIf( law < PLIANT_GAS_NONE || law > PLIANT_GAS_IDEAL, PLIANT_BAD_SETTINGS, "The law of a gas must be one of PLIANT_GAS_..." );
		return soft.setGas( Gas{ GasLaw( law ), btScalar( pressure ), btScalar( outside ) } );
	} );
}

pliant_result pliant_body_get_gas_pressure( const pliant_world* world, pliant_id body, int32_t cavity, double* pressure )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { give( double( soft.gasPressure( cavity ) ), pressure ); } );
}
