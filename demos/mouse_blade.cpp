// +-----------------------------------------------------------------------------------------------------------------+
// | The blade's edge is the ray under the mouse; from one picture to the next it sweeps over one or two triangles.    |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/mouse_blade.h"

namespace pliant_demos {

namespace {

constexpr btScalar kReach = btScalar( 100 ); // m

} // namespace

int MouseBlade::move( const btVector3& from, const btVector3& direction )
{
	const btVector3 to = from + direction * kReach;
	int links = 0;
	for ( int i = 0; m_isDown && i < m_world.softBodyCount(); ++i )
	{
		links += m_world.softBody( i )->cutSweep( m_from, m_to, from, to );
	}
	m_from = from;
	m_to = to;
	m_isDown = true;
	return links;
}

} // namespace pliant_demos
