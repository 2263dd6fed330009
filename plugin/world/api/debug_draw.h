#pragma once

// Draws soft bodies with Bullet's debug drawer.

class btCollisionShape;
class btIDebugDraw;
class btVector3;

namespace pliant {

class SoftBodySystem;

/// Draws the soft body that has this shape in wireframe: the links of its surface. Returns false if no soft body has it.
bool drawSoftBody( const SoftBodySystem& bodies, const btCollisionShape* shape, const btVector3& colour, btIDebugDraw& drawer );

/// Draws a cross at each pinned node, with DBG_DrawConstraints.
void drawPins( const SoftBodySystem& bodies, btIDebugDraw& drawer );

} // namespace pliant
