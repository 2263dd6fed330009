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

void checkSubsteps( int substeps, int most, pliant_result code = PLIANT_BAD_ARGUMENT )
{
	rejectIf( !isWithin( substeps, 1, kMostSubsteps ) || !isWithin( most, 1, kMostSubsteps ), code,
		"Numbers of soft substeps must lie in 1 to 64." );
}

void checkThreads( int threads, pliant_result code = PLIANT_BAD_ARGUMENT )
{
	rejectIf( !isWithin( threads, 1, kMostThreads ), code, "The number of threads must lie in 1 to 64." );
}

void checkGravity( const pliant_vec3& gravity, pliant_result code = PLIANT_BAD_ARGUMENT )
{
	rejectIf( !isWithin( gravity, kMostGravity ), code, "Gravity must be at most 1e6 m/s^2 along each axis." );
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

template <class F>
void listObjects( std::uint64_t total, pliant_id* ids, std::uint64_t capacity, std::uint64_t* count, F&& idOf )
{
	giveCount( total, ids, capacity, count );
	for ( std::uint64_t k = 0; k < std::min( total, capacity ); ++k )
	{
		ids[k] = idOf( int( k ) );
	}
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
	return initSized( defaultWorld(), settings, size );
}

pliant_result pliant_world_create( const pliant_world_settings* settings, pliant_world** world )
{
	return call( [&]() {
		requirePointers( world );
		pliant_world_settings full = defaultWorld();
		readSized( settings, full );
		checkThreads( full.threads, PLIANT_BAD_SETTINGS );
		checkGravity( full.gravity, PLIANT_BAD_SETTINGS );
		checkSubsteps( full.soft_substeps, full.max_soft_substeps, PLIANT_BAD_SETTINGS );
		auto made = std::make_unique<pliant_world>();
		made->whole = std::make_unique<WholeWorld>();
		made->host = &made->whole->world;
		made->host->bulletWorld().setGravity( vectorOf( full.gravity ) );
		made->host->setSoftSubsteps( full.soft_substeps );
		made->host->setMaxSoftSubsteps( full.max_soft_substeps );
		made->host->setThreadCount( full.threads );
		*world = made.release();
	} );
}

pliant_result pliant_world_wrap( void* soft_body_host, pliant_world** world )
{
	return call( [&]() {
		requirePointers( soft_body_host, world );
		auto made = std::make_unique<pliant_world>();
		made->host = static_cast<SoftBodyHost*>( soft_body_host );
		*world = made.release();
	} );
}

void pliant_world_destroy( pliant_world* world )
{
	delete world;
}

pliant_result pliant_world_step( pliant_world* world, double seconds, int32_t max_steps, double fixed_step, int32_t* steps )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		constexpr double kLongest = std::numeric_limits<float>::max();
		rejectIf( !isWithin( seconds, 0, kLongest ) || !isWithin( fixed_step, 0, kLongest ) || btScalar( fixed_step ) <= 0 || max_steps < 0,
			PLIANT_BAD_ARGUMENT, "Seconds and max_steps must be 0 or above, and fixed_step above 0." );
		world->destroyed.clear();
		offer( host.bulletWorld().stepSimulation( btScalar( seconds ), max_steps, btScalar( fixed_step ) ), steps );
	} );
}

pliant_result pliant_world_get_report( const pliant_world* world, pliant_step_report* report, uint32_t size )
{
	return withWorld( world, [&]( SoftBodyHost& host ) { writeSized( inC( host.stepReport() ), report, size ); } );
}

pliant_result pliant_world_set_gravity( pliant_world* world, pliant_vec3 gravity )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		checkGravity( gravity );
		host.bulletWorld().setGravity( vectorOf( gravity ) );
	} );
}

pliant_result pliant_world_get_gravity( const pliant_world* world, pliant_vec3* gravity )
{
	return withWorld( world, [&]( SoftBodyHost& host ) { give( vectorOf( host.bulletWorld().getGravity() ), gravity ); } );
}

pliant_result pliant_world_set_threads( pliant_world* world, int32_t threads )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		checkThreads( threads );
		host.setThreadCount( threads );
	} );
}

pliant_result pliant_world_set_soft_substeps( pliant_world* world, int32_t substeps, int32_t most )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		checkSubsteps( substeps, most );
		host.setSoftSubsteps( substeps );
		host.setMaxSoftSubsteps( most );
	} );
}

pliant_result pliant_world_set_debris_budget( pliant_world* world, const pliant_debris_budget* budget )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		requirePointers( budget );
		return host.setDebrisBudget( take<DebrisBudget>( budget ) );
	} );
}

pliant_result pliant_world_set_interpolation( pliant_world* world, double fraction )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		rejectIf( !isWithin( fraction, 0, 1 ), PLIANT_BAD_ARGUMENT, "The fraction must lie in [0, 1]." );
		host.setInterpolationFraction( btScalar( fraction ) );
	} );
}

pliant_result pliant_world_shift_origin( pliant_world* world, pliant_vec3 by )
{
	return withWorld( world, [&]( SoftBodyHost& host ) { return host.shiftOrigin( vectorOf( by ) ); } );
}

pliant_result pliant_world_explode( pliant_world* world, pliant_vec3 centre, double radius, double impulse, int32_t* pushed )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		Explosion explosion;
		explosion.centre = vectorOf( centre );
		explosion.radius = btScalar( radius );
		explosion.impulse = btScalar( impulse );
		return offer( host.explode( explosion ), pushed );
	} );
}

pliant_result pliant_world_get_bodies( pliant_world* world, pliant_id* ids, uint64_t capacity, uint64_t* count )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		const auto idOf = [&]( int k ) { return identityOf( *host.softBody( k ) ); };
		listObjects( std::uint64_t( host.softBodyCount() ), ids, capacity, count, idOf );
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
		listObjects( rigid.size(), ids, capacity, count, [&]( int k ) { return rigid[std::size_t( k )]; } );
	} );
}

namespace pliant {

pliant_result wrapWorld( SoftBodyHost& world, pliant_world** made )
{
	return pliant_world_wrap( &world, made );
}

} // namespace pliant
