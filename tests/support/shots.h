#pragma once

// Soft bodies shot at fixed walls with random (seeded) bodies, speeds, spins, angles and positions. None may end up behind the wall.

#include "support/explicit_material.h"
#include "support/test_world.h"

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

namespace pliant::test {

enum class Wall : int
{
	Plane,
	Box,
	Mesh,
	Heightfield,
	Thin ///< a box one millimetre thick
};
constexpr int kWalls = 5;
inline const char* const kWallNames[kWalls] = { "plane", "box", "mesh", "heightfield", "1 mm wall" };

enum class Shot : int
{
	Cube,     ///< 4 cells an edge
	WideCube, ///< 6 cells, regions of half-width 2
	Sheet,    ///< one cell thick
	Rod,      ///< one cell thick and wide
	Ball,
	Coarse, ///< two levels, split by strain
	Touchy  ///< one level, half-width 2, split by contact
};
constexpr int kShots = 7;
inline const char* const kShotNames[kShots] = { "cube", "cube, w = 2", "sheet", "rod", "ball", "levels", "levels, w = 2" };

struct ShotResult
{
	Wall wall = Wall::Plane;
	Shot shot = Shot::Cube;
	unsigned seed = 0;
	double speed = 0.0, youngsModulus = 0.0; ///< m/s, Pa
	bool hits = false;                       ///< touched the wall
	int behind = 0;                          ///< number of node centres behind the wall at the end
	double deepest = 0.0;                    ///< greatest depth of a node centre behind the wall's face, m
	bool isHealthy = true;
};

/// Templates and walls are created once.
class ShootingRange
{
public:
	ShootingRange()
	{
		m_templates = { box( { 4, 4, 4 }, 0.1f ), box( { 6, 6, 6 }, 0.1f ), box( { 8, 1, 8 }, 0.05f ), box( { 10, 1, 1 }, 0.05f ),
			ball( 0.25f, 0.07f ), box( { 8, 8, 8 }, 0.06f ), box( { 8, 6, 4 }, 0.08f ) };
		std::mt19937 random( 5 );
		for ( float& height : m_heights )
		{
			height = float( random() ) / 4294967296.0f * 0.6f - 0.3f;
		}
		m_mesh = std::make_unique<btTriangleMesh>();
		for ( int k = 0; k < ( kPosts - 1 ) * ( kPosts - 1 ); ++k )
		{
			const int i = k % ( kPosts - 1 ), j = k / ( kPosts - 1 );
			m_mesh->addTriangle( post( i, j ), post( i, j + 1 ), post( i + 1, j ) );
			m_mesh->addTriangle( post( i + 1, j ), post( i, j + 1 ), post( i + 1, j + 1 ) );
		}
	}

