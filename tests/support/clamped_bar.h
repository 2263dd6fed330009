#pragma once

// A bar of 30 x 6 x 6 cells of 0.1 m along x whose ends are held and moved.

#include "body/body.h"
#include "support/block_body.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace pliant::test {

class ClampedBar
{
public:
	explicit ClampedBar( const Material& material ) : m_body( makeBlock( 30, 6, 6, 0.1f, material ) )
	{
		for ( int i = 0; i < m_body->nodeCount(); ++i )
		{
			m_body->setPinned( i, isHeld( i ) );
		}
	}
	Body& body() { return *m_body; }
	const NodeState& nodes() const { return m_body->nodes(); }

	/// Calls `substep` so many times; the clamps reach `stretch` times their distance at rest after a third of them.
	template <class Substep>
	void pull( double stretch, int steps, const Substep& substep )
	{
		for ( int k = 0; k < steps; ++k )
		{
			moveClamps( 1.0 + ( stretch - 1.0 ) * std::min( 1.0, 3.0 * k / steps ) );
			substep();
		}
	}

private:
	bool isHeld( int node ) const { return std::abs( nodes().x0.x[node] ) > 1.4f; }
	void moveClamps( double stretch )
	{
		NodeState& nodes = m_body->nodes();
		for ( int i = 0; i < nodes.count; ++i )
		{
			if ( isHeld( i ) )
			{
				const Vec3d x0 = nodes.x0.get( i ).cast<double>();
				nodes.x.set( i, ( Vec3d( stretch * x0.x(), x0.y(), x0.z() ) - nodes.origin ).cast<float>() );
			}
		}
	}

	std::unique_ptr<Body> m_body;
};

/// Mean stretch of a bar along each axis, from the nodes of a slab of 1 m in its middle, away from the loaded ends.
inline Vec3d middleStretch( const NodeState& nodes )
{
	Vec3d moment = Vec3d::Zero(), rest = Vec3d::Zero();
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3d x0 = nodes.x0.get( i ).cast<double>();
		if ( std::abs( x0.x() ) < 0.5 )
		{
			moment += nodes.worldPosition( i ).cwiseProduct( x0 );
			rest += x0.cwiseAbs2();
		}
	}
	return moment.cwiseQuotient( rest );
}

} // namespace pliant::test
