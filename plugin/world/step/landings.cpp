// Impacts, found before they begin: those that will deform an implicit body, so that it takes the substeps that resolve them in time, and
// those that may break a body on levels, which is split before. docs/design/implicit.md, "Landings"; docs/design/fracture.md, "Impacts".

#include "world/block/implicit_choice.h"
#include "world/bodies/obstacle_parts.h"
#include "world/bodies/soft_body_impl.h"
#include "world/step/object_motion.h"
#include "world/step/soft_body_system.h"
#include "world/step_constants.h"
#include "world/touch/node_touch.h"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionShapes/btConcaveShape.h>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// The root of the mean square of a deformable body's velocities, m/s.
btScalar meanSpeedOf( const SoftBody& body )
{
	return btScalar( std::sqrt( body.impl().meanSquareSpeed ) );
}

/// How the nodes of a deformable body approach an object.
class Approach
{
public:
	/// `reach`: s, how far ahead. `seeksImpacts`: fastestImpact is needed too.
	Approach( const SoftBody& soft, const btCollisionObject& other, btScalar reach, bool seeksImpacts ) :
		m_nodes( soft.impl().body->nodes() ), m_shape( *soft.impl().shape ), m_at( soft.getWorldTransform().getOrigin() ),
		m_motion( motionOf( other ) ), m_velocity( seeksImpacts ? toVec3d( motionOf( soft ).velocity ) : Vec3d( Vec3d::Zero() ) ),
		m_reach( reach ), m_seeksImpacts( seeksImpacts )
	{
		const btScalar speed = meanSpeedOf( soft ) + fastest( other, m_motion );
		m_margin = m_reach * speed + btScalar( m_shape.largestRadius() );
	}

