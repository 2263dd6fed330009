// Cutting and healing: converts cuts in world coordinates to the links that they break. Steinemann et al. 2008, section 5.1.

#include "fracture/cut_links.h"
#include "pliant/body_template.h"
#include "world/bodies/soft_body_impl.h"

#include <cmath>
#include <new>

namespace pliant {

namespace {

/// Returns the cut relative to the nodes' origin.
PlaneCut moved( PlaneCut cut, const Vec3d& origin )
{
	cut.point -= origin;
	return cut;
}

SphereCut moved( SphereCut cut, const Vec3d& origin )
{
	cut.centre -= origin;
	return cut;
}

BladeCut moved( const BladeCut& cut, const Vec3d& origin )
{
	return BladeCut{ cut.p0 - origin, cut.p1 - origin, cut.q0 - origin, cut.q1 - origin };
}

/// Returns, for each cell at an end of a link, the rotation of its node; other cells are not set.
std::vector<Eigen::Quaternionf> cellRotations( const Body& body, const std::vector<CellLink>& links )
{
	std::vector<float> ofNode( 4 * std::size_t( body.nodeCount() ) );
	body.nodeRotations( ofNode.data() );
	std::vector<Eigen::Quaternionf> rotations( std::size_t( body.lattice().cellCount() ) );
	for ( const CellLink& link : links )
	{
		for ( const std::uint32_t cell : { link.a, link.b } )
		{
			rotations[cell] = Eigen::Map<const Eigen::Quaternionf>( ofNode.data() + 4 * std::size_t( body.nodeOfCell( cell ) ) );
		}
	}
	return rotations;
}

template <class Cut>
int cutBody( SoftBody& soft, const Cut& cut )
{
	try
	{
		Body& body = *soft.impl().body;
		const std::vector<Vec3d> positions = body.cellPositions();
		const Cut local = moved( cut, body.nodes().origin );
		const std::vector<CellLink> links = linksCut( body.lattice(), positions, local );
		const int count = body.breakLinks( links );
		if ( count > 0 )
		{
			if ( soft.impl().bodyTemplate->skin().kind != Skinning::None )
			{
				const Vec3d shift = body.lattice().massCentre - soft.impl().bodyTemplate->lattice().massCentre;
				soft.impl().noteTraces(
					tracesOf( body.lattice(), positions, links, local, cellRotations( body, links ) ), shift.cast<float>() );
			}
			soft.activate( true );
		}
		return count;
	}
	catch ( const std::bad_alloc& )
	{
		return 0;
	}
}

} // namespace

int SoftBody::cutPlane( const btVector3& point, const btVector3& normal, btScalar radius )
{
	if ( !isFinite( point ) || !isFinite( normal ) || std::isnan( radius ) || m_impl->isInField() )
	{
		return 0;
	}
	return cutBody( *this, PlaneCut{ toVec3d( point ), toVec3d( normal ), double( radius ) } );
}

int SoftBody::cutSphere( const btVector3& centre, btScalar radius )
{
	if ( !isFinite( centre ) || !std::isfinite( radius ) || m_impl->isInField() )
	{
		return 0;
	}
	return cutBody( *this, SphereCut{ toVec3d( centre ), double( radius ) } );
}

int SoftBody::cutSweep( const btVector3& p0, const btVector3& p1, const btVector3& q0, const btVector3& q1 )
{
	if ( !isFinite( p0 ) || !isFinite( p1 ) || !isFinite( q0 ) || !isFinite( q1 ) || m_impl->isInField() )
	{
		return 0;
	}
	return cutBody( *this, BladeCut{ toVec3d( p0 ), toVec3d( p1 ), toVec3d( q0 ), toVec3d( q1 ) } );
}

int SoftBody::heal( btScalar reach )
{
	if ( !std::isfinite( reach ) || m_impl->isInField() )
	{
		return 0;
	}
	try
	{
		Body& body = *m_impl->body;
		const int count = body.healLinks(
			linksToHeal( m_impl->bodyTemplate->lattice(), body.lattice(), body.firstCells(), body.cellPositions(), double( reach ) ) );
		if ( count > 0 )
		{
			activate( true );
		}
		return count;
	}
	catch ( const std::bad_alloc& )
	{
		return 0;
	}
}

} // namespace pliant
