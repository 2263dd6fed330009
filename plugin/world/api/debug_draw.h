#pragma once

// What Bullet's debug drawer is shown of soft bodies.

class btCollisionShape;
class btIDebugDraw;
class btVector3;

namespace pliant {

class SoftBodySystem;

/// The soft body whose shape that is, in wireframe: the links of its surface. False where the shape is no soft body's.
bool drawSoftBody( const SoftBodySystem& bodies, const btCollisionShape* shape, const btVector3& colour, btIDebugDraw& drawer );

/// A cross at each pinned node, with DBG_DrawConstraints.
void drawPins( const SoftBodySystem& bodies, btIDebugDraw& drawer );

} // namespace pliant
