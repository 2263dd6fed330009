#include "world/search/node_search.h"

#include "body/levels/levels.h"
#include "world/bodies/obstacle_parts.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/touch/box_touch.h"
#include "world/touch/edge_constants.h"
#include "world/touch/terrain_side.h"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

using Near = SoftBody::Impl::Near;

/// A box in the coordinates of a soft body's shape, with a margin for the motion in this step.
struct Box
{
	btVector3 low, high;

	void move( const btVector3& from, const btVector3& to )
	{
		low += from;
		high += to;
	}
	void widen( double by )
	{
		const btScalar all = btScalar( by );
		move( btVector3( -all, -all, -all ), btVector3( all, all, all ) );
	}
	/// Stretches the box backwards by the sweep of the nodes.
	void stretchAgainst( const NodeShape& shape ) { move( -shape.sweepHigh(), -shape.sweepLow() ); }
	void stretchAlong( const btVector3& displacement )
	{
		btVector3 back = displacement, forth = displacement;
		back.setMin( btVector3( 0, 0, 0 ) );
		forth.setMax( btVector3( 0, 0, 0 ) );
		move( back, forth );
	}
};

struct TriangleCall : btTriangleCallback
{
	using Call = void ( * )( void* context, btVector3* triangle, int part, int index );
	void processTriangle( btVector3* corners, int part, int index ) override { call( context, corners, part, index ); }
	Call call = nullptr;
	void* context = nullptr;
};

} // namespace

std::vector<NodeHit>& NodeSearch::againstRigid( const SoftBody& soft, const btCollisionObjectWrapper& other, double step )
{
	const Vec3d& origin = soft.impl().body->nodes().origin;
	m_soft = &soft;
	m_surface = soft.impl().isMetAsDrawnBy( *other.getCollisionObject() ) ? &soft.impl().surfaceNow() : nullptr;
	m_step = step;
	m_leaf = 0;
	m_hits.clear();
	m_motion = m_unforcedMotion = ObstacleMotion{};
	m_looksAhead = soft.impl().isImplicit && soft.isActive() && int( soft.impl().body->velocityBefore().x.size() ) >= soft.nodeCount();
	const Levels* levels = soft.impl().body->levels();
	m_refinesOnContact = levels && levels->settings().refinesOnContact && soft.isActive();
	if ( const btRigidBody* rigid = btRigidBody::upcast( other.getCollisionObject() ) )
	{
		// Bullet's solver adds the step's forces to the velocity: the contact search must use the same velocity.
		m_motion.linear = toVec3d( rigid->getLinearVelocity() + rigid->getTotalForce() * rigid->getInvMass() * btScalar( step ) );
		m_motion.angular = toVec3d( rigid->getAngularVelocity() );
		m_motion.centre = toVec3d( rigid->getCenterOfMassPosition() ) - origin;
		m_unforcedMotion = m_motion;
		m_unforcedMotion.linear = toVec3d( rigid->getLinearVelocity() );
	}
	Obstacle obstacle;
	obstacle.shape = other.getCollisionShape();
	obstacle.basis = toMatrix3d( other.getWorldTransform().getBasis() );
	obstacle.position = toVec3d( other.getWorldTransform().getOrigin() ) - origin;
	for ( const Pressed& pressed : m_pressed )
	{
		m_pressedReach = std::max( m_pressedReach, pressed.reach );
	}
	visitParts( obstacle, [this]( const Obstacle& part ) { visit( part ); } );
	m_pressed.clear();
	m_pressedReach = 0.0;
	applyAllowances( soft, nullptr );
	if ( other.getCollisionObject()->getCollisionFlags() & btCollisionObject::CF_CHARACTER_OBJECT )
	{
		adjustForCharacter();
	}
	sortHits();
	dropFlatNeighbours();
	return m_hits;
}

void NodeSearch::visit( const Obstacle& obstacle )
{
	const btCollisionShape* shape = obstacle.shape;
	const int type = shape->getShapeType();
	m_patchObstacle = PatchObstacle{}; // solid() sets it; a compound may have a mesh beside solids
	if ( type == STATIC_PLANE_PROXYTYPE )
	{
		plane( obstacle );
	}
	else if ( shape->isConcave() && type != SDF_SHAPE_PROXYTYPE )
	{
		mesh( obstacle );
	}
	else if ( type != EMPTY_SHAPE_PROXYTYPE )
	{
		solid( obstacle );
	}
	++m_leaf;
}

NodeSearch::Spheres::Spheres( const NodeSearch& search ) :
	m_nodes( search.m_soft->impl().body->nodes() ), m_shape( *search.m_soft->impl().shape ), m_motion( search.m_motion ),
	m_step( search.m_step ), m_isStill( search.m_motion.isStill() ), m_velocityBefore( search.m_soft->impl().body->velocityBefore() ),
	m_unforcedMotion( search.m_unforcedMotion ), m_pressed( search.m_pressed )
{}

