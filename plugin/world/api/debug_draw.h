#pragma once

// Draws soft bodies with Bullet's debug drawer.

#include "pliant/game/debug_draw.h"

class btCollisionShape;
class btIDebugDraw;
class btVector3;

namespace pliant {

class SoftBodySystem;

/// Draws the soft body that has this shape in wireframe. Returns false if no soft body has it.
bool drawSoftBody(
	const SoftBodySystem& bodies, const btCollisionShape* shape, const btVector3& colour, btIDebugDraw& drawer, const DebugDrawing& what );

/// Draws the parts outside of bodies: pins, attachments, contacts.
void drawBetweenBodies( const SoftBodySystem& bodies, btIDebugDraw& drawer, const DebugDrawing& what );

} // namespace pliant
