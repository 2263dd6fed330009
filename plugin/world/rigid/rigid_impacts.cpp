#include "world/rigid/rigid_impacts.h"

#include "body/rigid_state.h"
#include "world/bodies/manifolds.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/rigid/rigid_constants.h"
#include "world/rigid/rigid_load.h"
#include "world/step/soft_body_system.h"
#include "world/stopwatch.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// Contacts of a body with one object that have nearly one normal.
struct Patch
{
	const btCollisionObject* other = nullptr;
	Vec3d normal = Vec3d::Zero();  ///< into the body, of the first contact
	Vec3d impulse = Vec3d::Zero(); ///< that stops the approaches, N s
	Vec3d centre = Vec3d::Zero();  ///< of the pressure, from the nodes' origin, m
	double press = 0.0;            ///< sum of the normal impulses, N s
	std::vector<Vec3d> points;     ///< from the nodes' origin, m
};

/// The velocity of a side of a manifold at a point, m/s.
btVector3 velocityAt( const btCollisionObject& side, const btVector3& point )
{
	const btRigidBody* const rigid = btRigidBody::upcast( &side );
	return rigid ? rigid->getVelocityInLocalPoint( point - rigid->getCenterOfMassPosition() ) : btVector3( 0, 0, 0 );
}

bool breaksAsRigid( const SoftBody& body, double gameStep )
{
	const SoftBody::Impl& impl = body.impl();
	return !impl.isScenery && !impl.body->rigidState()->isHeld && !impl.body->isInelastic() &&
		std::isfinite( impl.body->weakestBreakStrain() ) && impactsPass( body, gameStep );
}

/// The factor to a contact's impulse that stops all of its approach: Bullet leaves the velocity that closes a gap within the substep.
double stoppingFactor( const RigidApproach& at, double h )
{
	const double closing = std::max( double( at.manifold->getContactPoint( at.point ).m_distance1 ), 0.0 ) / h;
	return at.velocity > closing ? at.velocity / std::max( at.velocity - closing, kLeastStopped * at.velocity ) : 1.0;
}

/// Adds a contact to the patch that it belongs to.
void addTo( std::vector<Patch>& patches, const RigidApproach& at, double h )
{
	const btManifoldPoint& point = at.manifold->getContactPoint( at.point );
	const double press = double( point.m_appliedImpulse );
	if ( !( press > 0.0 ) )
	{
		return;
	}
	const double sign = at.isFirst ? 1.0 : -1.0;
	const Vec3d normal = sign * toVec3d( point.m_normalWorldOnB );
	const btCollisionObject* const other = at.isFirst ? at.manifold->getBody1() : at.manifold->getBody0();
	auto patch = std::find_if( patches.begin(), patches.end(),
		[&]( const Patch& each ) { return each.other == other && each.normal.dot( normal ) > kPatchCosine; } );
	if ( patch == patches.end() )
	{
		patches.emplace_back();
		patch = std::prev( patches.end() );
		patch->other = other;
		patch->normal = normal;
	}
	const double factor = stoppingFactor( at, h );
	const Vec3d rubbed = double( point.m_appliedImpulseLateral1 ) * toVec3d( point.m_lateralFrictionDir1 ) +
		double( point.m_appliedImpulseLateral2 ) * toVec3d( point.m_lateralFrictionDir2 );
	const Vec3d where = toVec3d( at.isFirst ? point.m_positionWorldOnA : point.m_positionWorldOnB ) - at.body->impl().body->nodes().origin;
	patch->impulse += factor * ( press * normal + sign * rubbed );
	patch->centre += press * where;
	patch->press += press;
	patch->points.push_back( where );
}

