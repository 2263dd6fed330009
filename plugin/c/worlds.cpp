#include "c/handles.h"
#include "c/numbers.h"
#include "c/settings.h"
#include "pliant/c/mix.h"
#include "pliant/c/world.h"

#include <algorithm>
#include <limits>

namespace pliant::c {

namespace {

pliant_world_settings defaultWorld()
{
	pliant_world_settings settings{};
	settings.threads = 1;
	settings.gravity = pliant_vec3{ 0, -9.81, 0 };
	settings.soft_substeps = 4;
	settings.max_soft_substeps = 16;
	return settings;
}

bool isCount( int count, int most )
{
	return count >= 1 && count <= most;
}

pliant_result checkSubsteps( int substeps, int most )
{
	if ( !isCount( substeps, kMostSubsteps ) || !isCount( most, kMostSubsteps ) )
	{
		return refuse( PLIANT_BAD_ARGUMENT, "Numbers of soft substeps must lie in 1 to 64." );
	}
	return PLIANT_OK;
}

pliant_result checkThreads( int threads )
{
	return isCount( threads, kMostThreads ) ? PLIANT_OK : refuse( PLIANT_BAD_ARGUMENT, "The number of threads must lie in 1 to 64." );
}

pliant_result checkGravity( const pliant_vec3& gravity )
{
	return isWithin( gravity, kMostGravity ) ? PLIANT_OK
											 : refuse( PLIANT_BAD_ARGUMENT, "Gravity must be at most 1e6 m/s^2 along each axis." );
}

pliant_result checkWorld( const pliant_world_settings& settings )
{
	pliant_result code = checkThreads( settings.threads );
	code = code == PLIANT_OK ? checkGravity( settings.gravity ) : code;
	code = code == PLIANT_OK ? checkSubsteps( settings.soft_substeps, settings.max_soft_substeps ) : code;
	return code == PLIANT_OK ? code : PLIANT_BAD_SETTINGS;
}

pliant_step_report inC( const StepReport& report )
{
	constexpr double kMilliseconds = 1000;
	pliant_step_report c{};
	c.substeps = report.substeps;
	c.milliseconds = report.total * kMilliseconds;
	c.forces_ms = report.forces * kMilliseconds;
	c.matching_ms = report.matching * kMilliseconds;
	c.collision_ms = report.collision * kMilliseconds;
	c.solve_ms = report.solve * kMilliseconds;
	c.integrate_ms = report.integrate * kMilliseconds;
	c.skinning_ms = report.skinning * kMilliseconds;
	c.levels_ms = report.levels * kMilliseconds;
	c.fracture_ms = report.fracture * kMilliseconds;
	c.soft_bodies = report.softBodies;
	c.awake_soft_bodies = report.awakeSoftBodies;
	c.rigid_state_bodies = report.rigidBodies;
	c.implicit_bodies = report.implicitBodies;
	c.nodes = report.nodes;
	c.soft_contacts = report.softContacts;
	c.level_changes = report.levelChanges;
	c.broken_links = report.brokenLinks;
	c.fragments = report.fragments;
	c.removed_pieces = report.removedPieces;
	c.debris_pieces = report.debrisPieces;
	c.debris_nodes = report.debrisNodes;
	c.settled_pieces = report.debrisSettled;
	c.quarantined = report.quarantined;
	c.unreachable_stiffness = report.unreachableStiffness;
	return c;
}

pliant_result checkStep( double seconds, std::int32_t most, double fixed )
{
	if ( !isWithin( seconds, 0, std::numeric_limits<float>::max() ) || !isWithin( fixed, 0, std::numeric_limits<float>::max() ) ||
		btScalar( fixed ) <= 0 || most < 0 )
	{
		return refuse( PLIANT_BAD_ARGUMENT, "Seconds and max_steps must be 0 or above, and fixed_step above 0." );
	}
	return PLIANT_OK;
}

template <class F>
pliant_result listObjects( std::uint64_t total, pliant_id* ids, std::uint64_t capacity, std::uint64_t* count, F&& idOf )
{
	if ( !count || ( !ids && capacity > 0 ) )
	{
		return refuseNull();
	}
	for ( std::uint64_t k = 0; k < std::min( total, capacity ); ++k )
	{
		ids[k] = idOf( int( k ) );
	}
	*count = total;
	return PLIANT_OK;
}

} // namespace

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_world::~pliant_world()
{
	wind.reset();
	water.reset();
	pliant::c::endJoints( *this, nullptr );
	for ( const auto& [body, owner] : madeSoft )
	{
		host->removeSoftBody( owner.get() );
	}
	madeSoft.clear();
	for ( const auto& [id, other] : others )
	{
		if ( other.made )
		{
			host->bulletWorld().removeRigidBody( other.made->body.get() );
		}
	}
	whole.reset(); // its fragments with it, before the rigid bodies that they may be pinned to
}

pliant_result pliant_world_settings_init( pliant_world_settings* settings, uint32_t size )
{
	return writeSized( defaultWorld(), settings, size );
}

pliant_result pliant_world_create( const pliant_world_settings* settings, pliant_world** world )
{
	return call( [&]() -> pliant_result {
		pliant_world_settings full = defaultWorld();
		pliant_result code = world ? readSized( settings, full ) : refuseNull();
		code = code == PLIANT_OK ? checkWorld( full ) : code;
		if ( code != PLIANT_OK )
		{
			return code;
		}
		auto made = std::make_unique<pliant_world>();
		made->whole = std::make_unique<WholeWorld>();
		made->host = &made->whole->world;
		made->host->bulletWorld().setGravity( vectorOf( full.gravity ) );
		made->host->setSoftSubsteps( full.soft_substeps );
		made->host->setMaxSoftSubsteps( full.max_soft_substeps );
		made->host->setThreadCount( full.threads );
		*world = made.release();
		return PLIANT_OK;
	} );
}

pliant_result pliant_world_wrap( void* soft_body_host, pliant_world** world )
{
	return call( [&]() -> pliant_result {
		if ( !soft_body_host || !world )
		{
			return refuseNull();
		}
		auto made = std::make_unique<pliant_world>();
		made->host = static_cast<SoftBodyHost*>( soft_body_host );
		*world = made.release();
		return PLIANT_OK;
	} );
}

void pliant_world_destroy( pliant_world* world )
{
	delete world;
}

pliant_result pliant_world_step( pliant_world* world, double seconds, int32_t max_steps, double fixed_step, int32_t* steps )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		if ( const pliant_result code = checkStep( seconds, max_steps, fixed_step ); code != PLIANT_OK )
		{
			return code;
		}
		world->destroyed.clear();
		const int made = host.bulletWorld().stepSimulation( btScalar( seconds ), max_steps, btScalar( fixed_step ) );
		if ( steps )
		{
			*steps = made;
		}
		return pliant_result( PLIANT_OK );
	} );
}

