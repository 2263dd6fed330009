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

/// Motion in this step of an object that the game moves.
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
		m_displacement[std::size_t( i )] = h * nodes.v.get( i ).cast<double>();
		if ( nodes.freedom[i] != 0.0f )
		{
			m_nodes.push_back( i );
		}
	}
	enforceBarriers( walls );
	for ( const int node : m_changed )
	{
		nodes.v.set( node, ( m_displacement[std::size_t( node )] / h ).cast<float>() );
	}
	return int( m_changed.size() );
}

// New nodes are treated as if they came from their parents' positions.
bool TunnelingGuard::place( SoftBody& body, const std::vector<const btCollisionObject*>& walls, const std::vector<Vec3>& positionBefore )
{
	NodeState& nodes = body.impl().body->nodes();
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
	begin( body, 0.0 );
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3 before = from[std::size_t( i )], now = nodes.x.get( i );
		if ( before != now && nodes.freedom[i] != 0.0f )
		{
			m_from[std::size_t( i )] = before.cast<double>();
			m_displacement[std::size_t( i )] = ( now - before ).cast<double>();
			m_nodes.push_back( i );
		}
	}
	enforceBarriers( walls );
	for ( const int node : m_changed )
	{
		nodes.x.set( node, ( m_from[std::size_t( node )] + m_displacement[std::size_t( node )] ).cast<float>() );
	}
	return !m_changed.empty();
}

void TunnelingGuard::begin( SoftBody& body, double h )
{
	m_body = &body;
	m_h = h;
	m_hasInnerNodes = false;
	m_nodes.clear();
	m_barriers.clear();
	m_changed.clear();
	m_from.resize( std::size_t( body.nodeCount() ) );
	m_displacement.resize( std::size_t( body.nodeCount() ) );
}

void TunnelingGuard::enforceBarriers( const std::vector<const btCollisionObject*>& walls )
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
			visitParts( obstacle, [&]( const Obstacle& part ) { addBarriers( part, motion ); } );
		}
		const auto isBefore = []( const Barrier& a, const Barrier& b ) { return a.node < b.node; };
		if ( !std::is_sorted( m_barriers.begin(), m_barriers.end(), isBefore ) ) // they are, of a single wall
		{
			std::stable_sort( m_barriers.begin(), m_barriers.end(), isBefore );
		}
		m_corrected.clear();
		for ( std::size_t first = 0, end = 0; first < m_barriers.size(); first = end )
		{
			for ( end = first; end < m_barriers.size() && m_barriers[end].node == m_barriers[first].node; ++end )
			{}
			constrain( first, end, round == kGuardRounds - 1 );
		}
		// A corrected node may now meet another wall.
		m_nodes = m_corrected;
		m_changed.insert( m_changed.end(), m_corrected.begin(), m_corrected.end() );
	}
	std::sort( m_changed.begin(), m_changed.end() );
	m_changed.erase( std::unique( m_changed.begin(), m_changed.end() ), m_changed.end() );
}

// Gauss-Seidel over the barriers of one node. Where they leave no displacement, the node stays or moves with the wall.
void TunnelingGuard::constrain( std::size_t first, std::size_t end, bool isLast )
{
	Vec3d& displacement = m_displacement[std::size_t( m_barriers[first].node )];
	const double tiny = kGuardSlack * double( m_body->impl().shape->sphereOfNode( m_barriers[first].node )->getRadius() );
	bool isCorrected = false, isViolated = true;
	for ( int sweep = 0; sweep < kGuardSweeps && isViolated; ++sweep )
	{
		isViolated = false;
		for ( std::size_t k = first; k < end; ++k )
		{
			const double violation = m_barriers[k].least - m_barriers[k].normal.dot( displacement );
			if ( violation > tiny )
			{
				displacement += violation * m_barriers[k].normal;
				isViolated = isCorrected = true;
			}
		}
	}
	if ( isViolated || ( isCorrected && isLast ) )
	{
		displacement = m_barriers[end - 1].fallback;
	}
	if ( isCorrected )
	{
		m_corrected.push_back( m_barriers[first].node );
	}
}

namespace {

/// True for spheres too far from a box to reach it.
struct FarBox
{
	Vec3d low, high;

	bool operator()( const Vec3d& centre, const Vec3d& displacement, double radius ) const
	{
		const Vec3d to = centre + displacement;
		return ( ( centre.cwiseMin( to ) - high ).array() > radius ).any() || ( ( low - centre.cwiseMax( to ) ).array() > radius ).any();
	}
};

} // namespace

template <class IsFar, class FindTouch>
void TunnelingGuard::addBarriersOf( const ObstacleMotion& motion, const IsFar& isFar, const FindTouch& find )
{
	const NodeShape& shape = *m_body->impl().shape;
	const bool isStill = motion.isStill();
	for ( const int node : m_nodes )
	{
		const double radius = double( shape.sphereOfNode( node )->getRadius() );
		const bool isInner = shape.childOfNode( node ) < 0; // inner nodes: no contact keeps them out
		MovingSphere sphere;
		sphere.centre = m_from[std::size_t( node )];
		sphere.radius = ( isInner ? 1.0 : kGuardFraction ) * radius;
		const Vec3d motionOfWall = isStill ? Vec3d( Vec3d::Zero() ) : motion.displacement( sphere.centre, m_h );
		sphere.displacement = m_displacement[std::size_t( node )] - motionOfWall;
		if ( isFar( sphere.centre, sphere.displacement, radius ) )
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
		m_hasInnerNodes = m_hasInnerNodes || isInner;
		const double gap = std::max( 0.0, touch.distance - sphere.radius );
		m_barriers.push_back( Barrier{ node, touch.normal, touch.normal.dot( motionOfWall ) - gap, motionOfWall } );
	}
}

