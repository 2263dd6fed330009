// Queries of surfaces and volumes.

#include "pliant/c/query.h"
#include "c/handles.h"
#include "c/numbers.h"
#include "pliant/game/queries.h"

struct pliant_query
{
	explicit pliant_query( const pliant::SoftBody& body ) : surface( body ) {}
	pliant::SurfaceQuery surface;
};

namespace pliant::c {

namespace {

/// Calls `work( const SurfaceQuery& )` if the point is finite.
template <class F>
pliant_result ask( const pliant_query* query, const pliant_vec3& point, F&& work )
{
	return call( [&]() {
		requirePointers( query );
		rejectIf( !isNumber( vectorOf( point ) ), PLIANT_BAD_ARGUMENT, "A coordinate is not finite." );
		work( query->surface );
	} );
}

} // namespace

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_query_create( const pliant_world* world, pliant_id body, pliant_query** made )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		requirePointers( made );
		*made = new pliant_query( soft );
	} );
}

void pliant_query_destroy( pliant_query* query )
{
	delete query;
}

pliant_result pliant_query_get_nearest( const pliant_query* query, pliant_vec3 point, pliant_nearest_point* nearest, uint32_t size )
{
	return ask( query, point, [&]( const SurfaceQuery& surface ) {
		const NearestPoint found = surface.nearest( vectorOf( point ) );
		pliant_nearest_point full{};
		full.node = found.node;
		full.point = vectorOf( found.point );
		full.normal = vectorOf( found.normal );
		full.distance = double( found.distance );
		full.triangle = found.triangle;
		writeSized( full, nearest, size );
	} );
}

pliant_result pliant_query_get_inside( const pliant_query* query, pliant_vec3 point, int32_t* is_inside )
{
	return ask( query, point,
		[&]( const SurfaceQuery& surface ) { give( std::int32_t( surface.isInside( vectorOf( point ) ) ? 1 : 0 ), is_inside ); } );
}

pliant_result pliant_query_get_touching( const pliant_query* query, pliant_vec3 centre, double radius, int32_t* is_touching )
{
	return ask( query, centre, [&]( const SurfaceQuery& surface ) {
		rejectIf( !isWithin( radius, 0, kMostPosition ), PLIANT_BAD_ARGUMENT, "The radius must be 0 to 1e9 m." );
		give( std::int32_t( surface.touchesSphere( vectorOf( centre ), btScalar( radius ) ) ? 1 : 0 ), is_touching );
	} );
}

pliant_result pliant_query_get_measures( const pliant_query* query, pliant_measures* measures, uint32_t size )
{
	return ask( query, pliant_vec3{ 0, 0, 0 }, [&]( const SurfaceQuery& surface ) {
		pliant_measures full{};
		full.is_drawn = surface.isDrawn() ? 1 : 0;
		full.volume = double( surface.volume() );
		full.area = double( surface.area() );
		writeSized( full, measures, size );
	} );
}