inline MovingSphere NodeSearch::Spheres::of( int node ) const
{
	MovingSphere sphere;
	sphere.shape = m_shape.sphereOfNode( node );
	sphere.radius = double( sphere.shape->getRadius() );
	sphere.centre = m_nodes.x.get( node ).cast<double>();
	sphere.displacement = m_step * m_nodes.v.get( node ).cast<double>();
	if ( !m_isStill )
	{
		sphere.displacement -= m_motion.displacement( sphere.centre, m_step );
	}
	if ( !m_pressed.empty() )
	{
		const auto own = std::lower_bound(
			m_pressed.begin(), m_pressed.end(), node, []( const Pressed& pressed, int at ) { return pressed.node < at; } );
		sphere.pressedReach = own != m_pressed.end() && own->node == node ? own->reach : 0.0;
	}
	return sphere;
}

inline Ahead NodeSearch::Spheres::ahead( int node ) const
{
	const Vec3d to = m_step * m_velocityBefore.get( node ).cast<double>();
	return Ahead{ to, to - m_unforcedMotion.displacement( m_nodes.x.get( node ).cast<double>(), m_step ) };
}

double NodeSearch::overhang() const
{
	return ( m_surface ? m_surface->overhang() : 0.0 ) + m_pressedReach;
}

// A small object is met by all nodes around it, each at its own point, so that it lies on several.
double NodeSearch::solidOverhang() const
{
	return overhang() + ( m_patchObstacle.isSmall && m_surface ? kSmallReach * m_surface->largestSize() : 0.0 );
}

// Tests the patch in front of a node, or the node's own sphere where the patch does not face the obstacle.
template <class Nearest, class Find>
inline bool NodeSearch::touches( int node, const MovingSphere& sphere, const Nearest& nearest, const Find& find, Touch& touch ) const
{
	ContactSurface::Patch patch;
	Touch there;
	if ( m_surface && ( !m_surface->hasSeveral( node, m_patchObstacle.isSmall ) || nearest( sphere, there ) ) &&
		m_surface->patchOf( m_soft->impl().body->nodes(), node, -there.distance * there.normal, m_patchObstacle.isSmall, patch ) )
	{
		const PatchAnswer answer = findPatchTouch( patch, m_surface->sizeOf( node ), m_patchObstacle, sphere, nearest, find, touch );
		if ( answer != PatchAnswer::UseSphere )
		{
			return answer == PatchAnswer::Touches;
		}
		// Where the patch does not apply, the node's sphere reaches no farther than the surface.
		MovingSphere within = sphere;
		within.radius = std::min( sphere.radius, patch.height );
		within.scale = sphere.radius;
		const bool isFound = find( within, touch );
		touch.distance += sphere.radius - within.radius;
		return isFound;
	}
	return find( sphere, touch );
}

// A plane's box is unbounded: every node is tested, inner ones too, without a tree.
void NodeSearch::plane( const Obstacle& obstacle )
{
	const NodeState& nodes = m_soft->impl().body->nodes();
	const FarPlane far( obstacle );
	const double radius = ( m_refinesOnContact ? 2.0 * kCornerReach : 1.0 ) * double( m_soft->impl().shape->largestRadius() ) +
		overhang(); // foresee() tests the corners of parents
	const auto nearest = [&obstacle]( const MovingSphere& sphere, Touch& found ) { return findNearest( obstacle, sphere, found ); };
	const auto find = [&obstacle]( const MovingSphere& sphere, Touch& found ) { return findTouch( obstacle, sphere, found ); };
	const bool isStill = m_motion.isStill();
	const Spheres spheres( *this );
	Touch touch;
	for ( int first = 0; first < nodes.count; first += FarPlane::kBlock )
	{
		const int end = isStill && far.areClear( nodes, first, m_step, radius ) ? first : std::min( nodes.count, first + FarPlane::kBlock );
		for ( int node = first; node < end; ++node )
		{
			const Vec3d centre = nodes.x.get( node ).cast<double>(), displacement = m_step * nodes.v.get( node ).cast<double>();
			if ( far.isClear( centre, isStill ? displacement : Vec3d( displacement - m_motion.displacement( centre, m_step ) ), radius ) )
			{
				continue;
			}
			if ( touches( node, spheres.of( node ), nearest, find, touch ) )
			{
				m_hits.push_back( NodeHit{ std::uint64_t( node ) << 32 | m_leaf, touch, obstacle.part, obstacle.index } );
			}
			if ( m_refinesOnContact )
			{
				foresee( node, find );
			}
		}
	}
}

