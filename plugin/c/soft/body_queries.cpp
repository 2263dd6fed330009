// Creation of soft bodies, and queries.

#include "c/handles.h"
#include "c/numbers.h"
#include "c/settings.h"
#include "pliant/c/body.h"

namespace pliant::c {

namespace {

pliant_body_settings defaultBody()
{
	pliant_body_settings settings{};
	settings.group = btBroadphaseProxy::DefaultFilter;
	settings.mask = btBroadphaseProxy::AllFilter;
	settings.pose = kOrigin;
	settings.friction = 0.5;
	return settings;
}

/// Conversion of pliant_body_settings.
struct Taken
{
	pliant_body_settings full = defaultBody();
	Material material;
	Adaptivity adaptivity;
	Fracture fracture;
	btTransform pose;
};

Taken takeBody( const pliant_body_settings* given )
{
	Taken taken;
	const pliant_body_settings& full = taken.full;
	readSized( given, taken.full );
	taken.material = take<Material>( full.material, PLIANT_BAD_MATERIAL );
	taken.adaptivity = take<Adaptivity>( full.adaptivity );
	taken.fracture = take<Fracture>( full.fracture );
	taken.pose = takePose(
		full.pose, PLIANT_BAD_ARGUMENT, "pliant_body_settings::pose must be within 1e9 m, with a quaternion that is not zero." );
	rejectIf( !isWithin( full.friction, 0, kMostFriction ) || !isWithin( full.restitution, 0, 1 ), PLIANT_BAD_SETTINGS,
		"pliant_body_settings: friction must lie in 0 to 1e6, and restitution in 0 to 1." );
	userPointer( full.user_data );
	return taken;
}

/// Made, but in no world.
SoftBodyResult makeBody( const pliant_template& from, const Taken& taken )
{
	const pliant_body_settings& full = taken.full;
	SoftBodyResult made = SoftBody::create(
		from.shared, taken.pose, taken.material, taken.adaptivity, StiffnessField{ full.stiffness, full.stiffness_context } );
	if ( !made.ok() )
	{
		return made;
	}
	SoftBody& body = *made.value;
	if ( full.fracture )
	{
		made.status = body.setFracture( taken.fracture, ToughnessField{ full.toughness, full.toughness_context },
			ShardCentres{ full.shard_centres, full.shard_centre_count, full.shards } );
	}
	body.setFriction( btScalar( full.friction ) );
	body.setRestitution( btScalar( full.restitution ) );
	return made;
}

pliant_body_state inC( const SoftBody& body )
{
	pliant_body_state state{};
	state.nodes = body.nodeCount();
	state.cells = body.cellCount();
	state.links = body.linkCount();
	state.mass = double( body.mass() );
	state.mass_centre = vectorOf( body.massCentre() );
	state.linear_velocity = vectorOf( body.linearVelocity() );
	state.angular_velocity = vectorOf( body.angularVelocity() );
	state.angular_momentum = vectorOf( body.angularMomentum() );
	state.pose = poseOf( body.bestFitTransform() );
	state.fracture_version = body.fractureVersion();
	state.level_version = body.levelVersion();
	state.is_awake = body.isActive() ? 1 : 0;
	state.is_healthy = body.isHealthy() ? 1 : 0;
	state.is_rigid = body.isRigid() ? 1 : 0;
	state.fade_fraction = body.fadeFraction();
	return state;
}

/// Writes a vector of each node.
template <class F>
void writeNodes( const SoftBody& body, double* out, std::uint64_t capacity, std::uint64_t* count, F&& vectorOfNode )
{
	const int nodes = body.nodeCount();
	giveCount( std::uint64_t( nodes ), out, capacity, count );
	for ( int k = 0; k < nodes && std::uint64_t( k ) < capacity; ++k )
	{
		const btVector3 v = vectorOfNode( k );
		*out++ = double( v.x() );
		*out++ = double( v.y() );
		*out++ = double( v.z() );
	}
}

} // namespace

pliant_surface inC( const SurfaceView& view )
{
	pliant_surface c{};
	c.topology_version = view.topologyVersion;
	c.origin = vectorOf( view.origin );
	c.positions = view.positions;
	c.normals = view.normals;
	c.indices = view.indices;
	c.texture_coordinates = view.textureCoordinates;
	c.triangle_source = view.triangleSource;
	c.vertices = view.vertexCount;
	c.triangles = view.triangleCount;
	c.frame = view.frame;
	return c;
}

pliant_body_settings takeMembership( const pliant_body_settings* given )
{
	pliant_body_settings full = defaultBody();
	readSized( given, full );
	userPointer( full.user_data );
	return full;
}

void addMade( pliant_world& world, std::unique_ptr<SoftBody> body, const pliant_body_settings& full, pliant_id& made )
{
	SoftBody* const added = body.get();
	added->setUserPointer( userPointer( full.user_data ) );
	world.madeSoft.emplace( added, std::move( body ) );
	world.host->addSoftBody( added, full.group, full.mask );
	made = identityOf( *added );
}

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_body_settings_init( pliant_body_settings* settings, uint32_t size )
{
	return initSized( defaultBody(), settings, size );
}

pliant_result pliant_body_create( pliant_world* world, const pliant_template* from, const pliant_body_settings* settings, pliant_id* made )
{
	return withWorld( world, [&]( SoftBodyHost& ) {
		requirePointers( from, made );
		const Taken taken = takeBody( settings );
		SoftBodyResult body = makeBody( *from, taken );
		if ( body.ok() )
		{
			addMade( *world, std::move( body.value ), taken.full, *made );
		}
		return body.status;
	} );
}

pliant_result pliant_body_get_state( const pliant_world* world, pliant_id body, pliant_body_state* state, uint32_t size )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { writeSized( inC( soft ), state, size ); } );
}

