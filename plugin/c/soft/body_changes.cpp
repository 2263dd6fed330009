// Soft bodies get other settings, and are cut.

#include "c/handles.h"
#include "c/numbers.h"
#include "c/settings.h"
#include "pliant/build.h"
#include "pliant/c/body.h"
#include "pliant/c/rigid.h"

namespace pliant::c {

namespace {

/// Calls `work( SoftBody& )` where all numbers are good.
template <class F>
pliant_result withGood( bool isGood, pliant_world* world, pliant_id body, F&& work )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		if ( !isGood )
		{
			return refuse( PLIANT_BAD_ARGUMENT, "A number is not finite or out of its range." );
		}
		work( soft );
		return pliant_result( PLIANT_OK );
	} );
}

/// The same for a cut, which returns a number of links.
template <class F>
pliant_result cut( bool isGood, pliant_world* world, pliant_id body, std::int32_t* links, F&& work )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		if ( !isGood )
		{
			return refuse( PLIANT_BAD_ARGUMENT, "A number is not finite or out of its range." );
		}
		if ( !hasFeature( Feature::Fracture ) )
		{
			return refuse( PLIANT_BAD_ARGUMENT, "This build has been made with PLIANT_WITH_FRACTURE=OFF." );
		}
		const int count = work( soft );
		links ? void( *links = count ) : void();
		return pliant_result( PLIANT_OK );
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
		Material taken;
		const pliant_result code = material ? take( material, taken ) : refuseNull();
		return code == PLIANT_OK ? resultOf( soft.setMaterial( taken ) ) : code;
	} );
}

pliant_result pliant_body_set_fracture( pliant_world* world, pliant_id body, const pliant_fracture* fracture )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		Fracture taken;
		const pliant_result code = fracture ? take( fracture, taken ) : refuseNull();
		return code == PLIANT_OK ? resultOf( soft.setFracture( taken ) ) : code;
	} );
}

pliant_result pliant_body_prepare_cracks( pliant_world* world, pliant_id body )
{
	return withSoft( world, body, []( SoftBody& soft ) { return resultOf( soft.prepareCracks() ); } );
}

pliant_result pliant_body_request_refinement( pliant_world* world, pliant_id body, pliant_vec3 low, pliant_vec3 high )
{
	return withGood( isGood( low ) && isGood( high ), world, body,
		[&]( SoftBody& soft ) { soft.requestRefinement( vectorOf( low ), vectorOf( high ) ); } );
}

pliant_result pliant_body_set_finest_level( pliant_world* world, pliant_id body, int32_t level )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		if ( level < 0 || level > soft.adaptivity().coarseLevels )
		{
			return refuse( PLIANT_BAD_ARGUMENT, "The level must lie in 0 to the body's coarse_levels." );
		}
		soft.setFinestLevel( level );
		return pliant_result( PLIANT_OK );
	} );
}

pliant_result pliant_body_set_self_collision( pliant_world* world, pliant_id body, int32_t is_on )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { return resultOf( soft.setSelfCollision( is_on != 0 ) ); } );
}

pliant_result pliant_body_set_contact_events( pliant_world* world, pliant_id body, int32_t is_on )
{
	return withGood( true, world, body, [&]( SoftBody& soft ) { soft.setContactEvents( is_on != 0 ); } );
}

pliant_result pliant_body_set_interpolation( pliant_world* world, pliant_id body, int32_t is_on )
{
	return withGood( true, world, body, [&]( SoftBody& soft ) { soft.setInterpolation( is_on != 0 ); } );
}

pliant_result pliant_body_set_surface_tolerance( pliant_world* world, pliant_id body, double cells )
{
	return withGood(
		std::isfinite( cells ) && cells >= 0, world, body, [&]( SoftBody& soft ) { soft.setSurfaceTolerance( btScalar( cells ) ); } );
}

pliant_result pliant_body_set_kind( pliant_world* world, pliant_id body, int32_t kind )
{
	const bool isKind = kind >= PLIANT_RIGID_DYNAMIC && kind <= PLIANT_RIGID_KINEMATIC;
	return withGood( isKind, world, body, [&]( SoftBody& soft ) {
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
	return withGood( true, world, body, [&]( SoftBody& soft ) { soft.setKept( is_kept != 0 ); } );
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
