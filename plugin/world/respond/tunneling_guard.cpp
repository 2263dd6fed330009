#include "world/respond/tunneling_guard.h"

#include "body/levels/levels.h"
#include "threads/parallel.h"
#include "world/bodies/obstacle_parts.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/step/soft_body_system.h"
#include "world/touch/terrain_side.h"

#include <BulletCollision/BroadphaseCollision/btBroadphaseInterface.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <LinearMath/btQuickprof.h>

#include <algorithm>

namespace pliant {

namespace {

/// The step's share of what an object that moves by the game's hand moves by.
ObstacleMotion motionOf( const btCollisionObject& wall, const Vec3d& origin )
{
	ObstacleMotion motion;
	const btRigidBody* const rigid = btRigidBody::upcast( &wall );
	if ( rigid && wall.isKinematicObject() )
	{
		motion.linear = toVec3d( rigid->getLinearVelocity() );
		motion.angular = toVec3d( rigid->getAngularVelocity() );
	}
	motion.centre = toVec3d( wall.getWorldTransform().getOrigin() ) - origin;
	return motion;
}

} // namespace

int TunnelingGuard::hold( SoftBody& body, const std::vector<const btCollisionObject*>& walls, double h )
{
	NodeState& nodes = body.impl().body->nodes();
	begin( body, h );
	for ( int i = 0; i < nodes.count; ++i )
	{
		m_from[std::size_t( i )] = nodes.x.get( i ).cast<double>();
		m_way[std::size_t( i )] = h * nodes.v.get( i ).cast<double>();
		if ( nodes.freedom[i] != 0.0f )
		{
			m_nodes.push_back( i );
		}
	}
	turnAway( walls );
	for ( const int node : m_held )
	{
		nodes.v.set( node, ( m_way[std::size_t( node )] / h ).cast<float>() );
	}
	return int( m_held.size() );
}

// As if they came from where their parents were.
bool TunnelingGuard::place( SoftBody& body, const std::vector<const btCollisionObject*>& walls, const std::vector<Vec3>& positionBefore )
{
	const NodeState& nodes = body.impl().body->nodes();
	const LevelChange& change = body.impl().body->levels()->lastChange();
	std::vector<Vec3> from;
	for ( int i = 0; i < nodes.count; ++i )
	{
		from.push_back( positionBefore[change.source[std::size_t( i )]] );
	}
	for ( const std::uint32_t now : change.keptAs )
	{
		if ( now != kNoNode )
		{
			from[now] = nodes.x.get( int( now ) );
		}
	}
	return keep( body, walls, from );
}

bool TunnelingGuard::keep( SoftBody& body, const std::vector<const btCollisionObject*>& walls, const std::vector<Vec3>& from )
{
	NodeState& nodes = body.impl().body->nodes();
	begin( body, 0.0 );
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3 before = from[std::size_t( i )], now = nodes.x.get( i );
		if ( before != now && nodes.freedom[i] != 0.0f )
		{
			m_from[std::size_t( i )] = before.cast<double>();
			m_way[std::size_t( i )] = ( now - before ).cast<double>();
			m_nodes.push_back( i );
		}
	}
	turnAway( walls );
	for ( const int node : m_held )
	{
		nodes.x.set( node, ( m_from[std::size_t( node )] + m_way[std::size_t( node )] ).cast<float>() );
	}
	return !m_held.empty();
}

void TunnelingGuard::begin( SoftBody& body, double h )
{
	m_body = &body;
	m_h = h;
	m_isAsked = false;
	m_nodes.clear();
	m_barriers.clear();
	m_held.clear();
	m_from.resize( std::size_t( body.nodeCount() ) );
	m_way.resize( std::size_t( body.nodeCount() ) );
}