	/// Fires shot number `seed`; walls and bodies alternate.
	ShotResult shoot( unsigned seed, Elasticity elasticity ) const
	{
		std::mt19937 random( seed * 2654435761u + 17u );
		const auto fraction = [&random] { return double( random() ) / 4294967296.0; };
		ShotResult result;
		result.seed = seed;
		result.wall = Wall( int( seed ) % kWalls );
		result.shot = Shot( int( seed ) / kWalls % kShots );
		result.speed = 10.0 * std::pow( 10.0, fraction() );
		result.youngsModulus = std::pow( 10.0, 3.0 + 3.0 * fraction() );

		// The wall's outward normal is its own y axis; its orientation is arbitrary.
		SoftWorld t;
		const btTransform wall( turn( fraction(), fraction(), fraction() ), btVector3( 0, 0, 0 ) );
		t.world.setGravity( wall.getBasis() * btVector3( 0, btScalar( -9.81 ), 0 ) );
		btCollisionShape* shape = makeWall( result.wall );
		btRigidBody* standing = t.add( 0, shape, btVector3( 0, 0, 0 ) );
		standing->setWorldTransform(
			wall * btTransform( btQuaternion::getIdentity(), btVector3( 0, -thicknessOf( result.wall ) / 2, 0 ) ) );
		standing->setFriction( btScalar( fraction() ) );
		standing->setRestitution( btScalar( fraction() < 0.5 ? 0.0 : fraction() ) );
		t.world.updateSingleAabb( standing );

		const double tilt = fraction() * 60.0 * SIMD_PI / 180.0, round = fraction() * 2.0 * SIMD_PI;
		const btVector3 direction( btScalar( std::sin( tilt ) * std::cos( round ) ), btScalar( -std::cos( tilt ) ),
			btScalar( std::sin( tilt ) * std::sin( round ) ) );
		const btVector3 start = btVector3( btScalar( fraction() - 0.5 ), btScalar( 0.3 ), btScalar( fraction() - 0.5 ) ) -
			direction * btScalar( 0.6 + 2.0 * fraction() );
		SoftBody* body = t.add( m_templates[std::size_t( result.shot )], start, materialOf( result, elasticity ),
			turn( fraction(), fraction(), fraction() ), adaptivityOf( result.shot ) );
		if ( !body )
		{
			return result;
		}
		static_cast<void>( body->teleport( wall ) );
		const btVector3 spin( btScalar( fraction() - 0.5 ), btScalar( fraction() - 0.5 ), btScalar( fraction() - 0.5 ) );
		static_cast<void>(
			body->setVelocities( wall.getBasis() * direction * btScalar( result.speed ), spin * btScalar( 60.0 * fraction() ) ) );
		body->setRestitution( btScalar( fraction() < 0.5 ? 0.0 : fraction() ) );
		// Nodes that slide off the wall's edge have not passed through it.
		const auto isOver = [&]( const btVector3& at ) { return btMax( btFabs( at.x() ), btFabs( at.z() ) ) < kHalfWidth - 1; };
		for ( int frame = 0; frame < kFrames && isOver( wall.invXform( body->massCentre() ) ); ++frame )
		{
			t.step( 1 );
			result.hits = result.hits || t.world.stepReport().softContacts > 0;
			look( *body, *shape, wall, result );
		}
		result.isHealthy = body->isHealthy();
		return result;
	}

private:
	static constexpr int kPosts = 121;
	static constexpr float kPostsApart = 0.5f; ///< m
	static constexpr btScalar kHalfWidth = btScalar( 0.5 ) * btScalar( kPostsApart ) * ( kPosts - 1 );
	static constexpr int kFrames = 36;

	static btScalar thicknessOf( Wall wall )
	{
		return wall == Wall::Box ? btScalar( 1 ) : wall == Wall::Thin ? btScalar( 1e-3 ) : btScalar( 0 );
	}

	static btQuaternion turn( double a, double b, double c )
	{
		btQuaternion q( btScalar( a - 0.5 ), btScalar( b - 0.5 ), btScalar( c - 0.5 ), btScalar( 0.5 ) );
		return q.normalized();
	}

	static std::shared_ptr<const BodyTemplate> fromMesh(
		const std::vector<float>& positions, const std::vector<std::uint32_t>& indices, float cell )
	{
		LatticeSettings settings;
		settings.cellSize = cell;
		settings.skinning = Skinning::None;
		return BodyTemplate::build( MeshView{ positions.data(), positions.size() / 3, 3, indices.data(), indices.size() / 3 }, settings )
			.value;
	}

	struct Size
	{
		int x, y, z;
	};
	static std::shared_ptr<const BodyTemplate> box( const Size& cells, float cell )
	{
		std::vector<float> positions;
		for ( int i = 0; i < 8; ++i )
		{
			positions.insert( positions.end(),
				{ cell * float( cells.x ) * ( float( i & 1 ) - 0.5f ), cell * float( cells.y ) * ( float( i >> 1 & 1 ) - 0.5f ),
					cell * float( cells.z ) * ( float( i >> 2 & 1 ) - 0.5f ) } );
		}
		return fromMesh( positions,
			{ 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 }, cell );
	}

	static std::shared_ptr<const BodyTemplate> ball( float radius, float cell )
	{
		constexpr int kRings = 10, kSectors = 16;
		std::vector<float> positions;
		for ( int k = 0; k <= kRings * kSectors + kSectors - 1; ++k )
		{
			const float up = float( SIMD_PI ) * float( k / kSectors ) / float( kRings ),
						round = 2.0f * float( SIMD_PI ) * float( k % kSectors ) / float( kSectors );
			positions.insert( positions.end(),
				{ radius * std::sin( up ) * std::cos( round ), radius * std::cos( up ), radius * std::sin( up ) * std::sin( round ) } );
		}
		std::vector<std::uint32_t> indices;
		for ( std::uint32_t k = 0; k < kRings * kSectors; ++k )
		{
			const std::uint32_t next = k / kSectors * kSectors + ( k + 1 ) % kSectors;
			indices.insert( indices.end(), { k, next, k + kSectors, next, next + kSectors, k + kSectors } );
		}
		return fromMesh( positions, indices, cell );
	}

