#pragma once

// Rays and swept balls against a soft body, compared with a test of every drawn triangle. The reference uses triangles and distances only:
// Cramer's rule for rays, steps of the remaining distance for balls.

#include <pliant/soft_body_world.h>

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace pliant::test {

struct QueryTally
{
	int asked = 0, hits = 0;
	int different = 0;          ///< number of cases in which only one of the two hits
	double worstDistance = 0.0; ///< between the two points of impact along the path, m
	double worstAngle = 0.0;    ///< of the normal from that of the drawn surface, degrees
	int wrongNodes =
		0; ///< number of reported nodes that are farther from the point than the nearest colliding one, by more than half a cell
};

/// The drawn triangles of a body, in world coordinates.
class DrawnTriangles
{
public:
	explicit DrawnTriangles( const SoftBody& body )
	{
		const SurfaceView view = body.surface();
		for ( int k = 0; k < 3 * view.triangleCount; ++k )
		{
			const float* const p = view.positions + 3 * std::size_t( view.indices[k] );
			const float* const n = view.normals + 3 * std::size_t( view.indices[k] );
			m_corner.push_back( view.origin + btVector3( btScalar( p[0] ), btScalar( p[1] ), btScalar( p[2] ) ) );
			m_normal.emplace_back( btScalar( n[0] ), btScalar( n[1] ), btScalar( n[2] ) );
		}
	}

	/// Fraction of the first triangle met; 2 for none.
	double ray( const btVector3& from, const btVector3& to ) const
	{
		double first = 2.0;
		visitMet( from, to, [&first]( double fraction, const btVector3& ) { first = std::min( first, fraction ); } );
		return first;
	}
	/// Degrees between a normal and that of the surface at the hit of a ray, at an edge that of the nearer side: the face's normal or,
	/// where the normals of its corners are close to it, the interpolated one.
	double angle( const btVector3& from, const btVector3& to, double met, const btVector3& shown ) const
	{
		double least = 180.0;
		const double tolerance = 1e-4 / double( ( to - from ).length() );
		visitMet( from, to, [&]( double fraction, const btVector3& normal ) {
			const double cosine = double( normal.dot( shown ) / ( normal.length() * shown.length() ) );
			least = std::abs( fraction - met ) < tolerance ? std::min( least, std::acos( std::min( 1.0, cosine ) ) * 57.29578 ) : least;
		} );
		return least;
	}

	/// Fraction at which a ball touches first; 2 for never.
	double ball( const btVector3& from, const btVector3& to, double radius ) const
	{
		const double length = double( ( to - from ).length() );
		for ( double gone = 0.0; gone <= length; )
		{
			const double left = distance( from + ( to - from ) * btScalar( gone / length ) ) - radius;
			if ( left < 1e-5 )
			{
				return gone / length;
			}
			gone += left;
		}
		return 2.0;
	}
	/// By the solid angle that the triangles fill, seen from a point: 4 pi from inside of a closed surface.
	bool contains( const btVector3& point ) const
	{
		double sum = 0.0;
		for ( std::size_t t = 0; t < m_corner.size(); t += 3 )
		{
			const btVector3 a = m_corner[t] - point, b = m_corner[t + 1] - point, c = m_corner[t + 2] - point;
			const double la = double( a.length() ), lb = double( b.length() ), lc = double( c.length() );
			sum += 2.0 *
				std::atan2( double( a.dot( b.cross( c ) ) ),
					la * lb * lc + double( a.dot( b ) ) * lc + double( b.dot( c ) ) * la + double( c.dot( a ) ) * lb );
		}
		return sum > 6.28;
	}
	double distance( const btVector3& to ) const
	{
		double least = 1e30;
		for ( std::size_t t = 0; t < m_corner.size(); t += 3 )
		{
			least = std::min( least, double( ( nearest( t, to ) - to ).length2() ) );
		}
		return std::sqrt( least );
	}

private:
	static constexpr double kBorder = 1e-5, kSmooth = 0.766;

	/// Calls visit( fraction, normal against the ray ) for each triangle that a ray meets.
	template <class Visit>
	void visitMet( const btVector3& from, const btVector3& to, Visit&& visit ) const
	{
		const btVector3 d = to - from;
		for ( std::size_t t = 0; t < m_corner.size(); t += 3 )
		{
			const btVector3 &a = m_corner[t], e1 = m_corner[t + 1] - a, e2 = m_corner[t + 2] - a, area = e1.cross( e2 );
			const double volume = double( d.dot( area ) );
			if ( volume == 0.0 )
			{
				continue;
			}
			const double fraction = double( ( a - from ).dot( area ) ) / volume;
			const btVector3 at = from + btScalar( fraction ) * d - a;
			const double v = double( area.dot( at.cross( e2 ) ) / area.length2() ),
						 w = double( area.dot( e1.cross( at ) ) / area.length2() );
			if ( fraction >= 0.0 && fraction <= 1.0 && v >= -kBorder && w >= -kBorder && v + w <= 1.0 + kBorder )
			{
				const btVector3 face = area.normalized(), normal = smooth( t, face, { 1.0 - v - w, v, w } );
				visit( fraction, volume > 0.0 ? -face : face );
				visit( fraction, volume > 0.0 ? -normal : normal );
			}
		}
	}

	btVector3 smooth( std::size_t t, const btVector3& face, const std::array<double, 3>& weight ) const
	{
		btVector3 sum( 0, 0, 0 );
		for ( std::size_t k = 0; k < 3; ++k )
		{
			if ( double( m_normal[t + k].dot( face ) ) < kSmooth )
			{
				return face;
			}
			sum += btScalar( weight[k] ) * m_normal[t + k];
		}
		return sum.normalized();
	}
	btVector3 nearest( std::size_t t, const btVector3& to ) const
	{
		const btVector3 &a = m_corner[t], &b = m_corner[t + 1], &c = m_corner[t + 2];
		const btVector3 area = ( b - a ).cross( c - a );
		if ( area.length2() > 0 )
		{
			const btVector3 foot = to - area * ( ( to - a ).dot( area ) / area.length2() );
			if ( ( b - a ).cross( foot - a ).dot( area ) >= 0 && ( c - b ).cross( foot - b ).dot( area ) >= 0 &&
				( a - c ).cross( foot - c ).dot( area ) >= 0 )
			{
				return foot;
			}
		}
		btVector3 best = a;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			const btVector3 &p = m_corner[t + k], e = m_corner[t + ( k + 1 ) % 3] - p;
			const btScalar along = e.length2() > 0 ? btClamped( ( to - p ).dot( e ) / e.length2(), btScalar( 0 ), btScalar( 1 ) )
												   : btScalar( 0 );
			const btVector3 on = p + along * e;
			best = ( on - to ).length2() < ( best - to ).length2() ? on : best;
		}
		return best;
	}

	std::vector<btVector3> m_corner, m_normal;
};

