#pragma once

// Queries of the surface and the volume of a soft body in its present shape. pliant/game/queries.h describes them.

#include "pliant/c/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/// A copy of a body's surface; the body may move and be destroyed afterwards. Destroy it by pliant_query_destroy.
typedef struct pliant_query pliant_query;

/// The point of a surface that is nearest to another point.
typedef struct pliant_nearest_point
{
	uint32_t size;      ///< of the structure, bytes
	int32_t node;       ///< the body's node nearest to the surface point
	pliant_vec3 point;  ///< world, m
	pliant_vec3 normal; ///< outwards, of unit length
	double distance;    ///< m; negative where the other point is inside of the body
	int32_t triangle;   ///< of the drawn surface; -1 where the surface is that of the cells
	int32_t reserved;   ///< 0
} pliant_nearest_point;

/// Volume and area of a surface.
typedef struct pliant_measures
{
	uint32_t size;    ///< of the structure, bytes
	int32_t is_drawn; ///< flag: the drawn surface is used, not that of the cells
	double volume;    ///< inside, without cavities, m^3
	double area;      ///< m^2
} pliant_measures;

/// Copies the surface of a body: once a step, for many queries. `made`: to be destroyed by the caller.
PLIANT_API pliant_result pliant_query_create( const pliant_world* world, pliant_id body, pliant_query** made );
/// Destroys a query. Null is ignored.
PLIANT_API void pliant_query_destroy( pliant_query* query );

/// The surface point nearest to a point, world, m. `size`: sizeof( pliant_nearest_point ).
PLIANT_API pliant_result pliant_query_get_nearest(
	const pliant_query* query, pliant_vec3 point, pliant_nearest_point* nearest, uint32_t size );
/// Whether a point, world, m, is in the body's material: 1 or 0. A cavity is not.
PLIANT_API pliant_result pliant_query_get_inside( const pliant_query* query, pliant_vec3 point, int32_t* is_inside );
/// Whether a sphere, centre world, m, radius 0 and above, touches the body or is inside of it: 1 or 0.
PLIANT_API pliant_result pliant_query_get_touching( const pliant_query* query, pliant_vec3 centre, double radius, int32_t* is_touching );
/// Volume and area. `size`: sizeof( pliant_measures ).
PLIANT_API pliant_result pliant_query_get_measures( const pliant_query* query, pliant_measures* measures, uint32_t size );

#ifdef __cplusplus
}
#endif
