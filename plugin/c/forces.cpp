// Wind, water and gas.

#include "pliant/c/forces.h"
#include "c/handles.h"
#include "c/numbers.h"

namespace pliant::c {

namespace {

static_assert(
	int( GasLaw::None ) == PLIANT_GAS_NONE && int( GasLaw::Constant ) == PLIANT_GAS_CONSTANT && int( GasLaw::Ideal ) == PLIANT_GAS_IDEAL );

pliant_wind inC( const WindSettings& settings )
{
	pliant_wind c{};
	c.velocity = vectorOf( settings.velocity );
	c.density = double( settings.density );
	c.drag = double( settings.drag );
	c.lift = double( settings.lift );
	return c;
}

pliant_water inC( const WaterSettings& settings )
{
	pliant_water c{};
	c.surface = vectorOf( settings.surface );
	c.up = vectorOf( settings.up );
	c.density = double( settings.density );
	c.drag = double( settings.drag );
	c.velocity = vectorOf( settings.velocity );
	return c;
}

WindSettings inCpp( const pliant_wind& c )
{
	return WindSettings{ vectorOf( c.velocity ), btScalar( c.density ), btScalar( c.drag ), btScalar( c.lift ) };
}

WaterSettings inCpp( const pliant_water& c )
{
	return WaterSettings{ vectorOf( c.surface ), vectorOf( c.up ), btScalar( c.density ), btScalar( c.drag ), vectorOf( c.velocity ) };
}

/// Changes, makes or ends the one field of a kind.
template <class Field, class Settings, class C>
pliant_result setField( pliant_world* world, std::unique_ptr<Field> pliant_world::*member, const C* given )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		std::unique_ptr<Field>& field = world->*member;
		C full = inC( Settings{} );
		if ( const pliant_result code = readSized( given, full ); code != PLIANT_OK )
		{
			return code;
		}
		if ( !given )
		{
			field ? void( host.removeForceField( *field ) ) : void();
			field.reset();
			return pliant_result( PLIANT_OK );
		}
		std::unique_ptr<Field> made = field ? nullptr : std::make_unique<Field>();
		Field& changed = made ? *made : *field;
		Status status = changed.set( inCpp( full ) );
		if ( status.ok() && made )
		{
			status = host.addForceField( changed );
		}
		if ( status.ok() )
		{
			made ? void( field = std::move( made ) ) : changed.wake();
		}
		return resultOf( status );
	} );
}

} // namespace

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_wind_init( pliant_wind* wind, uint32_t size )
{
	return writeSized( inC( WindSettings{} ), wind, size );
}

pliant_result pliant_water_init( pliant_water* water, uint32_t size )
{
	return writeSized( inC( WaterSettings{} ), water, size );
}

pliant_result pliant_world_set_wind( pliant_world* world, const pliant_wind* wind )
{
	return setField<Wind, WindSettings>( world, &pliant_world::wind, wind );
}

pliant_result pliant_world_set_water( pliant_world* world, const pliant_water* water )
{
	return setField<Water, WaterSettings>( world, &pliant_world::water, water );
}

pliant_result pliant_body_set_gas( pliant_world* world, pliant_id body, int32_t law, double pressure, double outside )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		if ( law < PLIANT_GAS_NONE || law > PLIANT_GAS_IDEAL )
		{
			return refuse( PLIANT_BAD_SETTINGS, "The law of a gas must be one of PLIANT_GAS_..." );
		}
		return resultOf( soft.setGas( Gas{ GasLaw( law ), btScalar( pressure ), btScalar( outside ) } ) );
	} );
}

pliant_result pliant_body_get_gas_pressure( const pliant_world* world, pliant_id body, int32_t cavity, double* pressure )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		if ( !pressure )
		{
			return refuseNull();
		}
		*pressure = double( soft.gasPressure( cavity ) );
		return pliant_result( PLIANT_OK );
	} );
}