	void addRigid( const btCollisionObject& other )
	{
		Obstacle whole;
		whole.shape = other.getCollisionShape();
		whole.basis = toMatrix3d( other.getWorldTransform().getBasis() );
		whole.position = toVec3d( other.getWorldTransform().getOrigin() ) - m_nodes.origin;
		visitParts( whole, [this]( const Obstacle& part ) {
			const bool isMesh = part.shape->isConcave() && part.shape->getShapeType() != STATIC_PLANE_PROXYTYPE;
			isMesh ? addMesh( part ) : addSolid( part );
		} );
	}
	void addSoft( const SoftBody& other )
	{
		const NodeState& nodes = other.impl().body->nodes();
		const Vec3d shift = nodes.origin - m_nodes.origin;
		const SphereRows::Box& whole = other.impl().shape->rows().whole();
		const btVector3 there = other.getWorldTransform().getOrigin() - m_at;
		visitNodes( there + whole.mins(), there + whole.maxs(), [&]( const MovingSphere& sphere, int node ) {
			const btVector3 centre = worldPosition( sphere ) - other.getWorldTransform().getOrigin();
			const btVector3 around( m_margin, m_margin, m_margin );
			other.impl().shape->rows().visitOverlaps( SphereRows::Box::of( centre - around, centre + around ), [&]( int k ) {
				Touch touch;
				const double radius = double( other.nodeRadius( k ) );
				if ( findNearest( radius, nodes.x.get( k ).cast<double>() + shift, sphere, touch ) )
				{
					add( sphere, node, nodes.v.get( k ).cast<double>(), touch );
				}
			} );
		} );
	}
	/// The fastest approach at a point where they will meet, m/s; 0 where they touch already.
	double fastestLanding() const { return m_touches ? 0.0 : m_most; }
	/// The same, but where they touch already of the nodes that do not, at most as fast as the centre of mass: nodes of a rolling body meet
	/// the ground without an impact. 0 unless impacts are sought.
	double fastestImpact() const { return !m_seeksImpacts ? 0.0 : m_touches ? std::min( m_most, m_mostOfCentre ) : m_most; }
	/// The node of that point; -1 for none.
	int fastestNode() const { return m_node; }

private:
	/// Calls visit( sphere, node ) for the nodes within reach of a box, relative to the body's position.
	template <class Visit>
	void visitNodes( const btVector3& low, const btVector3& high, const Visit& visit )
	{
		const btVector3 margin( m_margin, m_margin, m_margin );
		m_shape.rows().visitOverlaps( SphereRows::Box::of( low - margin, high + margin ), [&]( int node ) {
			if ( m_seeksImpacts || !m_touches )
			{
				MovingSphere sphere;
				sphere.centre = m_nodes.x.get( node ).cast<double>();
				sphere.shape = m_shape.sphereOfNode( node );
				sphere.radius = double( sphere.shape->getRadius() );
				visit( sphere, node );
			}
		} );
	}
	void addSolid( const Obstacle& part )
	{
		btVector3 low, high;
		part.shape->getAabb( part.transform(), low, high );
		const btVector3 origin = toBt( m_nodes.origin ) - m_at;
		visitNodes( low + origin, high + origin, [&]( const MovingSphere& sphere, int node ) {
			Touch touch;
			if ( findNearest( part, sphere, touch ) )
			{
				add( sphere, node, velocityAt( sphere ), touch );
			}
		} );
	}
	void addMesh( const Obstacle& mesh )
	{
		struct Call : btTriangleCallback
		{
			Approach* approach = nullptr;
			const Obstacle* mesh = nullptr;
			void processTriangle( btVector3* corners, int, int ) override { approach->addTriangle( *mesh, corners ); }
		} call;
		call.approach = this;
		call.mesh = &mesh;
		const SphereRows::Box& whole = m_shape.rows().whole();
		const btVector3 margin( m_margin, m_margin, m_margin ), origin = toBt( m_nodes.origin ) - m_at;
		btVector3 low, high;
		btTransformAabb( whole.mins() - origin - margin, whole.maxs() - origin + margin, 0, mesh.transform().inverse(), low, high );
		static_cast<const btConcaveShape*>( mesh.shape )->processAllTriangles( &call, low, high );
	}
	void addTriangle( const Obstacle& mesh, const btVector3* local )
	{
		Vec3d corners[3];
		for ( int k = 0; k < 3; ++k )
		{
			corners[k] = mesh.basis * toVec3d( local[k] ) + mesh.position;
		}
		const btVector3 origin = toBt( m_nodes.origin ) - m_at;
		visitNodes( toBt( corners[0].cwiseMin( corners[1] ).cwiseMin( corners[2] ) ) + origin,
			toBt( corners[0].cwiseMax( corners[1] ).cwiseMax( corners[2] ) ) + origin, [&]( const MovingSphere& sphere, int node ) {
				Touch touch;
				if ( findNearest( corners, sphere, touch ) )
				{
					add( sphere, node, velocityAt( sphere ), touch );
				}
			} );
	}
	btVector3 worldPosition( const MovingSphere& sphere ) const { return toBt( Vec3d( m_nodes.origin + sphere.centre ) ); }
	Vec3d velocityAt( const MovingSphere& sphere ) const { return toVec3d( m_motion.at( worldPosition( sphere ) ) ); }
	void add( const MovingSphere& sphere, int node, const Vec3d& velocity, const Touch& touch )
	{
		const double approach = -( m_nodes.v.get( node ).cast<double>() - velocity ).dot( touch.normal );
		const bool isTouch = touch.distance <= sphere.touchDistance();
		m_touches = m_touches || isTouch;
		if ( !isTouch && approach > m_most && touch.distance - sphere.radius <= approach * double( m_reach ) )
		{
			m_most = approach;
			m_mostOfCentre = -( m_velocity - velocity ).dot( touch.normal );
			m_node = node;
		}
	}

	const NodeState& m_nodes;
	const NodeShape& m_shape;
	btVector3 m_at;
	ObjectMotion m_motion;
	Vec3d m_velocity; ///< of the body's centre of mass, if impacts are sought
	btScalar m_reach, m_margin = btScalar( 0 );
	bool m_seeksImpacts, m_touches = false;
	double m_most = 0.0, m_mostOfCentre = 0.0;
	int m_node = -1;
};