pliant_result pliant_world_get_report( const pliant_world* world, pliant_step_report* report, uint32_t size )
{
	return withWorld( world, [&]( SoftBodyHost& host ) { return writeSized( inC( host.stepReport() ), report, size ); } );
}

pliant_result pliant_world_set_gravity( pliant_world* world, pliant_vec3 gravity )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		const pliant_result code = checkGravity( gravity );
		if ( code == PLIANT_OK )
		{
			host.bulletWorld().setGravity( vectorOf( gravity ) );
		}
		return code;
	} );
}

pliant_result pliant_world_get_gravity( const pliant_world* world, pliant_vec3* gravity )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		if ( !gravity )
		{
			return refuseNull();
		}
		*gravity = vectorOf( host.bulletWorld().getGravity() );
		return pliant_result( PLIANT_OK );
	} );
}

pliant_result pliant_world_set_threads( pliant_world* world, int32_t threads )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		const pliant_result code = checkThreads( threads );
		if ( code == PLIANT_OK )
		{
			host.setThreadCount( threads );
		}
		return code;
	} );
}

pliant_result pliant_world_set_soft_substeps( pliant_world* world, int32_t substeps, int32_t most )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		const pliant_result code = checkSubsteps( substeps, most );
		if ( code == PLIANT_OK )
		{
			host.setSoftSubsteps( substeps );
			host.setMaxSoftSubsteps( most );
		}
		return code;
	} );
}

pliant_result pliant_world_set_debris_budget( pliant_world* world, const pliant_debris_budget* budget )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		DebrisBudget taken;
		const pliant_result code = budget ? take( budget, taken ) : refuseNull();
		return code == PLIANT_OK ? resultOf( host.setDebrisBudget( taken ) ) : code;
	} );
}

pliant_result pliant_world_set_interpolation( pliant_world* world, double fraction )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		if ( !isWithin( fraction, 0, 1 ) )
		{
			return refuse( PLIANT_BAD_ARGUMENT, "The fraction must lie in [0, 1]." );
		}
		host.setInterpolationFraction( btScalar( fraction ) );
		return pliant_result( PLIANT_OK );
	} );
}

pliant_result pliant_world_shift_origin( pliant_world* world, pliant_vec3 by )
{
	return withWorld( world, [&]( SoftBodyHost& host ) { return resultOf( host.shiftOrigin( vectorOf( by ) ) ); } );
}

pliant_result pliant_world_explode( pliant_world* world, pliant_vec3 centre, double radius, double impulse, int32_t* pushed )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		Explosion explosion;
		explosion.centre = vectorOf( centre );
		explosion.radius = btScalar( radius );
		explosion.impulse = btScalar( impulse );
		const Result<int> result = host.explode( explosion );
		if ( result.ok() && pushed )
		{
			*pushed = result.value;
		}
		return resultOf( result.status );
	} );
}

pliant_result pliant_world_get_bodies( pliant_world* world, pliant_id* ids, uint64_t capacity, uint64_t* count )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		return listObjects(
			std::uint64_t( host.softBodyCount() ), ids, capacity, count, [&]( int k ) { return identityOf( *host.softBody( k ) ); } );
	} );
}

pliant_result pliant_world_get_rigids( pliant_world* world, pliant_id* ids, uint64_t capacity, uint64_t* count )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		std::vector<pliant_id> rigid;
		const btCollisionObjectArray& all = host.bulletWorld().getCollisionObjectArray();
		for ( int k = 0; k < all.size(); ++k )
		{
			if ( btRigidBody::upcast( all[k] ) )
			{
				rigid.push_back( identityOf( *world, all[k] ) );
			}
		}
		return listObjects( rigid.size(), ids, capacity, count, [&]( int k ) { return rigid[std::size_t( k )]; } );
	} );
}

namespace pliant {

pliant_result wrapWorld( SoftBodyHost& world, pliant_world** made )
{
	return pliant_world_wrap( &world, made );
}

} // namespace pliant
