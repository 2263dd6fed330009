#pragma once

// Parts of soft bodies that debugDrawWorld draws.

#include <LinearMath/btScalar.h>

namespace pliant {

/// Parts of soft bodies that debugDrawWorld draws (SoftBodyHost::setDebugDrawing). Parts that are off cost nothing. Bodies are drawn with
/// btIDebugDraw::DBG_DrawWireframe, pins and attachments with DBG_DrawConstraints, contacts with DBG_DrawContactPoints.
struct DebugDrawing
{
	bool surfaceLinks = true; ///< the links between neighbours at the surface, in the colour that Bullet gives
	bool links = false;       ///< all links, grey
	bool cells = false;       ///< the outlines of the faces of the cells' surface, white
	bool strain = false;  ///< surface links by their stretch, instead of in one colour: blue compressed, green as at rest, red stretched
	bool levels = false;  ///< a sphere at each node by its level: red the finest, then yellow, green, blue
	bool regions = false; ///< the axes of each node's region: its rotation
	bool pins = true;     ///< a cross at each pinned node
	bool attachments = false;                    ///< a line between the two points of each attachment, yellow, and its force
	bool contacts = false;                       ///< at each contact its impulse along the normal, on the soft body
	btScalar fullStrain = btScalar( 0.1 );       ///< stretch of the full colours; 0 and below count as the default
	btScalar metresPerNewton = btScalar( 0.01 ); ///< length of the forces of attachments
	btScalar metresPerImpulse = btScalar( 0.1 ); ///< length of the impulses of contacts, m / (N s)
};

} // namespace pliant
