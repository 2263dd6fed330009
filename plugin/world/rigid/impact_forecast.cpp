// Forecasts, one step ahead, impacts that would deform a body in its rigid state, so that it is deformable when they happen.

#include "body/rigid_state.h"
#include "world/bodies/obstacle_parts.h"
#include "world/bodies/soft_body_impl.h"
#include "world/rigid/rigid_constants.h"
#include "world/rigid/rigid_load.h"
#include "world/step/object_motion.h"
#include "world/step/soft_body_system.h"
#include "world/touch/node_touch.h"

#include <LinearMath/btAabbUtil2.h>

#include <algorithm>

namespace pliant {

namespace {

/// Whether the boxes of two objects come within `reach`, m, of each other while the first moves by `displacement`.
bool comeNear( const btCollisionObject& a, const btCollisionObject& b, const btVector3& displacement, btScalar reach )
{
	btVector3 lowA, highA, lowB, highB;
	a.getCollisionShape()->getAabb( a.getWorldTransform(), lowA, highA );
	b.getCollisionShape()->getAabb( b.getWorldTransform(), lowB, highB );
	btVector3 back = displacement, ahead = displacement;
	back.setMin( btVector3( 0, 0, 0 ) );
	ahead.setMax( btVector3( 0, 0, 0 ) );
	const btVector3 around( reach, reach, reach );
	return TestAabbAgainstAabb2( lowA + back - around, highA + ahead + around, lowB, highB );
}

/// Whether a body is in its rigid state and leaves it under load.
bool mayDeform( const SoftBody& body )
{
	return body.impl().rigidProxy && !body.impl().isScenery;
}

/// The fastest approach at a point at which two objects will collide within a step, m/s.
struct FastestContact : btCollisionWorld::ContactResultCallback
{
	ObjectMotion first, second;
	btScalar step, most = 0;

