#pragma once

// Scenes through the C face, for its tests.

#include "pliant/c/pliant.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace pliant::test {

inline constexpr double kBad = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinite = std::numeric_limits<double>::infinity();
inline constexpr double kFrame = 1.0 / 60.0;

/// Fills a structure with its defaults.
template <class T>
T initial( pliant_result ( *init )( T*, std::uint32_t ) )
{
	T made;
	EXPECT_EQ( init( &made, sizeof made ), PLIANT_OK );
	return made;
}

/// A unit cube around the origin.
struct CubeMesh
{
	std::vector<float> positions;
	std::vector<std::uint32_t> indices{
		0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
	pliant_mesh view = initial( pliant_mesh_init );

	CubeMesh()
	{
		for ( int i = 0; i < 8; ++i )
		{
			for ( int k = 0; k < 3; ++k )
			{
				positions.push_back( float( i >> k & 1 ) - 0.5f );
			}
		}
		view.positions = positions.data();
		view.vertex_count = 8;
		view.indices = indices.data();
		view.triangle_count = 12;
	}
};

/// A world with a floor, and a template of a cube.
struct CScene
{
	pliant_world* world = nullptr;
	pliant_template* cube = nullptr;
	pliant_id floor = 0;

	explicit CScene( float cell = 0.25f )
	{
		EXPECT_EQ( pliant_world_create( nullptr, &world ), PLIANT_OK );
		EXPECT_EQ( pliant_rigid_create_plane( world, pliant_vec3{ 0, 1, 0 }, nullptr, &floor ), PLIANT_OK );
		const CubeMesh mesh;
		auto lattice = initial( pliant_lattice_settings_init );
		lattice.cell_size = cell;
		EXPECT_EQ( pliant_template_build( &mesh.view, &lattice, &cube ), PLIANT_OK ) << pliant_last_error();
	}
	~CScene()
	{
		pliant_template_release( cube );
		pliant_world_destroy( world );
	}
	CScene( const CScene& ) = delete;
	CScene& operator=( const CScene& ) = delete;

	pliant_id add( const pliant_vec3& at, const pliant_fracture* fracture = nullptr )
	{
		auto settings = initial( pliant_body_settings_init );
		settings.pose.position = at;
		settings.fracture = fracture;
		pliant_id made = 0;
		EXPECT_EQ( pliant_body_create( world, cube, &settings, &made ), PLIANT_OK ) << pliant_last_error();
		return made;
	}
	pliant_id addBall( const pliant_vec3& at, double mass, const pliant_vec3& velocity = {} )
	{
		auto settings = initial( pliant_rigid_settings_init );
		settings.pose.position = at;
		settings.mass = mass;
		settings.linear_velocity = velocity;
		pliant_id made = 0;
		EXPECT_EQ( pliant_rigid_create_sphere( world, 0.25, &settings, &made ), PLIANT_OK ) << pliant_last_error();
		return made;
	}
	void step( int count = 1 )
	{
		for ( int k = 0; k < count; ++k )
		{
			EXPECT_EQ( pliant_world_step( world, kFrame, 0, kFrame, nullptr ), PLIANT_OK );
		}
	}
	std::vector<pliant_id> bodies() const
	{
		std::uint64_t count = 0;
		EXPECT_EQ( pliant_world_get_bodies( world, nullptr, 0, &count ), PLIANT_OK );
		std::vector<pliant_id> ids( count );
		EXPECT_EQ( pliant_world_get_bodies( world, ids.data(), count, &count ), PLIANT_OK );
		return ids;
	}
	pliant_body_state state( pliant_id body ) const
	{
		pliant_body_state state{};
		EXPECT_EQ( pliant_body_get_state( world, body, &state, sizeof state ), PLIANT_OK ) << pliant_last_error();
		return state;
	}
	/// Positions and velocities of all nodes of all bodies, and the poses of all rigid bodies.
	std::vector<double> everything() const;
};

inline std::vector<double> CScene::everything() const
{
	std::vector<double> all;
	for ( const pliant_id body : bodies() )
	{
		std::uint64_t nodes = std::uint64_t( state( body ).nodes );
		const std::size_t before = all.size();
		all.resize( before + 6 * nodes );
		EXPECT_EQ( pliant_body_get_positions( world, body, all.data() + before, nodes, &nodes ), PLIANT_OK );
		EXPECT_EQ( pliant_body_get_velocities( world, body, all.data() + before + 3 * nodes, nodes, &nodes ), PLIANT_OK );
	}
	pliant_id rigids[16];
	std::uint64_t count = 0;
	EXPECT_EQ( pliant_world_get_rigids( world, rigids, 16, &count ), PLIANT_OK );
	for ( std::uint64_t k = 0; k < count; ++k )
	{
		pliant_pose pose{};
		EXPECT_EQ( pliant_rigid_get_pose( world, rigids[k], &pose ), PLIANT_OK );
		all.insert( all.end(), { pose.position.x, pose.position.y, pose.position.z } );
		all.insert( all.end(), pose.rotation, pose.rotation + 4 );
	}
	return all;
}

} // namespace pliant::test