	btVector3 post( int i, int j ) const
	{
		const btScalar middle = btScalar( 0.5 ) * ( kPosts - 1 );
		return btVector3( kPostsApart * ( i - middle ), m_heights[std::size_t( j * kPosts + i )], kPostsApart * ( j - middle ) );
	}

	/// The face is y = 0 except for bumpy walls.
	btCollisionShape* makeWall( Wall wall ) const
	{
		constexpr btScalar wide = kHalfWidth;
		switch ( wall )
		{
			case Wall::Plane: return new btStaticPlaneShape( btVector3( 0, 1, 0 ), 0 );
			case Wall::Box:
			case Wall::Thin: return new btBoxShape( btVector3( wide, thicknessOf( wall ) / 2, wide ) );
			case Wall::Mesh: return new btBvhTriangleMeshShape( m_mesh.get(), true );
			default: {
				auto* field = new btHeightfieldTerrainShape(
					kPosts, kPosts, m_heights.data(), btScalar( -0.3 ), btScalar( 0.3 ), 1, false );
				field->setLocalScaling( btVector3( kPostsApart, 1, kPostsApart ) );
				return field;
			}
		}
	}

	static Material materialOf( const ShotResult& result, Elasticity elasticity )
	{
		Material material = test::explicitMaterial();
		material.youngsModulus = float( result.youngsModulus );
		material.elasticity = elasticity;
		material.regionHalfWidth = result.shot == Shot::WideCube || result.shot == Shot::Touchy ? 2 : 1;
		return material;
	}

	static Adaptivity adaptivityOf( Shot shot )
	{
		Adaptivity adaptivity;
		adaptivity.coarseLevels = shot == Shot::Coarse ? 2 : shot == Shot::Touchy ? 1 : 0;
		adaptivity.refineStrain = shot == Shot::Coarse ? 0.2f : 0.0f;
		adaptivity.refinesOnContact = shot == Shot::Touchy;
		return adaptivity;
	}

	/// Sets the height of the wall's face at a position in its own coordinates; returns false outside of it.
	static bool faceAt( const btCollisionShape& shape, const btVector3& at, btScalar& height )
	{
		if ( !shape.isConcave() || shape.getShapeType() == STATIC_PLANE_PROXYTYPE )
		{
			height = 0;
			return true;
		}
		struct Under : btTriangleCallback
		{
			btVector3 at;
			btScalar height = 0;
			bool isFound = false;
			void processTriangle( btVector3* c, int, int ) override
			{
				const btVector3 e = c[1] - c[0], f = c[2] - c[0], p = at - c[0];
				const btScalar area = e.x() * f.z() - e.z() * f.x();
				const btScalar u = ( p.x() * f.z() - p.z() * f.x() ) / area, v = ( e.x() * p.z() - e.z() * p.x() ) / area;
				if ( u >= 0 && v >= 0 && u + v <= 1 )
				{
					isFound = true;
					height = c[0].y() + u * e.y() + v * f.y();
				}
			}
		} under;
		under.at = at;
		const btVector3 low( at.x(), -1, at.z() ), high( at.x(), 1, at.z() );
		static_cast<const btConcaveShape&>( shape ).processAllTriangles( &under, low, high );
		height = under.height;
		return under.isFound;
	}

	static void look( const SoftBody& body, const btCollisionShape& shape, const btTransform& wall, ShotResult& result )
	{
		result.behind = 0;
		// For a thin wall the middle plane counts.
		const btScalar allowed = result.wall == Wall::Thin ? thicknessOf( Wall::Thin ) / 2 : btScalar( 0 );
		const auto depthOf = [&]( const btVector3& point ) {
			const btVector3 at = wall.invXform( point );
			btScalar height = 0;
			return faceAt( shape, at, height ) ? height - at.y() : btScalar( 0 );
		};
		for ( int i = 0; i < body.nodeCount(); ++i )
		{
			const btScalar depth = depthOf( body.nodePosition( i ) );
			result.behind += depth > allowed ? 1 : 0;
			result.deepest = std::max( result.deepest, double( depth ) );
		}
	}

	std::vector<std::shared_ptr<const BodyTemplate>> m_templates;
	std::vector<float> m_heights = std::vector<float>( std::size_t( kPosts * kPosts ) );
	std::unique_ptr<btTriangleMesh> m_mesh;
};

} // namespace pliant::test
