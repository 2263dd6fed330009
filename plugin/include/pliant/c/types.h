#pragma once

// Common to all C headers: results, identities, vectors, and how structures grow. Plain C99 and later, callable from any language with a
// foreign function interface; no type of C++ and none of Bullet's.
//
// - Every call that can be refused returns a pliant_result. A refused call changes nothing, and pliant_last_error has a sentence on it.
//   Null pointers, identities of objects that are gone, numbers that are NaN or infinite and indices out of range are refused, not
//   followed. A pointer to a world, a template or a buffer that has been destroyed is the one thing that cannot be told.
// - Objects in a world have numbers (pliant_id), which name nothing else later: a fragment that has faded is refused by its number.
// - What is a btScalar in C++ is a double here, whatever Bullet's precision; settings, meshes and skins are floats, as they are there.
// - Structures that may grow begin with their size, as the caller was compiled; their _init functions set it and the defaults.
// - Out parameters are written only where the call returns PLIANT_OK. Those marked "may be null" may be null.
// - A world is used from one thread at a time. Nothing throws.

#include "pliant/export.h"

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Why a call was refused: the values of pliant::ResultCode. See pliant/result.h.
enum
{
	PLIANT_OK = 0,              ///< carried out
	PLIANT_EMPTY_MESH,          ///< the mesh has no vertex or no triangle
	PLIANT_NON_FINITE_VERTEX,   ///< a vertex coordinate is NaN or infinite
	PLIANT_INDEX_OUT_OF_RANGE,  ///< a triangle refers to a vertex that does not exist
	PLIANT_EXTENT_OUT_OF_RANGE, ///< the mesh is too small or too large at the requested cell size
	PLIANT_ZERO_VOLUME,         ///< no triangle has an area; or no inside was found
	PLIANT_TOO_MANY_TRIANGLES,  ///< more than pliant_lattice_settings::max_triangles
	PLIANT_TOO_MANY_CELLS,      ///< more than pliant_lattice_settings::max_cells
	PLIANT_OUT_OF_MEMORY,       ///< memory did not suffice
	PLIANT_CANCELLED,           ///< the progress callback returned 0
	PLIANT_BAD_SETTINGS,        ///< a value of a structure of settings is out of its range
	PLIANT_BAD_MATERIAL,        ///< a value of a material is out of its range, or does not go with another or with the body
	PLIANT_BAD_ARGUMENT,        ///< any other argument is invalid, or this build lacks a feature
	PLIANT_TOO_FOLDED,          ///< no cell size separates the layers of the surface
	PLIANT_BAD_SNAPSHOT,        ///< the data is no snapshot of this kind, damaged, newer, or does not go with the world
	PLIANT_NO_SUCH_OBJECT = 100 ///< an identity names nothing in this world: the object is gone, or was never there
};
/// One of the values above.
typedef int32_t pliant_result;

/// The identity of a soft or rigid body in one world: never 0. No other object has it in the life of the world, but for what a restored
/// world does again: it gives the same identities again. Worlds in which the same was done give the same identities.
typedef uint64_t pliant_id;

/// A world, made by pliant_world_create or pliant_world_wrap, ended by pliant_world_destroy.
typedef struct pliant_world pliant_world;
/// A mesh converted into cells, shared by any number of bodies of any worlds. Ended by pliant_template_release, at any time: bodies keep
/// what they need.
typedef struct pliant_template pliant_template;
/// Bytes that the library owns, made by pliant_buffer_create, ended by pliant_buffer_destroy.
typedef struct pliant_buffer pliant_buffer;

/// A vector; its unit is said where it is used.
typedef struct pliant_vec3
{
	double x; ///< first component
	double y; ///< second component
	double z; ///< third component
} pliant_vec3;

/// A position and an orientation: the transform that turns by `rotation` and then moves by `position`.
typedef struct pliant_pose
{
	pliant_vec3 position; ///< m, at most 1e9 along an axis
	double rotation[4];   ///< a quaternion x, y, z, w; of any length but 0
} pliant_pose;

/// A part of the library that a build can leave out: the values of pliant::Feature.
enum
{
	PLIANT_FEATURE_FRACTURE = 0,  ///< breaking and cutting
	PLIANT_FEATURE_LEVELS,        ///< levels of detail
	PLIANT_FEATURE_PLASTICITY,    ///< pliant_material::yield_strain
	PLIANT_FEATURE_SURFACE,       ///< skins and drawn cracks
	PLIANT_FEATURE_FAR_LEVELS,    ///< pliant_material::far_levels
	PLIANT_FEATURE_CLUSTERS,      ///< the methods of clusters
	PLIANT_FEATURE_SELF_COLLISION ///< pliant_body_set_self_collision
};

/// The sentence on the last call of this thread that was refused, in English, for the developer; empty before the first. Never null. Valid
/// until the next call of this thread that is refused.
PLIANT_API const char* pliant_last_error( void );
/// The name of a result, e.g. "TooManyCells"; "unknown" for another value. Never null; valid always.
PLIANT_API const char* pliant_result_name( pliant_result result );

/// The library's version: 65536 times the major number, plus 256 times the minor one, plus the patch number.
PLIANT_API uint32_t pliant_version( void );
/// Whether the library has a feature, one of PLIANT_FEATURE_...: 1 or 0. 0 for another value.
PLIANT_API int32_t pliant_has_feature( int32_t feature );
/// Size of Bullet's numbers in this library, bytes: 4 or 8.
PLIANT_API int32_t pliant_bullet_scalar_size( void );

/// Makes an empty buffer. `buffer`: where to put it; the caller's to destroy.
PLIANT_API pliant_result pliant_buffer_create( pliant_buffer** buffer );
/// Its bytes, valid until it is written again or destroyed. Null where it is empty or null.
PLIANT_API const void* pliant_buffer_data( const pliant_buffer* buffer );
/// The number of its bytes; 0 for null.
PLIANT_API uint64_t pliant_buffer_size( const pliant_buffer* buffer );
/// Ends it. Null is ignored.
PLIANT_API void pliant_buffer_destroy( pliant_buffer* buffer );

#ifdef __cplusplus
}
#endif