/// The velocity from which on an impact may break a body that has coarse nodes, m/s; infinity where none may. A wave of the velocity v
/// strains the body by v / c.
double leastBreaking( const SoftBody& body )
{
	const Body& core = *body.impl().body;
	const bool canMove = body.isHealthy() && !body.isStaticOrKinematicObject() && body.getActivationState() != DISABLE_SIMULATION;
	const bool canRefine = core.levels() && !body.impl().rigidProxy && body.material().stiffness == Stiffness::YoungsModulus;
	return canMove && canRefine ? std::min( core.weakestBreakStrain() * soundVelocity( body ), double( SIMD_INFINITY ) ) : SIMD_INFINITY;
}

/// The time for which an impact on a body is resolved, s.
double landingDuration( const SoftBody& body, btScalar gameStep )
{
	return kLandingCrossings * double( gameStep ) / travelOfSound( body, double( gameStep ) );
}

btScalar speedOf( const btCollisionObject& object )
{
	if ( !object.isActive() || object.isStaticObject() || !object.getBroadphaseHandle() )
	{
		return btScalar( 0 );
	}
	const SoftBody* const soft = SoftBody::upcast( &object );
	return soft ? meanSpeedOf( *soft ) : fastest( object, motionOf( object ) );
}

/// How freely the balls and wheels that touch a body turn, from 0 to 1.
class RollingObjects : public btBroadphaseAabbCallback
{
public:
	/// `up`: of unit length. `manifolds`: scratch.
	RollingObjects( btOverlappingPairCache& pairs, btBroadphaseProxy& body, const Vec3d& up, btManifoldArray& manifolds ) :
		m_pairs( pairs ), m_body( body ), m_up( up ), m_manifolds( manifolds )
	{}

	double freest() const { return m_freest; }

	bool process( const btBroadphaseProxy* proxy ) override
	{
		const auto& object = *static_cast<const btCollisionObject*>( proxy->m_clientObject );
		const int type = object.getCollisionShape()->getShapeType();
		const bool isRound = type == SPHERE_SHAPE_PROXYTYPE || type == CYLINDER_SHAPE_PROXYTYPE;
		if ( isRound && object.isActive() && massOf( object ) < SIMD_INFINITY )
		{
			btVector3 middle;
			btScalar radius;
			object.getCollisionShape()->getBoundingSphere( middle, radius );
			const double turn = turnFreedom( toVec3d( motionOf( object ).angularVelocity ), m_up, 2.0 * double( radius ) );
			m_freest = turn > m_freest && touches( *proxy ) ? turn : m_freest;
		}
		return true;
	}

private:
	bool touches( const btBroadphaseProxy& other )
	{
		const btBroadphasePair* const pair = m_pairs.findPair( &m_body, const_cast<btBroadphaseProxy*>( &other ) );
		m_manifolds.resize( 0 );
		pair && pair->m_algorithm ? pair->m_algorithm->getAllContactManifolds( m_manifolds ) : void();
		bool isTouch = false;
		for ( int k = 0; k < m_manifolds.size(); ++k )
		{
			isTouch = isTouch || m_manifolds[k]->getNumContacts() > 0;
		}
		return isTouch;
	}

	btOverlappingPairCache& m_pairs;
	btBroadphaseProxy& m_body;
	Vec3d m_up;
	btManifoldArray& m_manifolds;
	double m_freest = 0.0;
};

} // namespace

/// The velocity from which on a landing of the body is resolved by `usual` substeps, m/s; infinity where none is.
double SoftBodySystem::leastLanding( const SoftBody& body, double gameStep, int usual ) const
{
	// Sleeping bodies count too: objects that fall on them must rebound.
	const bool canMove = body.isHealthy() && !body.isStaticOrKinematicObject() && !body.impl().rigidProxy;
	if ( !canMove || body.impl().body->isInelastic() || !stepsImplicitly( body ) || resolvedFraction( body, gameStep / usual ) == 0.0 )
	{
		return SIMD_INFINITY;
	}
	const double fall = kLandingFall * sizeOf( body ), g = double( gravityOf( body ).length() ); // v^2 = 2 g x
	return std::max( kLandingStrain * soundVelocity( body ), std::sqrt( 2.0 * g * fall ) );
}

