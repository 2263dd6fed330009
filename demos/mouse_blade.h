#pragma once

// Cuts soft bodies along the path of the mouse, through everything under it.

#include <pliant/soft_body_world.h>

namespace pliant_demos {

class MouseBlade
{
public:
	explicit MouseBlade( pliant::SoftBodyWorld& world ) : m_world( world ) {}

	/// The ray under the mouse: bodies are cut between it and the previous ray. Returns the number of links that were cut.
	int move( const btVector3& from, const btVector3& direction );
	/// The next ray begins a new cut.
	void lift() { m_isDown = false; }

private:
	pliant::SoftBodyWorld& m_world;
	btVector3 m_from = btVector3( 0, 0, 0 ), m_to = btVector3( 0, 0, 0 ); ///< the previous ray
	bool m_isDown = false;
};

} // namespace pliant_demos
