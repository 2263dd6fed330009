#pragma once

// Debug drawing: what btDiscreteDynamicsWorld::debugDrawWorld draws, as lines. pliant/game/debug_draw.h says more.

#include "pliant/c/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/// What is drawn. Flags are 0 or 1.
typedef struct pliant_debug_drawing
{
	uint32_t size;             ///< of the structure, bytes
	int32_t bullet_mode;       ///< flags of btIDebugDraw::DebugDrawModes. Default 2049: wireframes and joints. Boxes are 2, contacts 8.
	int32_t surface_links;     ///< flag: the links between neighbours at the surface. Default 1.
	int32_t links;             ///< flag: all links, grey. Default 0.
	int32_t cells;             ///< flag: the outlines of the faces of the cells' surface, white. Default 0.
	int32_t strain;            ///< flag: surface links coloured by their stretch. Default 0.
	int32_t levels;            ///< flag: a sphere at each node, coloured by its level. Default 0.
	int32_t regions;           ///< flag: the axes of each node's region. Default 0.
	int32_t pins;              ///< flag: a cross at each pinned node. Default 1.
	int32_t attachments;       ///< flag: a line between the two points of each attachment, and its force. Default 0.
	int32_t contacts;          ///< flag: the impulse of each contact, where `bullet_mode` has contacts. Default 0.
	int32_t reserved;          ///< 0
	double full_strain;        ///< stretch of the full colours, above 0. Default .1.
	double metres_per_newton;  ///< length of the forces of attachments. Default .01.
	double metres_per_impulse; ///< length of the impulses of contacts, m / (N s). Default .1.
} pliant_debug_drawing;

/// Draws a line: two points in world coordinates, m, and a colour, red, green and blue from 0 to 1; 3 numbers each. It must not call
/// functions of this library.
typedef void ( *pliant_draw_line )( const double* from, const double* to, const double* colour, void* context );

/// Fills the structure with the defaults. `size`: sizeof( pliant_debug_drawing ).
PLIANT_API pliant_result pliant_debug_drawing_init( pliant_debug_drawing* drawing, uint32_t size );

/// Draws the soft and rigid bodies of a world between steps. `drawing`: may be null: the defaults. Errors: PLIANT_BAD_ARGUMENT, also for a
/// `full_strain` not above 0 and numbers that are not finite.
PLIANT_API pliant_result pliant_world_draw(
	pliant_world* world, const pliant_debug_drawing* drawing, pliant_draw_line line, void* context );

#ifdef __cplusplus
}
#endif
