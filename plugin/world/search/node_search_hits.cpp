// Corrections of a search's hits before they become contacts: characters, new nodes, flat seams, order.

#include "world/search/node_search.h"

#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <algorithm>
#include <tuple>

namespace pliant {

// A character sets its own position, against any force: if nodes were pushed out of a character they carry, they would yield, the character
// would follow, and so on down to the floor. They may penetrate it as deep as it penetrates them, without a force. Nodes at its sides are
// pushed out at the rate of rigid bodies in Bullet's world, which takes one step where explicit bodies take several, and deeper penetration
// adds no velocity.
void NodeSearch::adjustForCharacter()
{
	for ( NodeHit& hit : m_hits )
	{
		const double radius = double( m_soft->impl().shape->sphereOfNode( hit.node() )->getRadius() ), depth = radius - hit.touch.distance;
		if ( hit.touch.normal.dot( m_characters.up ) < -kCarrySlope )
		{
			hit.touch.distance += m_characters.allowance;
		}
		else if ( depth > 0.0 )
		{
			// Its sweeps stop at the drawn surface, which is higher than the nodes' spheres between them.
			const double hollow = hit.touch.reach < 0.0 ? kHollowDepth * radius : 0.0;
			const double pushed = ( std::min( depth, m_characters.allowance ) + hollow ) * std::min( 1.0, m_step / m_characters.gameStep );
			hit.touch.distance += depth - pushed;
		}
	}
}

// Contacts of new nodes within their allowance count as just touching.
void NodeSearch::applyAllowances( const SoftBody& first, const SoftBody* second )
{
	PenetrationAllowance &own = first.impl().allowance, &others = second ? second->impl().allowance : own;
	if ( !own.isAny() && !others.isAny() )
	{
		return;
	}
	for ( NodeHit& hit : m_hits )
	{
		const double depth = double( first.impl().shape->sphereOfNode( hit.node() )->getRadius() ) - hit.touch.distance;
		if ( depth > 0.0 )
		{
			const double allowed = own.allowedDepth( hit.node(), depth );
			hit.touch.distance += second ? std::max( allowed, others.allowedDepth( hit.other(), depth ) ) : allowed;
		}
	}
}

void NodeSearch::sortHits()
{
	const auto isBefore = []( const NodeHit& a, const NodeHit& b ) {
		return std::tie( a.key, a.touch.distance, a.part, a.index ) < std::tie( b.key, b.touch.distance, b.part, b.index );
	};
	if ( !std::is_sorted( m_hits.begin(), m_hits.end(), isBefore ) )
	{
		std::sort( m_hits.begin(), m_hits.end(), isBefore );
	}
}

// A sphere on a flat mesh is nearest to one triangle's face and to its neighbours' edges. An edge that does not protrude from the plane of
// a nearer touch is no obstacle of its own; it would trip the node at every seam.
void NodeSearch::dropFlatNeighbours()
{
	const SoftBody::Impl& impl = m_soft->impl();
	std::size_t kept = 0, groupStart = 0;
	for ( std::size_t k = 0; k < m_hits.size(); ++k )
	{
		const NodeHit hit = m_hits[k];
		if ( kept == 0 || m_hits[kept - 1].key != hit.key )
		{
			groupStart = kept;
		}
		bool isNew = kept - groupStart < MANIFOLD_CACHE_SIZE;
		for ( std::size_t g = groupStart; isNew && g < kept; ++g )
		{
			const Touch& nearer = m_hits[g].touch;
			const double radius = double( impl.shape->sphereOfNode( hit.node() )->getRadius() );
			const Vec3d apart = hit.touch.otherPoint( radius ) - nearer.otherPoint( radius );
			isNew = apart.dot( nearer.normal ) > kContactSlop * radius;
		}
		if ( isNew )
		{
			m_hits[kept++] = hit;
		}
	}
	m_hits.resize( kept );
}

} // namespace pliant