// Objects smaller than the spheres fall through the channels of a grid of spheres. Such an object refines the nodes it comes near, before
// it touches: a node larger than the object whose box it enters is split; nodes near it of about its size are kept from merging.
void NodeSearch::noteNearby( int node, btScalar size ) const
{
	if ( !m_refinesOnContact )
	{
		return;
	}
	const SoftBody::Impl& impl = m_soft->impl();
	const btScalar diameter = 2 * impl.shape->sphereOfNode( node )->getRadius();
	if ( size <= 2 * diameter )
	{
		impl.nearNodes.push_back( Near{ node, size <= diameter ? Near::Request::Split : Near::Request::Keep } );
	}
}

// A coarse node's sphere leaves out the corners of its cube, sqrt( 3 ) radii from the centre. Were it split only when the sphere touches,
// cells at the corners would appear inside the obstacle and be ejected. So a node is split as soon as a corner may touch, and a node is
// kept from merging where its parent's corner would touch.
template <class Find>
void NodeSearch::foresee( int node, const Find& find ) const
{
	const SoftBody::Impl& impl = m_soft->impl();
	MovingSphere sphere = Spheres( *this ).of( node );
	const double corner = kCornerReach * sphere.radius;
	Touch touch;
	sphere.radius = corner;
	if ( m_soft->nodeLevel( node ) > 0 && find( sphere, touch ) )
	{
		impl.nearNodes.push_back( Near{ node, Near::Request::SplitLater } );
		return;
	}
	sphere.radius = 2.0 * corner;
	if ( find( sphere, touch ) )
	{
		impl.nearNodes.push_back( Near{ node, Near::Request::Keep } );
	}
}

/// Distance from the coarsest node's centre to its corner, along each axis, an upper bound for all nodes. Zero where no corners are tested.
btVector3 NodeSearch::cornerReach() const
{
	if ( !m_refinesOnContact )
	{
		return btVector3( 0, 0, 0 );
	}
	const int levels = m_soft->impl().body->levels()->settings().coarseLevels;
	const btScalar reach = btScalar( kCornerReach * 0.5 * std::exp2( double( levels ) ) * double( m_soft->bodyTemplate().cellSize() ) );
	return btVector3( reach, reach, reach );
}

/// Calls foresee() for all nodes whose corners, or whose parents' corners, reach into a box that is already stretched for the motion.
template <class Find>
void NodeSearch::foreseeIn( const btVector3& low, const btVector3& high, const Find& find )
{
	if ( !m_refinesOnContact )
	{
		return;
	}
	const SoftBody::Impl& impl = m_soft->impl();
	const btVector3 aside = cornerReach();
	impl.shape->rows().visitOverlaps( SphereRows::Box::of( low - aside, high + aside ), [&]( int node ) { foresee( node, find ); } );
}

// Visits the marked nodes in ascending order, which is the order of the hits: those of a single solid need no sorting.
template <class Find>
void NodeSearch::touchMarked( const Obstacle& obstacle, btScalar size, const Find& find )
{
	const Spheres spheres( *this );
	const bool looksAhead = m_looksAhead && obstacle.shape->isConvex();
	const Obstacle then = looksAhead ? m_unforcedMotion.moved( obstacle, m_step ) : Obstacle{};
	const FarSolid far( obstacle );
	const double ahead = solidOverhang(), aside = m_surface ? kWidestPatch * m_surface->largestSize() : 0.0;
	const auto nearest = [&obstacle]( const MovingSphere& sphere, Touch& found ) { return findNearest( obstacle, sphere, found ); };
	m_marks.takeAll( [&]( int node ) {
		noteNearby( node, size );
		Touch touch;
		const MovingSphere sphere = spheres.of( node );
		const double reach = std::hypot( sphere.touchDistance() + ahead, aside ) + sphere.displacement.norm();
		if ( far.isClear( sphere.centre, reach * ( 1.0 + kFarSlack ) ) )
		{
			return;
		}
		if ( m_surface && m_surface->levels() )
		{
			m_patchObstacle = PatchObstacle::of( *obstacle.shape, double( size ) / m_surface->sizeOf( node ) );
		}
		if ( touches( node, sphere, nearest, find, touch ) &&
			( !looksAhead || touch.reach >= 0.0 || lookAhead( then, sphere, spheres.ahead( node ), touch ) ) )
		{
			m_hits.push_back( NodeHit{ std::uint64_t( node ) << 32 | m_leaf, touch, obstacle.part, obstacle.index } );
		}
	} );
}

