#pragma once

// Common to the tests of misuse: bad values, and a world with existing and destroyed objects.

#include "c/face.h"

#include <functional>
#include <string>

namespace pliant::test {

inline constexpr pliant_vec3 kZero = { 0, 0, 0 };
inline constexpr pliant_vec3 kUp = { 0, 1, 0 };
inline constexpr pliant_vec3 kBadVector = { 0, kBad, 0 };
inline constexpr pliant_vec3 kFar = { 0, 1e30, 0 };
inline constexpr pliant_pose kPose = { { 0, 0, 0 }, { 0, 0, 0, 1 } };
inline constexpr pliant_pose kBadPose = { { 0, kBad, 0 }, { 0, 0, 0, 1 } };
inline constexpr pliant_pose kNoTurn = { { 0, 0, 0 }, { 0, 0, 0, 0 } };
inline constexpr pliant_vec3 kBlade[4] = {};

struct Target
{
	pliant_world* world;
	pliant_id id;
};

using Call = std::function<pliant_result( const Target& )>;

/// A call on an object, with valid arguments otherwise.
struct Named
{
	const char* name;
	Call call;
};

#define PLIANT_NAMED( ... )                                                                                                                \
	Named                                                                                                                                  \
	{                                                                                                                                      \
		#__VA_ARGS__, []( [[maybe_unused]] const Target& t ) { return __VA_ARGS__; }                                                       \
	}

/// A soft body, a ball, and identities of objects that no longer exist.
struct MisuseScene : CScene
{
	pliant_id soft = add( pliant_vec3{ 0, 1, 0 } );
	pliant_id ball = addBall( pliant_vec3{ 0, 3, 0 }, 2 );
	pliant_id goneSoft = add( pliant_vec3{ 5, 1, 0 } ), goneBall = addBall( pliant_vec3{ 5, 3, 0 }, 2 );

	MisuseScene()
	{
		EXPECT_EQ( pliant_object_destroy( world, goneSoft ), PLIANT_OK );
		EXPECT_EQ( pliant_object_destroy( world, goneBall ), PLIANT_OK );
	}

	void expectRefused( pliant_result expected, const std::vector<Named>& calls, const Target& target )
	{
		const std::vector<double> before = everything();
		for ( const Named& each : calls )
		{
			EXPECT_EQ( each.call( target ), expected ) << each.name;
			EXPECT_GT( std::string( pliant_last_error() ).size(), 10u ) << each.name;
		}
		EXPECT_EQ( everything(), before );
	}
};

} // namespace pliant::test