/// The velocity from which on an object wakes a sleeping implicit body before it hits it, m/s. In the step of the hit the body could take
/// part with its masses alone, and the nodes that are hit would move by more than this on their own.
double SoftBodySystem::leastWaking( const SoftBody& body, double gameStep ) const
{
	const bool canWake = body.getActivationState() == ISLAND_SLEEPING && body.isHealthy() && !body.isStaticOrKinematicObject();
	return canWake && !body.impl().rigidProxy && stepsImplicitly( body )
		? kWakingDisplacement * double( body.impl().bodyTemplate->cellSize() ) / gameStep +
			kWakingFall * gameStep * double( gravityOf( body ).length() )
		: double( SIMD_INFINITY );
}

/// Whether a body rolls on something, from 0 to 1.
double SoftBodySystem::rollingOf( const SoftBody& body ) const
{
	const btVector3 gravity = gravityOf( body );
	if ( body.impl().touched.empty() || body.impl().rigidProxy || gravity.isZero() )
	{
		return 0.0;
	}
	const double freedom = body.impl().body->turnFreedom( toVec3d( -gravity.normalized() ) );
	return freedom > 0.0 && attachments.contain( body ) ? 0.0 : freedom;
}

/// Whether balls or wheels roll on a body, from 0 to 1: strain moves through it as through a body that rolls.
double SoftBodySystem::rollingOn( SoftBody& body )
{
	const btVector3 gravity = gravityOf( body );
	btBroadphaseProxy* const own = body.getBroadphaseHandle();
	if ( body.impl().touched.empty() || gravity.isZero() || !own )
	{
		return 0.0;
	}
	RollingObjects rolling( *m_world.getPairCache(), *own, toVec3d( -gravity.normalized() ), m_manifolds );
	m_world.getBroadphase()->aabbTest( own->m_aabbMin, own->m_aabbMax, rolling );
	return rolling.freest();
}

void SoftBodySystem::countIslandBodies()
{
	m_islandBodies.clear();
	const btCollisionObjectArray& objects = m_world.getCollisionObjectArray();
	for ( int i = 0; i < objects.size(); ++i )
	{
		const std::size_t at = std::size_t( objects[i]->getIslandTag() + 1 );
		m_islandBodies.resize( std::max( m_islandBodies.size(), at + 1 ), 0 );
		const SoftBody* const body = SoftBody::upcast( objects[i] );
		m_islandBodies[at] += body && !body->impl().rigidProxy && !body->isStaticOrKinematicObject() ? 1 : 0;
	}
}

/// Whether so few deformable bodies take part in an impact that all may take substeps for it.
bool SoftBodySystem::isSmallImpact( const btCollisionObject& a, const btCollisionObject& b ) const
{
	const auto countOf = [this]( int island ) { return m_islandBodies[std::size_t( island + 1 )]; };
	const int first = a.getIslandTag(), second = b.getIslandTag();
	return countOf( first ) + ( second == first || second < 0 ? 0 : countOf( second ) ) <= kMostLandingBodies;
}