struct NodeRay : btCollisionWorld::ClosestRayResultCallback
{
	NodeRay( const btVector3& from, const btVector3& to, const SoftBody& of ) : ClosestRayResultCallback( from, to ), body( &of ) {}
	bool needsCollision( btBroadphaseProxy* proxy ) const override { return proxy->m_clientObject == body; }
	btScalar addSingleResult( btCollisionWorld::LocalRayResult& hit, bool inWorld ) override
	{
		child = hit.m_localShapeInfo ? hit.m_localShapeInfo->m_triangleIndex : -1;
		return ClosestRayResultCallback::addSingleResult( hit, inWorld );
	}
	const SoftBody* body; ///< other objects are ignored
	int child = -1;
};

struct NodeSweep : btCollisionWorld::ClosestConvexResultCallback
{
	NodeSweep( const btVector3& from, const btVector3& to, const SoftBody& of ) : ClosestConvexResultCallback( from, to ), body( &of ) {}
	bool needsCollision( btBroadphaseProxy* proxy ) const override { return proxy->m_clientObject == body; }
	btScalar addSingleResult( btCollisionWorld::LocalConvexResult& hit, bool inWorld ) override
	{
		child = hit.m_localShapeInfo ? hit.m_localShapeInfo->m_triangleIndex : -1;
		return ClosestConvexResultCallback::addSingleResult( hit, inWorld );
	}
	const SoftBody* body; ///< other objects are ignored
	int child = -1;
};

/// Paths from all sides through a body's neighbourhood.
class RandomPaths
{
public:
	RandomPaths( const SoftBody& body, unsigned first ) : m_random( first )
	{
		body.getCollisionShape()->getAabb( body.getWorldTransform(), m_low, m_high );
		m_size = ( m_high - m_low ).length();
	}
	void next( btVector3& from, btVector3& to )
	{
		const btVector3 at( within( 0 ), within( 1 ), within( 2 ) );
		btVector3 direction( real( -1, 1 ), real( -1, 1 ), real( -1, 1 ) );
		if ( m_random() % 3 == 0 ) // along an axis: where spheres form rows
		{
			const int axis = int( m_random() % 3 );
			direction.setValue( 0, 0, 0 );
			direction[axis] = m_random() % 2 ? btScalar( 1 ) : btScalar( -1 );
		}
		direction.normalize();
		from = at - direction * m_size;
		to = at + direction * m_size;
	}
	btScalar real( btScalar low, btScalar high ) { return low + ( high - low ) * btScalar( m_random() % 1000003U ) / btScalar( 1000003 ); }

private:
	btScalar within( int axis ) { return real( m_low[axis], m_high[axis] ); }