void TunnelingGuard::turnAway( const std::vector<const btCollisionObject*>& walls )
{
	const Vec3d& origin = m_body->impl().body->nodes().origin;
	for ( int round = 0; round < kGuardRounds && !m_nodes.empty(); ++round )
	{
		for ( const btCollisionObject* wall : walls )
		{
			Obstacle obstacle;
			obstacle.shape = wall->getCollisionShape();
			obstacle.basis = toMatrix3d( wall->getWorldTransform().getBasis() );
			obstacle.position = toVec3d( wall->getWorldTransform().getOrigin() ) - origin;
			const ObstacleMotion motion = motionOf( *wall, origin );
			visitParts( obstacle, [&]( const Obstacle& part ) { look( part, motion ); } );
		}
		std::stable_sort( m_barriers.begin(), m_barriers.end(), []( const Barrier& a, const Barrier& b ) { return a.node < b.node; } );
		m_turned.clear();
		for ( std::size_t first = 0, end = 0; first < m_barriers.size(); first = end )
		{
			for ( end = first; end < m_barriers.size() && m_barriers[end].node == m_barriers[first].node; ++end )
			{}
			lead( first, end, round == kGuardRounds - 1 );
		}
		// What was turned may now lead somewhere else.
		m_nodes = m_turned;
		m_held.insert( m_held.end(), m_turned.begin(), m_turned.end() );
	}
	std::sort( m_held.begin(), m_held.end() );
	m_held.erase( std::unique( m_held.begin(), m_held.end() ), m_held.end() );
}

// Gauss-Seidel over the barriers of one node: each takes the part of the way that leads through it. Where they leave no way, the node stays
// where it is, or goes along with the wall.
void TunnelingGuard::lead( std::size_t first, std::size_t end, bool isLast )
{
	Vec3d& way = m_way[std::size_t( m_barriers[first].node )];
	const double tiny = kGuardSlack * double( m_body->impl().shape->sphereOfNode( m_barriers[first].node )->getRadius() );
	bool isTurned = false, isThrough = true;
	for ( int sweep = 0; sweep < kGuardSweeps && isThrough; ++sweep )
	{
		isThrough = false;
		for ( std::size_t k = first; k < end; ++k )
		{
			const double lack = m_barriers[k].least - m_barriers[k].normal.dot( way );
			if ( lack > tiny )
			{
				way += lack * m_barriers[k].normal;
				isThrough = isTurned = true;
			}
		}
	}
	if ( isThrough || ( isTurned && isLast ) )
	{
		way = m_barriers[end - 1].yieldingWay;
	}
	if ( isTurned )
	{
		m_turned.push_back( m_barriers[first].node );
	}
}

namespace {

/// What is so far from a box that it cannot come to it.
struct FarBox
{
	Vec3d low, high;

	bool operator()( const Vec3d& centre, const Vec3d& way, double radius ) const
	{
		const Vec3d to = centre + way;
		return ( ( centre.cwiseMin( to ) - high ).array() > radius ).any() || ( ( low - centre.cwiseMax( to ) ).array() > radius ).any();
	}
};

} // namespace

template <class IsFar, class FindTouch>
void TunnelingGuard::lookAt( const ObstacleMotion& motion, const IsFar& isFar, const FindTouch& find )
{
	const NodeShape& shape = *m_body->impl().shape;
	const bool isStill = motion.isStill();
	for ( const int node : m_nodes )
	{
		const double radius = double( shape.sphereOfNode( node )->getRadius() );
		const bool isBare = shape.childOfNode( node ) < 0; // deep inside: nothing else keeps it out
		MovingSphere sphere;
		sphere.centre = m_from[std::size_t( node )];
		sphere.radius = ( isBare ? 1.0 : kGuardFraction ) * radius;
		const Vec3d along = isStill ? Vec3d( Vec3d::Zero() ) : motion.way( sphere.centre, m_h );
		sphere.way = m_way[std::size_t( node )] - along;
		if ( isFar( sphere.centre, sphere.way, radius ) )
		{
			continue;
		}
		m_sphere.setUnscaledRadius( btScalar( sphere.radius ) );
		sphere.shape = &m_sphere;
		Touch touch;
		if ( !find( sphere, touch ) )
		{
			continue;
		}
		m_isAsked = m_isAsked || isBare;
		const double gap = std::max( 0.0, touch.distance - sphere.radius );
		m_barriers.push_back( Barrier{ node, touch.normal, touch.normal.dot( along ) - gap, along } );
	}
}

