#pragma once

// Lattice links and pins through the game's own btIDebugDraw; the node spheres come from Bullet, as the shape is a compound.

class btIDebugDraw;

namespace pliant {

class SoftBodySystem;

void drawSoftBodies( const SoftBodySystem& bodies, btIDebugDraw& drawer );

} // namespace pliant