void NodeSearch::solid( const Obstacle& obstacle )
{
	const SoftBody::Impl& impl = m_soft->impl();
	Obstacle inShape = obstacle;
	inShape.position -= impl.shapeShift.cast<double>();
	Box box;
	obstacle.shape->getAabb( inShape.transform(), box.low, box.high );
	const btScalar size = largestExtent( *obstacle.shape );
	box.stretchAlong( toBt( m_step * m_motion.linear ) );
	const double cell = m_surface ? m_surface->largestSize() : 0.0;
	m_patchObstacle = PatchObstacle::of( *obstacle.shape, m_surface ? double( size ) / cell : kEdgeThing );
	box.widen( solidOverhang() );
	const btScalar turn = btScalar( m_step * m_motion.angular.norm() * ( obstacle.position - m_motion.centre ).norm() ) +
		btScalar( m_step * m_motion.angular.norm() ) * ( box.high - box.low ).length() / 2;
	box.move( btVector3( -turn, -turn, -turn ), btVector3( turn, turn, turn ) );
	box.stretchAgainst( *impl.shape );
	m_marks.fit( impl.body->nodeCount() );
	impl.shape->rows().visitOverlaps( SphereRows::Box::of( box.low, box.high ), [this]( int node ) { m_marks.add( node ); } );
	if ( obstacle.shape->getShapeType() == BOX_SHAPE_PROXYTYPE )
	{
		const BoxTouch boxTouch( obstacle );
		touchMarked( obstacle, size, [&boxTouch]( const MovingSphere& sphere, Touch& touch ) { return boxTouch.find( sphere, touch ); } );
	}
	else
	{
		touchMarked(
			obstacle, size, [&obstacle]( const MovingSphere& sphere, Touch& touch ) { return findTouch( obstacle, sphere, touch ); } );
	}
	foreseeIn(
		box.low, box.high, [&obstacle]( const MovingSphere& sphere, Touch& found ) { return findTouch( obstacle, sphere, found ); } );
}

void NodeSearch::mesh( const Obstacle& obstacle )
{
	// The soft body's box in the mesh's coordinates, swept by both motions.
	const SoftBody::Impl& impl = m_soft->impl();
	const SphereRows::Box& whole = impl.shape->rows().whole();
	Box box{ whole.mins() + impl.shape->sweepLow(), whole.maxs() + impl.shape->sweepHigh() };
	box.stretchAlong( toBt( -m_step * m_motion.linear ) );
	box.move( -cornerReach(), cornerReach() );
	box.widen( overhang() );
	const Vec3d centre = toVec3d( box.low + box.high ) / 2.0 + impl.shapeShift.cast<double>();
	const Vec3d half = toVec3d( box.high - box.low ) / 2.0;
	const Vec3d reach = obstacle.basis.transpose().cwiseAbs() * half;
	const Vec3d low = obstacle.toLocal( centre ) - reach, high = obstacle.toLocal( centre ) + reach;

	struct Context
	{
		NodeSearch& search;
		Obstacle mesh;
	} context{ *this, obstacle };
	TriangleCall call;
	call.context = &context;
	call.call = []( void* to, btVector3* corners, int part, int index ) {
		Context& c = *static_cast<Context*>( to );
		Vec3d world[3];
		for ( int k = 0; k < 3; ++k )
		{
			world[k] = c.mesh.basis * toVec3d( corners[k] ) + c.mesh.position;
		}
		c.mesh.part = part;
		c.mesh.index = index;
		c.search.triangle( c.mesh, world );
	};
	static_cast<const btConcaveShape*>( obstacle.shape )->processAllTriangles( &call, toBt( low ), toBt( high ) );
}

void NodeSearch::triangle( const Obstacle& mesh, const Vec3d ( &corners )[3] )
{
	const SoftBody::Impl& impl = m_soft->impl();
	const Vec3d shift = impl.shapeShift.cast<double>();
	Box box{ toBt( corners[0].cwiseMin( corners[1] ).cwiseMin( corners[2] ) - shift ),
		toBt( corners[0].cwiseMax( corners[1] ).cwiseMax( corners[2] ) - shift ) };
	box.stretchAlong( toBt( m_step * m_motion.linear ) );
	box.stretchAgainst( *impl.shape );
	box.widen( overhang() );
	const TerrainSide ground( mesh, corners, *impl.shape, shift );
	box.stretchAlong( toBt( ground.exitBelow() ) );
	const Spheres spheres( *this );
	const auto nearest = [&corners]( const MovingSphere& sphere, Touch& found ) { return findNearest( corners, sphere, found ); };
	const auto find = [&corners]( const MovingSphere& sphere, Touch& found ) { return findTouch( corners, sphere, found ); };
	impl.shape->rows().visitOverlaps( SphereRows::Box::of( box.low, box.high ), [&]( int node ) {
		Touch touch;
		const MovingSphere sphere = spheres.of( node );
		if ( ground.contains( sphere.centre, touch ) ||
			( touches( node, sphere, nearest, find, touch ) && ground.allows( sphere.centre, touch ) ) )
		{
			m_hits.push_back( NodeHit{ std::uint64_t( node ) << 32 | m_leaf, touch, mesh.part, mesh.index } );
		}
	} );
	foreseeIn( box.low, box.high, find );
}

} // namespace pliant