void TunnelingGuard::look( const Obstacle& part, const ObstacleMotion& motion )
{
	const int type = part.shape->getShapeType();
	if ( part.shape->isConcave() && type != SDF_SHAPE_PROXYTYPE && type != STATIC_PLANE_PROXYTYPE )
	{
		lookAtMesh( part, motion );
		return;
	}
	if ( type == EMPTY_SHAPE_PROXYTYPE )
	{
		return;
	}
	const auto find = [&part]( const MovingSphere& sphere, Touch& touch ) { return findTouch( part, sphere, touch ); };
	if ( type == STATIC_PLANE_PROXYTYPE ) // whose box is everywhere
	{
		const FarPlane far( part );
		lookAt(
			motion, [&far]( const Vec3d& centre, const Vec3d& way, double radius ) { return far.isClear( centre, way, radius ); }, find );
		return;
	}
	btVector3 low, high;
	part.shape->getAabb( part.transform(), low, high );
	lookAt( motion, FarBox{ toVec3d( low ), toVec3d( high ) }, find );
}

void TunnelingGuard::lookAtMesh( const Obstacle& mesh, const ObstacleMotion& motion )
{
	// The box that the nodes sweep, in the mesh's coordinates.
	const SoftBody::Impl& impl = m_body->impl();
	Vec3d low = Vec3d::Constant( HUGE_VAL ), high = -low;
	for ( const int node : m_nodes )
	{
		const Vec3d from = m_from[std::size_t( node )];
		const Vec3d to = from + m_way[std::size_t( node )] - motion.way( from, m_h );
		low = low.cwiseMin( from ).cwiseMin( to );
		high = high.cwiseMax( from ).cwiseMax( to );
	}
	const double around = double( impl.shape->largestRadius() );
	const Vec3d middle = mesh.toLocal( ( low + high ) / 2.0 );
	const Vec3d reach = mesh.basis.transpose().cwiseAbs() * ( ( high - low ) / 2.0 + Vec3d::Constant( around ) );

	struct Call : btTriangleCallback
	{
		TunnelingGuard* guard = nullptr;
		const Obstacle* mesh = nullptr;
		const ObstacleMotion* motion = nullptr;
		void processTriangle( btVector3* corners, int, int ) override
		{
			Vec3d placed[3];
			for ( int k = 0; k < 3; ++k )
			{
				placed[k] = mesh->basis * toVec3d( corners[k] ) + mesh->position;
			}
			const FarBox box{
				placed[0].cwiseMin( placed[1] ).cwiseMin( placed[2] ), placed[0].cwiseMax( placed[1] ).cwiseMax( placed[2] ) };
			const TerrainSide ground( *mesh, placed, *guard->m_body->impl().shape, guard->m_body->impl().shapeShift.cast<double>() );
			guard->lookAt( *motion, box, [&placed, &ground]( const MovingSphere& sphere, Touch& touch ) {
				return findTouch( placed, sphere, touch ) && ground.allows( sphere.centre, touch ); // what is in the ground may come out
			} );
		}
	} call;
	call.guard = this;
	call.mesh = &mesh;
	call.motion = &motion;
	static_cast<const btConcaveShape*>( mesh.shape )->processAllTriangles( &call, toBt( middle - reach ), toBt( middle + reach ) );
}

namespace {

/// What stands in a box and the body collides with, ascending by the order in which Bullet came to know it.
class WallsAround : public btBroadphaseAabbCallback
{
public:
	WallsAround( btDiscreteDynamicsWorld& world, SoftBody& body ) : m_world( world ), m_body( body ) {}

	bool process( const btBroadphaseProxy* proxy ) override
	{
		auto* const object = static_cast<btCollisionObject*>( proxy->m_clientObject );
		if ( object && object->isStaticOrKinematicObject() && object->hasContactResponse() && isMet( *object ) )
		{
			walls.push_back( object );
		}
		return true;
	}
	std::vector<const btCollisionObject*> walls;

private:
	bool isMet( btCollisionObject& object ) const
	{
		// Where the game changes contact points as they are made, it may have let the body through.
		const int flags = object.getCollisionFlags() | m_body.getCollisionFlags();
		if ( ( gContactAddedCallback && flags & btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK ) || asSoftBody( &object ) )
		{
			return false;
		}
		btOverlappingPairCache* const pairs = m_world.getBroadphase()->getOverlappingPairCache();
		btBroadphaseProxy *const own = m_body.getBroadphaseHandle(), *const other = object.getBroadphaseHandle();
		// A pair that has no algorithm has been refused by the game's callback.
		const btBroadphasePair* const pair = pairs->findPair( own, other );
		return ( pair ? pair->m_algorithm != nullptr : pairs->needsBroadphaseCollision( own, other ) ) &&
			m_world.getDispatcher()->needsCollision( &m_body, &object );
	}