	FastestContact( const ObjectMotion& ofFirst, const ObjectMotion& ofSecond, btScalar h ) :
		first( ofFirst ), second( ofSecond ), step( h )
	{}
	/// `normal`: out of the second, towards the first.
	void add( const btVector3& pointOfFirst, const btVector3& pointOfSecond, const btVector3& normal, btScalar distance )
	{
		const btScalar approach = -( first.at( pointOfFirst ) - second.at( pointOfSecond ) ).dot( normal );
		most = distance <= approach * step ? btMax( most, approach ) : most;
	}
	btScalar addSingleResult(
		btManifoldPoint& point, const btCollisionObjectWrapper*, int, int, const btCollisionObjectWrapper*, int, int ) override
	{
		add( point.getPositionWorldOnA(), point.getPositionWorldOnB(), point.m_normalWorldOnB, point.getDistance() );
		return 0;
	}
};

/// Adds the contacts of a body's hulls with the spheres of a deformable body that they may reach. Its drawn surface is not used: the motion
/// must not depend on the drawing. `reach`: largest relative displacement within the step, m; `least`: smallest approach that counts, m/s.
void addSphereContacts( const SoftBody& body, const SoftBody& soft, btScalar reach, btScalar least, FastestContact& contact )
{
	const NodeState& nodes = soft.impl().body->nodes();
	const NodeShape& shape = *soft.impl().shape;
	btVector3 low, high;
	body.getCollisionShape()->getAabb( body.getWorldTransform(), low, high );
	const btScalar around = reach + btScalar( shape.largestRadius() );
	const btVector3 margin( around, around, around ), at = soft.getWorldTransform().getOrigin();
	const btVector3 origin = soft.impl().worldOrigin();
	Obstacle hulls;
	hulls.shape = body.getCollisionShape();
	hulls.basis = toMatrix3d( body.getWorldTransform().getBasis() );
	hulls.position = toVec3d( body.getWorldTransform().getOrigin() ) - nodes.origin;
	shape.rows().visitOverlaps( SphereRows::Box::of( low - margin - at, high + margin - at ), [&]( int node ) {
		MovingSphere sphere;
		sphere.centre = nodes.x.get( node ).cast<double>();
		sphere.shape = shape.sphereOfNode( node );
		sphere.radius = double( sphere.shape->getRadius() );
		const btVector3 centre = origin + toBt( sphere.centre ), approach = contact.first.at( centre ) - contact.second.at( centre );
		if ( contact.most > least || approach.length2() <= least * least )
		{
			return;
		}
		const Vec3d sweep = toVec3d( -contact.step * approach );
		visitParts( hulls, [&]( const Obstacle& hull ) {
			Touch touch;
			if ( gapToOwnBox( hull, sphere.centre, sphere.centre + sweep ) <= sphere.touchDistance() && findNearest( hull, sphere, touch ) )
			{
				const btVector3 onHull = origin + toBt( Vec3d( sphere.centre - touch.distance * touch.normal ) );
				const btVector3 onSphere = origin + toBt( Vec3d( sphere.centre - sphere.radius * touch.normal ) );
				contact.add( onHull, onSphere, -toBt( touch.normal ), btScalar( touch.distance - sphere.radius ) );
			}
		} );
	} );
}

} // namespace

bool SoftBodySystem::mayTouch( SoftBody& body, btCollisionObject& other )
{
	return body.hasContactResponse() && other.hasContactResponse() && m_dispatcher.needsCollision( &body, &other ) &&
		m_world.getPairCache()->needsBroadphaseCollision( body.getBroadphaseHandle(), other.getBroadphaseHandle() );
}

/// The motions of a world's objects, by their index in it: those of deformable bodies are sums over their nodes.
class ForecastMotions
{
public:
	explicit ForecastMotions( const btCollisionObjectArray& objects )
	{
		m_motions.reserve( std::size_t( objects.size() ) );
		for ( int i = 0; i < objects.size(); ++i )
		{
			m_motions.push_back( motionOf( *objects[i] ) );
		}
	}
	const ObjectMotion& of( const btCollisionObject& object ) const { return m_motions[std::size_t( object.getWorldArrayIndex() )]; }

private:
	std::vector<ObjectMotion> m_motions;
};

void SoftBodySystem::forecastImpact( SoftBody& body, btCollisionObject& other, const ForecastMotions& motions, btScalar h )
{
	SoftBody* const soft = asSoftBody( &other );
	SoftBody* const rigid = soft && mayDeform( *soft ) ? soft : nullptr;
	bool &deforms = body.impl().mustDeform, none = true, &otherDeforms = rigid ? rigid->impl().mustDeform : none;
	if ( ( deforms && otherDeforms ) || !mayTouch( body, other ) )
	{
		return;
	}
	const ObjectMotion &own = motions.of( body ), &others = motions.of( other );
	const btScalar limit = btScalar( largestApproach( *body.impl().body, double( massOf( other ) ), impactsPass( body, double( h ) ) ) );
	const btScalar otherLimit = rigid
		? btScalar( largestApproach( *rigid->impl().body, double( massOf( body ) ), impactsPass( *rigid, double( h ) ) ) )
		: limit;
	const btScalar least = deforms ? otherLimit : otherDeforms ? limit : btMin( limit, otherLimit );
	const btVector3 approach = own.velocity - others.velocity;
	const btScalar turn = fastestTurn( body, own ) + fastestTurn( other, others ), bound = approach.length() + turn;
	if ( bound <= least || !comeNear( body, other, approach * h, turn * h ) )
	{
		return;
	}
	FastestContact contact( own, others, h );
	contact.m_closestDistanceThreshold = bound * h;
	if ( soft && !soft->impl().rigidProxy )
	{
		addSphereContacts( body, *soft, bound * h, least, contact );
	}
	else
	{
		m_world.contactPairTest( &body, &other, contact );
	}
	deforms = deforms || contact.most > limit;
	otherDeforms = otherDeforms || contact.most > otherLimit;
}

// Both objects of a pair may be in their rigid state.
void SoftBodySystem::forecastImpacts( btScalar h )
{
	double slowest = SIMD_INFINITY;
	for ( const SoftBody* body : m_bodies )
	{
		if ( mayDeform( *body ) )
		{
			const Body& core = *body->impl().body;
			const double speed = core.largestInvisibleVelocity( !impactsPass( *body, double( h ) ) );
			slowest = std::min( slowest, core.rigidState()->isHeld ? std::min( speed, kHeldForecast ) : speed );
		}
	}
	const btCollisionObjectArray& objects = m_world.getCollisionObjectArray();
	const ForecastMotions motions( objects );
	const double least = 0.5 * slowest; // the faster of two objects makes at least half of their approach
	const auto speedOf = [&]( const btCollisionObject& object ) {
		const bool moves = object.isActive() && !object.isStaticObject() && object.getBroadphaseHandle();
		return moves ? fastest( object, motions.of( object ) ) : btScalar( 0 );
	};
	m_fastPairs.visit( m_world, h, btScalar( least ), speedOf, [&]( btCollisionObject& fast, btCollisionObject& other ) {
		SoftBody* const soft = asSoftBody( &fast );
		SoftBody* const otherSoft = asSoftBody( &other );
		if ( soft && mayDeform( *soft ) )
		{
			forecastImpact( *soft, other, motions, h );
		}
		else if ( otherSoft && mayDeform( *otherSoft ) )
		{
			forecastImpact( *otherSoft, fast, motions, h );
		}
	} );
}

} // namespace pliant