void TunnelingGuard::addBarriers( const Obstacle& part, const ObstacleMotion& motion )
{
	const int type = part.shape->getShapeType();
	if ( part.shape->isConcave() && type != SDF_SHAPE_PROXYTYPE && type != STATIC_PLANE_PROXYTYPE )
	{
		addMeshBarriers( part, motion );
		return;
	}
	if ( type == EMPTY_SHAPE_PROXYTYPE )
	{
		return;
	}
	const auto find = [&part]( const MovingSphere& sphere, Touch& touch ) { return findTouch( part, sphere, touch ); };
	if ( type == STATIC_PLANE_PROXYTYPE ) // a plane's box is unbounded
	{
		const FarPlane far( part );
		addBarriersOf(
			motion,
			[&far]( const Vec3d& centre, const Vec3d& displacement, double radius ) { return far.isClear( centre, displacement, radius ); },
			find );
		return;
	}
	btVector3 low, high;
	part.shape->getAabb( part.transform(), low, high );
	addBarriersOf( motion, FarBox{ toVec3d( low ), toVec3d( high ) }, find );
}

void TunnelingGuard::addMeshBarriers( const Obstacle& mesh, const ObstacleMotion& motion )
{
	// The box swept by the nodes, in the mesh's coordinates.
	const SoftBody::Impl& impl = m_body->impl();
	Vec3d low = Vec3d::Constant( HUGE_VAL ), high = -low;
	for ( const int node : m_nodes )
	{
		const Vec3d from = m_from[std::size_t( node )];
		const Vec3d to = from + m_displacement[std::size_t( node )] - motion.displacement( from, m_h );
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
			Vec3d world[3];
			for ( int k = 0; k < 3; ++k )
			{
				world[k] = mesh->basis * toVec3d( corners[k] ) + mesh->position;
			}
			const FarBox box{ world[0].cwiseMin( world[1] ).cwiseMin( world[2] ), world[0].cwiseMax( world[1] ).cwiseMax( world[2] ) };
			const TerrainSide ground( *mesh, world, *guard->m_body->impl().shape, guard->m_body->impl().shapeShift.cast<double>() );
			guard->addBarriersOf( *motion, box, [&world, &ground]( const MovingSphere& sphere, Touch& touch ) {
				return findTouch( world, sphere, touch ) && ground.allows( sphere.centre, touch ); // nodes in the ground may come out
			} );
		}
	} call;
	call.guard = this;
	call.mesh = &mesh;
	call.motion = &motion;
	static_cast<const btConcaveShape*>( mesh.shape )->processAllTriangles( &call, toBt( middle - reach ), toBt( middle + reach ) );
}

namespace {

/// Static and kinematic objects in a box that the body collides with, in the order in which Bullet first saw them.
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
		// If the game modifies contact points as they are created, it may have let the body pass.
		const int flags = object.getCollisionFlags() | m_body.getCollisionFlags();
		if ( ( gContactAddedCallback && flags & btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK ) || asSoftBody( &object ) )
		{
			return false;
		}
		btOverlappingPairCache* const pairs = m_world.getBroadphase()->getOverlappingPairCache();
		btBroadphaseProxy *const own = m_body.getBroadphaseHandle(), *const other = object.getBroadphaseHandle();
		// A pair without an algorithm has been refused by the game's callback.
		const btBroadphasePair* const pair = pairs->findPair( own, other );
		return ( pair ? pair->m_algorithm != nullptr : pairs->needsBroadphaseCollision( own, other ) ) &&
			m_world.getDispatcher()->needsCollision( &m_body, &object );
	}

	btDiscreteDynamicsWorld& m_world;
	SoftBody& m_body;
};

/// Largest absolute velocity component of any node; whole lanes at a time, since it is computed for every awake body.
float largest( const NodeState& nodes, TaskRunner* runner )
{
	PerChunk<float> most{};
	runChunks( runner, ChunkedRange{ nodes.padded }, [&]( int fraction, int begin, int end ) {
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
		// A body that was fast may still be pressed against the wall, with nodes deep in it, when it is slow.
		impl.isGuarded = !walls.empty() &&
			( held > 0 || m_guard.hasInnerNodes() || sweep > kSlowFraction * double( impl.shape->smallestRadius() ) );
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
	const LevelEnergy before = own.storedEnergy(); // moving the nodes compresses them
	if ( m_guard.place( body, walls, positionBefore ) )
	{
		own.addEnergyDebtSince( before );
		body.impl().shape->place( own.nodes(), body.impl().shapeShift );
		++body.impl().skin.moves;
	}
}

} // namespace pliant