	btDiscreteDynamicsWorld& m_world;
	SoftBody& m_body;
};

/// Of any component of any node's; whole lanes at a time, for every awake body is asked.
float largest( const NodeState& nodes, TaskRunner* runner )
{
	OfFractions<float> most{};
	runShares( runner, Shares{ nodes.padded }, [&]( int fraction, int begin, int end ) {
		const auto of = [&]( const AlignedArray<float>& v ) {
			return Eigen::Map<const Eigen::ArrayXf>( v.data() + begin, end - begin ).abs().maxCoeff();
		};
		most[std::size_t( fraction )] = std::max( of( nodes.v.x ), std::max( of( nodes.v.y ), of( nodes.v.z ) ) );
	} );
	return *std::max_element( most.begin(), most.end() );
}

} // namespace

std::vector<const btCollisionObject*> SoftBodySystem::wallsAround( SoftBody& body, double reach )
{
	const NodeShape& shape = *body.impl().shape;
	const btScalar margin = btScalar( reach ) + shape.largestRadius();
	const btVector3 around( margin, margin, margin ), at = body.getWorldTransform().getOrigin();
	WallsAround found( m_world, body );
	m_world.getBroadphase()->aabbTest( at + shape.rows().whole().mins() - around, at + shape.rows().whole().maxs() + around, found );
	std::sort( found.walls.begin(), found.walls.end(), []( const btCollisionObject* a, const btCollisionObject* b ) {
		return a->getBroadphaseHandle()->m_uniqueId < b->getBroadphaseHandle()->m_uniqueId;
	} );
	return found.walls;
}

void SoftBodySystem::holdBack( btScalar h )
{
	for ( SoftBody* body : m_awake )
	{
		SoftBody::Impl& impl = body->impl();
		const NodeState& nodes = impl.body->nodes();
		if ( impl.partingPhases > 0 )
		{
			--impl.partingPhases;
			impl.isGuarded = false;
			continue;
		}
		const double sweep = double( h ) * double( largest( nodes, tasks() ) );
		const bool isFast = sweep > kFastFraction * double( impl.shape->smallestRadius() );
		if ( ( !isFast && !impl.isGuarded ) || !moves( *body ) || !body->hasContactResponse() )
		{
			impl.isGuarded = false;
			continue;
		}
		BT_PROFILE( "pliant: holdBack" );
		const std::vector<const btCollisionObject*> walls = wallsAround( *body, sweep );
		const int held = walls.empty() ? 0 : m_guard.hold( *body, walls, double( h ) );
		report.heldNodes += held;
		// What was fast may still be squeezed against the wall, and have nodes deep in it, when it is slow.
		impl.isGuarded = !walls.empty() &&
			( held > 0 || m_guard.isAsked() || sweep > kSlowFraction * double( impl.shape->smallestRadius() ) );
	}
}

void SoftBodySystem::keepNewNodesOut( SoftBody& body, const std::vector<Vec3>& positionBefore )
{
	const std::vector<const btCollisionObject*> walls = wallsAround( body, 0.0 );
	if ( walls.empty() )
	{
		return;
	}
	Body& own = *body.impl().body;
	const LevelEnergy before = own.heldEnergy(); // to move them squeezes them
	if ( m_guard.place( body, walls, positionBefore ) )
	{
		own.oweSince( before );
		body.impl().shape->place( own.nodes(), body.impl().shapeShift );
	}
}

// Bullet's split impulse moves places and not speeds; of a node between a heavy thing and the floor it makes the floor's guest.
void SoftBodySystem::keepPushedNodesOut( SoftBody& body, const std::vector<Vec3>& positionBefore )
{
	const std::vector<const btCollisionObject*> walls = wallsAround( body, 0.0 );
	if ( !walls.empty() )
	{
		m_guard.keep( body, walls, positionBefore );
	}
}

} // namespace pliant