pliant_result pliant_body_get_node( const pliant_world* world, pliant_id body, int32_t node, pliant_node* out, uint32_t size )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		requireNode( soft, node );
		pliant_node full{};
		full.level = soft.nodeLevel( node );
		full.position = vectorOf( soft.nodePosition( node ) );
		full.velocity = vectorOf( soft.nodeVelocity( node ) );
		full.mass = double( soft.nodeMass( node ) );
		full.radius = double( soft.nodeRadius( node ) );
		full.is_pinned = soft.isPinned( node ) ? 1 : 0;
		full.cell = soft.cellOfNode( node );
		writeSized( full, out, size );
	} );
}

pliant_result pliant_body_get_positions( const pliant_world* world, pliant_id body, double* positions, uint64_t capacity, uint64_t* count )
{
	return withSoft( world, body,
		[&]( SoftBody& soft ) { writeNodes( soft, positions, capacity, count, [&]( int node ) { return soft.nodePosition( node ); } ); } );
}

pliant_result pliant_body_get_velocities(
	const pliant_world* world, pliant_id body, double* velocities, uint64_t capacity, uint64_t* count )
{
	return withSoft( world, body,
		[&]( SoftBody& soft ) { writeNodes( soft, velocities, capacity, count, [&]( int node ) { return soft.nodeVelocity( node ); } ); } );
}

pliant_result pliant_body_get_nearest_node( const pliant_world* world, pliant_id body, pliant_vec3 point, int32_t* node )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		requirePointers( node );
		rejectIf( !isNumber( vectorOf( point ) ), PLIANT_BAD_ARGUMENT, "A coordinate is not finite." );
		*node = soft.nearestNode( vectorOf( point ) );
	} );
}

pliant_result pliant_body_get_surface( const pliant_world* world, pliant_id body, pliant_surface* surface, uint32_t size )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		requireSized( surface, size );
		writeSized( inC( soft.surface() ), surface, size );
	} );
}

pliant_result pliant_body_get_material( const pliant_world* world, pliant_id body, pliant_material* material, uint32_t size )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { writeSized( inC<pliant_material>( soft.material() ), material, size ); } );
}

pliant_result pliant_body_get_fracture( const pliant_world* world, pliant_id body, pliant_fracture* fracture, uint32_t size )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { writeSized( inC<pliant_fracture>( soft.fracture() ), fracture, size ); } );
}

pliant_result pliant_body_get_adaptivity( const pliant_world* world, pliant_id body, pliant_adaptivity* adaptivity, uint32_t size )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { writeSized( inC<pliant_adaptivity>( soft.adaptivity() ), adaptivity, size ); } );
}

pliant_result pliant_body_get_node_of_cell( const pliant_world* world, pliant_id body, int32_t cell, int32_t* node )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { give( std::int32_t( soft.nodeOfCell( cell ) ), node ); } );
}
