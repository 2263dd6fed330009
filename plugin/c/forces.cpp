// Wind, water, fields of accelerations, explosions and gas.

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

pliant_explosion inC( const Explosion& explosion )
{
	pliant_explosion c{};
	c.is_sheltered = explosion.isSheltered ? 1 : 0;
	c.centre = vectorOf( explosion.centre );
	c.radius = double( explosion.radius );
	c.impulse = double( explosion.impulse );
	c.falloff = double( explosion.falloff );
	return c;
}

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
		static_cast<void>( call( [&]() -> pliant_result {
			m_function( at, sum, m_context );
			return PLIANT_OK;
		} ) );
		return btVector3( btScalar( sum[0] ), btScalar( sum[1] ), btScalar( sum[2] ) );
	}

private:
	pliant_acceleration m_function;
	void* m_context;
};

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

pliant_result pliant_world_set_acceleration( pliant_world* world, pliant_acceleration field, void* context )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		std::unique_ptr<ForceField> made = field ? std::make_unique<Acceleration>( field, context ) : nullptr;
		Status status = made ? host.addForceField( *made ) : Status{};
		const bool isRefused = !status.ok() || ( world->acceleration && !host.removeForceField( *world->acceleration ) );
		if ( isRefused )
		{
			return status.ok() ? refuse( PLIANT_BAD_ARGUMENT, "A field may not replace itself." ) : resultOf( status );
		}
		world->acceleration = std::move( made );
		return pliant_result( PLIANT_OK );
	} );
}

pliant_result pliant_explosion_init( pliant_explosion* explosion, uint32_t size )
{
	return writeSized( inC( Explosion{} ), explosion, size );
}

pliant_result pliant_world_explode_as( pliant_world* world, const pliant_explosion* explosion, int32_t* pushed )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		pliant_explosion full = inC( Explosion{} );
		if ( const pliant_result code = explosion ? readSized( explosion, full ) : refuseNull(); code != PLIANT_OK )
		{
			return code;
		}
		const Result<int> result = host.explode( Explosion{ vectorOf( full.centre ), btScalar( full.radius ), btScalar( full.impulse ),
			btScalar( full.falloff ), full.is_sheltered != 0 } );
		result.ok() && pushed ? void( *pushed = result.value ) : void();
		return resultOf( result.status );
	} );
}

pliant_result pliant_body_get_gas_volume( const pliant_world* world, pliant_id body, int32_t cavity, double* volume )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { return give( double( soft.gasVolume( cavity ) ), volume ); } );
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