/// Distributes a patch's impulse to the nodes in front: those within half a cell of the foremost, as far aside as its contacts. The weights
/// are affine in the position, w = a + b . y, and have the patch's centre:
///
///   sum w = 1,   sum w y = 0,   y = x - centre without the part along the normal
void spread( const Patch& patch, const SoftBody& body, AlignedArray<float>& to )
{
	const NodeState& nodes = body.impl().body->nodes();
	const double cell = double( body.impl().bodyTemplate->cellSize() );
	const Vec3d centre = patch.centre / patch.press;
	const auto aside = [&]( const Vec3d& x ) { return Vec3d( x - centre - patch.normal.dot( x - centre ) * patch.normal ); };
	double reach = 0.0, front = HUGE_VAL;
	for ( const Vec3d& point : patch.points )
	{
		reach = std::max( reach, aside( point ).norm() );
	}
	reach += cell;
	const auto forNear = [&]( const auto& visit ) {
		for ( int i = 0; i < nodes.count; ++i )
		{
			const Vec3d x = nodes.x.get( i ).cast<double>(), y = aside( x );
			if ( y.squaredNorm() <= reach * reach )
			{
				visit( i, patch.normal.dot( x - centre ), y );
			}
		}
	};
	forNear( [&]( int, double height, const Vec3d& ) { front = std::min( front, height ); } );
	const auto forFront = [&]( const auto& visit ) {
		forNear( [&]( int i, double height, const Vec3d& y ) { height <= front + kFrontDepth* cell ? visit( i, y ) : void(); } );
	};
	double count = 0.0;
	Vec3d first = Vec3d::Zero();
	Eigen::Matrix3d second = kLeastPatchSpread * cell * cell * Eigen::Matrix3d::Identity();
	forFront( [&]( int, const Vec3d& y ) {
		count += 1.0;
		first += y;
		second += y * y.transpose();
	} );
	if ( count == 0.0 )
	{
		return; // a hull reaches beyond its nodes
	}
	// b from the second moment about the mean, a from the sum; weights below zero are none.
	const Vec3d mean = first / count;
	const Vec3d slope = -( second - count * mean * mean.transpose() ).ldlt().solve( mean );
	const auto weightOf = [&]( const Vec3d& y ) { return std::max( 0.0, 1.0 / count + slope.dot( y - mean ) ); };
	double sum = 0.0;
	forFront( [&]( int, const Vec3d& y ) { sum += weightOf( y ); } );
	forFront( [&]( int i, const Vec3d& y ) {
		for ( int k = 0; k < 3; ++k )
		{
			to[std::size_t( k * nodes.padded + i )] += float( weightOf( y ) / sum * patch.impulse[k] );
		}
	} );
}

/// The energy that a contact takes from the motion of its sides, J. `falls`: velocity by the body's weight, m/s, with which it rests.
double energyOf( const RigidApproach& at, double falls, double h )
{
	const btManifoldPoint& point = at.manifold->getContactPoint( at.point );
	const btCollisionObject* const other = at.isFirst ? at.manifold->getBody1() : at.manifold->getBody0();
	const double share = ownerOfContactProxy( other ) || SoftBody::upcast( other ) ? kSharedImpact : 1.0;
	return 0.5 * share * stoppingFactor( at, h ) * std::max( 0.0, double( point.m_appliedImpulse ) ) * std::max( 0.0, at.velocity - falls );
}

} // namespace

void SoftBodySystem::noteRigidApproaches( btDispatcher& dispatcher )
{
	m_approaches.clear();
	if ( !m_hasRigidProxies )
	{
		return;
	}
	forEachManifold( dispatcher, [this]( const btPersistentManifold& manifold ) {
		SoftBody* const owners[2] = { ownerOfRigidProxy( manifold.getBody0() ), ownerOfRigidProxy( manifold.getBody1() ) };
		for ( int side = 0; side < 2; ++side )
		{
			if ( !owners[side] || !breaksAsRigid( *owners[side], double( m_gameStep ) ) )
			{
				continue;
			}
			for ( int k = 0; k < manifold.getNumContacts(); ++k )
			{
				const btManifoldPoint& point = manifold.getContactPoint( k );
				const btVector3 velocity = velocityAt( *manifold.getBody0(), point.getPositionWorldOnA() ) -
					velocityAt( *manifold.getBody1(), point.getPositionWorldOnB() );
				m_approaches.push_back( RigidApproach{ owners[side], &manifold, int( m_approaches.size() ), k, side == 0,
					std::max( 0.0, -double( velocity.dot( point.m_normalWorldOnB ) ) ) } );
			}
		}
	} );
	std::sort( m_approaches.begin(), m_approaches.end(), []( const RigidApproach& a, const RigidApproach& b ) {
		const unsigned first = a.body->impl().serial, second = b.body->impl().serial;
		return first < second || ( first == second && a.number < b.number );
	} );
}

// The impulses are those of Bullet's solver. What they break parts at the start of the next game step.
void SoftBodySystem::breakRigid( double h )
{
	double spent = 0.0; // s, not counted as Bullet's solver
	{
		Stopwatch watch( spent );
		std::vector<Patch> patches;
		for ( auto first = m_approaches.begin(), last = first; first != m_approaches.end(); first = last )
		{
			SoftBody& body = *first->body;
			const double falls = h * double( gravityOf( body ).length() );
			double energy = 0.0;
			for ( ; last != m_approaches.end() && last->body == &body; ++last )
			{
				energy += energyOf( *last, falls, h );
			}
			if ( !couldBreak( body, energy ) )
			{
				continue;
			}
			patches.clear();
			std::for_each( first, last, [&]( const RigidApproach& at ) { addTo( patches, at, h ); } );
			AlignedArray<float> impulse( std::size_t( body.impl().body->nodes().padded ) * 3, 0.0f );
			std::for_each( patches.begin(), patches.end(), [&]( const Patch& patch ) { spread( patch, body, impulse ); } );
			strainRigid( body, impulse, energy, h );
		}
	}
	report.fracture += spent;
	report.solve -= spent;
}

} // namespace pliant
