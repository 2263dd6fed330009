// Cutting and healing: what the game names in the world's coordinates, the body's links by name. Steinemann et al. 2008, section 5.1.

#include "fracture/cut_links.h"
#include "pliant/body_template.h"
#include "world/soft_body_impl.h"

#include <new>

namespace pliant {

namespace {

/// The cut in the nodes' own coordinates.
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

template <class Cut>
int cutBody( SoftBody& soft, const Cut& cut )
{
	try
	{
		Body& body = *soft.impl().body;
		const int count = body.breakLinks( linksCut( body.lattice(), body.cellPlaces(), moved( cut, body.nodes().origin ) ) );
		if ( count > 0 )
		{
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
	return cutBody( *this, PlaneCut{ toVec3d( point ), toVec3d( normal ), double( radius ) } );
}

int SoftBody::cutSphere( const btVector3& centre, btScalar radius )
{
	return cutBody( *this, SphereCut{ toVec3d( centre ), double( radius ) } );
}

int SoftBody::cutSweep( const btVector3& p0, const btVector3& p1, const btVector3& q0, const btVector3& q1 )
{
	return cutBody( *this, BladeCut{ toVec3d( p0 ), toVec3d( p1 ), toVec3d( q0 ), toVec3d( q1 ) } );
}

int SoftBody::heal( btScalar reach )
{
	try
	{
		Body& body = *m_impl->body;
		const int count = body.healLinks(
			linksToHeal( m_impl->bodyTemplate->lattice(), body.lattice(), body.firstCells(), body.cellPlaces(), double( reach ) ) );
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
