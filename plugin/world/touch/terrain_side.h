#pragma once

// A heightfield has ground below it. Its triangles are two-sided, as those of every mesh, and a node below one is pushed farther down:
// where the game raises the field by more than a node's radius in a step, bodies on it would be drawn into the ground. So nodes below a
// triangle are pushed up where another part of their body is above it. A body that is below as a whole meets the field as a sheet.

#include "world/shape/node_shape.h"
#include "world/touch/node_touch.h"

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>

namespace pliant {

class TerrainSide
{
public:
	/// `corners` relative to the soft body's origin; `shift`: the origin of its shape in the same coordinates.
	TerrainSide( const Obstacle& mesh, const Vec3d ( &corners )[3], const NodeShape& body, const Vec3d& shift ) :
		m_mesh( mesh ), m_corners( corners )
	{
		if ( mesh.shape->getShapeType() != TERRAIN_SHAPE_PROXYTYPE )
		{
			return;
		}
		m_up = mesh.basis.col( static_cast<const btHeightfieldTerrainShape*>( mesh.shape )->getUpAxis() );
		m_normal = ( corners[1] - corners[0] ).cross( corners[2] - corners[0] ).normalized();
		m_orientation = m_normal.dot( m_up ) < 0.0 ? -1.0 : 1.0;
		m_normal *= m_orientation;
		// The box around the centres of the body's spheres.
		const Vec3d ball = Vec3d::Constant( double( body.largestRadius() ) );
		const Vec3d low = toVec3d( body.rows().whole().mins() ) + shift + ball, high = toVec3d( body.rows().whole().maxs() ) + shift - ball;
		const double middle = m_normal.dot( ( low + high ) / 2.0 - corners[0] ), half = m_normal.cwiseAbs().dot( high - low ) / 2.0;
		m_isPenetrated = middle + half > 0.0 && middle - half < 0.0;
		m_deepest = ( high - low ).norm();
	}

	/// From the triangle to the deepest node that may be in the ground below it, m.
	Vec3d exitBelow() const { return m_isPenetrated ? Vec3d( -m_deepest * m_up ) : Vec3d( Vec3d::Zero() ); }

	/// Whether a sphere's centre is below the triangle; then `touch` is the direction out of the ground.
	bool contains( const Vec3d& centre, Touch& touch ) const
	{
		const double height = m_isPenetrated ? m_normal.dot( centre - m_corners[0] ) : 0.0;
		if ( height >= 0.0 )
		{
			return false;
		}
		for ( int k = 0; k < 3; ++k )
		{
			const Vec3d edge = m_corners[( k + 1 ) % 3] - m_corners[k];
			if ( m_orientation * m_up.dot( edge.cross( centre - m_corners[k] ) ) < 0.0 )
			{
				return false;
			}
		}
		touch = Touch{};
		touch.normal = m_normal;
		touch.distance = height;
		return true;
	}

	/// False for touches that push a node in the ground down, except at the field's border.
	bool allows( const Vec3d& centre, const Touch& touch ) const
	{
		return !m_isPenetrated || touch.normal.dot( m_up ) >= 0.0 || !isOverField( centre );
	}

private:
	bool isOverField( const Vec3d& centre ) const
	{
		btVector3 low, high;
		m_mesh.shape->getAabb( btTransform::getIdentity(), low, high );
		const Vec3d local = m_mesh.toLocal( centre );
		const int up = static_cast<const btHeightfieldTerrainShape*>( m_mesh.shape )->getUpAxis();
		const double margin = double( m_mesh.shape->getMargin() ); // Bullet's box includes it
		for ( int axis = 0; axis < 3; ++axis )
		{
			if ( axis != up && ( local[axis] < double( low[axis] ) + margin || local[axis] > double( high[axis] ) - margin ) )
			{
				return false;
			}
		}
		return true;
	}

	const Obstacle& m_mesh;
	const Vec3d ( &m_corners )[3];
	Vec3d m_up = Vec3d::Zero(), m_normal = Vec3d::Zero();
	double m_orientation = 1.0;  ///< -1 for corners that are clockwise, seen from above
	double m_deepest = 0.0;      ///< m
	bool m_isPenetrated = false; ///< part of the body lies above the triangle's plane and part below
};

} // namespace pliant