	std::mt19937 m_random;
	btVector3 m_low, m_high;
	btScalar m_size;
};

/// How much farther the reported node is than the nearest colliding one, m; infinity for none.
inline double nodeError( const SoftBody& body, int child, const btVector3& point )
{
	const int node = body.nodeOfShapeIndex( child );
	if ( node < 0 )
	{
		return 1e30;
	}
	double least = 1e30;
	for ( int k = 0; body.nodeOfShapeIndex( k ) >= 0; ++k )
	{
		const int other = body.nodeOfShapeIndex( k );
		least = std::min( least,
			double( body.nodePosition( other ).distance( point ) - ( body.nodeLevel( other ) > 0 ? body.nodeRadius( other ) : 0 ) ) );
	}
	return double( body.nodePosition( node ).distance( point ) - ( body.nodeLevel( node ) > 0 ? body.nodeRadius( node ) : 0 ) ) - least;
}

/// Casts rays from all sides. Queries before the surface is drawn, which must not be necessary.
inline QueryTally castRays( const btCollisionWorld& world, const SoftBody& body, int count, unsigned seed )
{
	RandomPaths paths( body, seed );
	std::vector<NodeRay> rays;
	for ( int k = 0; k < count; ++k )
	{
		btVector3 from, to;
		paths.next( from, to );
		rays.emplace_back( from, to, body );
		world.rayTest( from, to, rays.back() );
	}
	const DrawnTriangles drawn( body );
	QueryTally tally;
	for ( const NodeRay& ray : rays )
	{
		const double fraction = drawn.ray( ray.m_rayFromWorld, ray.m_rayToWorld );
		++tally.asked;
		tally.hits += ray.hasHit() ? 1 : 0;
		if ( ray.hasHit() != ( fraction <= 1.0 ) )
		{
			++tally.different;
		}
		else if ( ray.hasHit() )
		{
			const double length = double( ( ray.m_rayToWorld - ray.m_rayFromWorld ).length() );
			tally.worstDistance = std::max( tally.worstDistance, std::abs( double( ray.m_closestHitFraction ) - fraction ) * length );
			tally.worstAngle = std::max(
				tally.worstAngle, drawn.angle( ray.m_rayFromWorld, ray.m_rayToWorld, fraction, ray.m_hitNormalWorld ) );
			tally.wrongNodes += nodeError( body, ray.child, ray.m_hitPointWorld ) > 1e-3 * double( body.bodyTemplate().cellSize() ) ? 1 : 0;
		}
	}
	return tally;
}

/// Sweeps balls of up to two cells from all sides.
inline QueryTally sweepBalls( const btCollisionWorld& world, const SoftBody& body, int count, unsigned seed )
{
	const DrawnTriangles drawn( body );
	RandomPaths paths( body, seed );
	QueryTally tally;
	for ( int k = 0; k < count; ++k )
	{
		btVector3 from, to;
		paths.next( from, to );
		btSphereShape ball( body.bodyTemplate().cellSize() * paths.real( btScalar( 0.02 ), 2 ) );
		NodeSweep sweep( from, to, body );
		world.convexSweepTest(
			&ball, btTransform( btQuaternion::getIdentity(), from ), btTransform( btQuaternion::getIdentity(), to ), sweep );
		// A ball that grazes the surface may pass or hit: a slightly larger one hits it earlier, a slightly smaller one later.
		const double radius = double( ball.getRadius() ), hair = 1e-4 * radius + 2e-5, length = double( ( to - from ).length() );
		const double earliest = drawn.ball( from, to, radius + hair ), latest = drawn.ball( from, to, radius - hair );
		++tally.asked;
		tally.hits += sweep.hasHit() ? 1 : 0;
		if ( sweep.hasHit() ? earliest > 1.0 : latest <= 1.0 )
		{
			++tally.different;
		}
		else if ( sweep.hasHit() )
		{
			const double fraction = double( sweep.m_closestHitFraction ), tenth = 0.1 * double( body.bodyTemplate().cellSize() );
			tally.worstDistance = std::max( { tally.worstDistance, ( earliest - fraction ) * length, ( fraction - latest ) * length } );
			tally.wrongNodes += nodeError( body, sweep.child, sweep.m_hitPointWorld ) > 0.01 * tenth ? 1 : 0;
		}
	}
	return tally;
}

} // namespace pliant::test