void SoftBodySystem::noteImpact( SoftBody& body, btCollisionObject& other, btScalar gameStep, int usual )
{
	ElasticityState& state = body.impl().elasticity;
	const double duration = landingDuration( body, gameStep );
	const double slowest = leastLanding( body, double( gameStep ), usual ), breaking = leastBreaking( body );
	const bool mayLand = slowest < SIMD_INFINITY && state.landingTime <= duration && isSmallImpact( body, other );
	const bool mayBreak = breaking < SIMD_INFINITY;
	const double waking = leastWaking( body, double( gameStep ) );
	if ( ( !mayLand && !mayBreak && waking == SIMD_INFINITY ) || !mayTouch( body, other ) )
	{
		return;
	}
	Approach approach( body, other, btScalar( kLandingSteps ) * gameStep, mayBreak );
	const SoftBody* const soft = SoftBody::upcast( &other );
	soft && !soft->impl().rigidProxy ? approach.addSoft( *soft ) : approach.addRigid( other );
	// The energy m v^2 / 2 of a light object deforms less of the body, that of a heavy one more.
	const double mass = double( massOf( other ) ), own = body.impl().mass, root = std::sqrt( mass / own );
	const double least = std::min( 1.0, root ), most = mass == SIMD_INFINITY ? 1.0 : std::max( 1.0, root );
	const double landing = mayLand ? approach.fastestLanding() : 0.0;
	approach.fastestLanding() > waking ? body.activate() : void();
	if ( least * landing > slowest && most * landing < kMostLandingStrain * soundVelocity( body ) )
	{
		state.landingTime = duration + kLandingSteps * double( gameStep );
		body.activate();
	}
	// The energy mu v^2 / 2, with the reduced mass mu, strains at most the mass mu ( v / ( c e ) )^2 by the strain e. Its coarse nodes are
	// split before the impact: they would notice the strain too late.
	const double impact = approach.fastestImpact();
	if ( impact > breaking )
	{
		const double ratio = impact / breaking;
		body.impl().body->refineAround( approach.fastestNode(), own / ( 1.0 + own / mass ) * ratio * ratio );
		body.activate();
	}
}

/// At the start of a game step. `usual`: the number of substeps that explicit bodies take. Where the step cannot be divided into a group
/// and the rest, substeps would change the motion of all objects, and impacts are not resolved.
void SoftBodySystem::noteLandings( btScalar gameStep, int usual, bool canSplit )
{
	double least = SIMD_INFINITY;
	if ( std::any_of( m_bodies.begin(), m_bodies.end(), []( const SoftBody* body ) { return body->impl().elasticity.blow > 0.0; } ) )
	{
		countIslandBodies();
	}
	for ( SoftBody* body : m_bodies )
	{
		const double slowest = canSplit ? leastLanding( *body, double( gameStep ), usual ) : SIMD_INFINITY;
		ElasticityState& state = body->impl().elasticity;
		state.landingTime = slowest < SIMD_INFINITY ? std::max( 0.0, state.landingTime - double( gameStep ) ) : 0.0;
		if ( slowest < SIMD_INFINITY && state.blow > slowest * slowest && isSmallImpact( *body, *body ) )
		{
			state.landingTime = std::max( state.landingTime, landingDuration( *body, gameStep ) );
		}
		state.blow = 0.0;
		const double rolling = state.landingTime == 0.0 ? rollingOf( *body ) : 0.0;
		const bool maySubstep = slowest < SIMD_INFINITY && state.landingTime == 0.0;
		state.rolling = maySubstep ? std::max( rolling, rollingOn( *body ) ) : 0.0;
		// Vibrations that wobble damping leaves may break links.
		body->impl().body->rollFreely( body->fracture().rule == BreakRule::Never ? rolling : 0.0 );
		least = std::min( { least, slowest, leastBreaking( *body ), leastWaking( *body, double( gameStep ) ) } );
	}
	if ( least == SIMD_INFINITY )
	{
		return;
	}
	countIslandBodies();
	for ( SoftBody* body : m_bodies )
	{
		double& rolling = body->impl().elasticity.rolling;
		rolling = isSmallImpact( *body, *body ) ? rolling : 0.0;
	}
	const btScalar reach = btScalar( kLandingSteps ) * gameStep;
	const btScalar slowest = btScalar( 0.5 * least ); // the faster of two objects makes at least half of their approach
	m_fastPairs.visit( m_world, reach, slowest, speedOf, [&]( btCollisionObject& fast, btCollisionObject& other ) {
		if ( SoftBody* const body = asSoftBody( &fast ) )
		{
			noteImpact( *body, other, gameStep, usual );
		}
		if ( SoftBody* const body = asSoftBody( &other ) )
		{
			noteImpact( *body, fast, gameStep, usual );
		}
	} );
}

} // namespace pliant
