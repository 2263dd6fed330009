// Soft bodies get other settings, and are cut.

#include "c/handles.h"
#include "c/numbers.h"
#include "c/settings.h"
#include "pliant/build.h"
#include "pliant/c/body.h"
#include "pliant/c/rigid.h"

namespace pliant::c {

namespace {

void requireGood( bool isGood )
{
	rejectIf( !isGood, PLIANT_BAD_ARGUMENT, "A number is not finite or out of its range." );
}

/// Cuts where all numbers are good: `work( SoftBody& )` returns a number of links.
template <class F>
pliant_result cut( bool isGood, pliant_world* world, pliant_id body, std::int32_t* links, F&& work )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		requireGood( isGood );
		rejectIf( !hasFeature( Feature::Fracture ), PLIANT_BAD_ARGUMENT, "This build has been made with PLIANT_WITH_FRACTURE=OFF." );
		offer( work( soft ), links );
	} );
}

bool isGood( const pliant_vec3& v )
{
	return isNumber( vectorOf( v ) );
}

bool isAboveZero( double x )
{
	return std::isfinite( btScalar( x ) ) && btScalar( x ) > 0;
}

} // namespace

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_body_set_material( pliant_world* world, pliant_id body, const pliant_material* material )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		requirePointers( material );
		return soft.setMaterial( take<Material>( material, PLIANT_BAD_MATERIAL ) );
	} );
}

pliant_result pliant_body_set_fracture( pliant_world* world, pliant_id body, const pliant_fracture* fracture )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		requirePointers( fracture );
		return soft.setFracture( take<Fracture>( fracture ) );
	} );
}

pliant_result pliant_body_prepare_cracks( pliant_world* world, pliant_id body )
{
	return withSoft( world, body, []( SoftBody& soft ) { return soft.prepareCracks(); } );
}

pliant_result pliant_body_request_refinement( pliant_world* world, pliant_id body, pliant_vec3 low, pliant_vec3 high )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		requireGood( isGood( low ) && isGood( high ) );
		soft.requestRefinement( vectorOf( low ), vectorOf( high ) );
	} );
}

pliant_result pliant_body_set_finest_level( pliant_world* world, pliant_id body, int32_t level )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		rejectIf( level < 0 || level > soft.adaptivity().coarseLevels, PLIANT_BAD_ARGUMENT,
			"The level must lie in 0 to the body's coarse_levels." );
		soft.setFinestLevel( level );
	} );
}

pliant_result pliant_body_set_self_collision( pliant_world* world, pliant_id body, int32_t is_on )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { return soft.setSelfCollision( is_on != 0 ); } );
}

pliant_result pliant_body_set_contact_events( pliant_world* world, pliant_id body, int32_t is_on )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { soft.setContactEvents( is_on != 0 ); } );
}

pliant_result pliant_body_set_interpolation( pliant_world* world, pliant_id body, int32_t is_on )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { soft.setInterpolation( is_on != 0 ); } );
}

pliant_result pliant_body_set_surface_tolerance( pliant_world* world, pliant_id body, double cells )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		requireGood( std::isfinite( cells ) && cells >= 0 );
		soft.setSurfaceTolerance( btScalar( cells ) );
	} );
}

pliant_result pliant_body_set_kind( pliant_world* world, pliant_id body, int32_t kind )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		requireGood( kind >= PLIANT_RIGID_DYNAMIC && kind <= PLIANT_RIGID_KINEMATIC );
		constexpr int kHeld = btCollisionObject::CF_STATIC_OBJECT | btCollisionObject::CF_KINEMATIC_OBJECT;
		const int flag = kind == PLIANT_RIGID_STATIC ? btCollisionObject::CF_STATIC_OBJECT
			: kind == PLIANT_RIGID_KINEMATIC         ? btCollisionObject::CF_KINEMATIC_OBJECT
													 : 0;
		soft.setCollisionFlags( ( soft.getCollisionFlags() & ~kHeld ) | flag );
		soft.activate( true );
	} );
}

pliant_result pliant_body_set_kept( pliant_world* world, pliant_id body, int32_t is_kept )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { soft.setKept( is_kept != 0 ); } );
}

pliant_result pliant_body_cut_plane(
	pliant_world* world, pliant_id body, pliant_vec3 point, pliant_vec3 normal, double radius, int32_t* links )
{
	const bool isPlane = isGood( point ) && isGood( normal ) && isAboveZero( double( vectorOf( normal ).length2() ) );
	return cut( isPlane && radius > 0, world, body, links,
		[&]( SoftBody& soft ) { return soft.cutPlane( vectorOf( point ), vectorOf( normal ), btScalar( radius ) ); } );
}

pliant_result pliant_body_cut_sphere( pliant_world* world, pliant_id body, pliant_vec3 centre, double radius, int32_t* links )
{
	return cut( isGood( centre ) && isAboveZero( radius ), world, body, links,
		[&]( SoftBody& soft ) { return soft.cutSphere( vectorOf( centre ), btScalar( radius ) ); } );
}

pliant_result pliant_body_cut_sweep( pliant_world* world, pliant_id body, const pliant_vec3* corners, int32_t* links )
{
	const bool areGood = corners && isGood( corners[0] ) && isGood( corners[1] ) && isGood( corners[2] ) && isGood( corners[3] );
	return cut( areGood, world, body, links, [&]( SoftBody& soft ) {
		return soft.cutSweep( vectorOf( corners[0] ), vectorOf( corners[1] ), vectorOf( corners[2] ), vectorOf( corners[3] ) );
	} );
}

pliant_result pliant_body_heal( pliant_world* world, pliant_id body, double reach, int32_t* links )
{
	return cut( isAboveZero( reach ), world, body, links, [&]( SoftBody& soft ) { return soft.heal( btScalar( reach ) ); } );
}
