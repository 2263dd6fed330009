#pragma once

// Tables of misuses: the result of each call, and a check that nothing in the world has changed, to the byte. tests/house finds the calls
// by their quoted names, and requires that no call of the public headers is missing.

#include "world/test_world.h"

#include <pliant/io/snapshot.h>

#include <climits>
#include <cmath>
#include <limits>

namespace pliant::test {

constexpr ResultCode kBad = ResultCode::BadArgument;
constexpr btScalar kNan = std::numeric_limits<btScalar>::quiet_NaN(), kInf = std::numeric_limits<btScalar>::infinity();

/// Kind and state of the misused body.
enum class BodyState : int
{
	Resting,
	Asleep,
	Static,
	Kinematic,
	Implicit,
	Rigid,       ///< Material::rigidStrain
	Quarantined, ///< SoftBody::isHealthy
	Broken,
	Levels,
	Held, ///< pinned, driven, attached
	Elsewhere,
	InNoWorld
};
constexpr BodyState kBodyStates[] = { BodyState::Resting, BodyState::Asleep, BodyState::Static, BodyState::Kinematic, BodyState::Implicit,
	BodyState::Rigid, BodyState::Quarantined, BodyState::Broken, BodyState::Levels, BodyState::Held, BodyState::Elsewhere,
	BodyState::InNoWorld };

/// A world with a body to misuse, another soft body, and rigid bodies; and a second world.
class Scene
{
public:
	explicit Scene( BodyState state );

	/// Everything in both worlds, and the body if it is in none.
	std::vector<std::byte> bytes( bool isForComparison ) const;
	void run( int steps );
	/// The soft body's contact proxy in a manifold; null without a contact.
	btCollisionObject* proxy() const;

	TestWorld home, elsewhere;
	btRigidBody *floor = nullptr, *box = nullptr, *farBox = nullptr, *frame = nullptr;
	std::unique_ptr<btCollisionShape> looseShape;
	std::unique_ptr<btRigidBody> loose; ///< in no world
	SoftBody *body = nullptr, *other = nullptr;
	std::unique_ptr<SoftBody> bare, posed, drawn; ///< in no world: without a skin, after bones, after targets
	int attachment = -1;
	Wind field; ///< of the second world

private:
	std::unique_ptr<SoftBody> m_free;
};

using Answers = std::vector<Status>;

struct Misuse
{
	const char* call;            ///< with its class
	ResultCode code;             ///< of all results. Ok: the call returns a neutral value, or ignores its argument
	Answers ( *make )( Scene& ); ///< several misuses
	const char* word = nullptr;  ///< a word that each sentence contains; null: the call's name
};

/// A result that is no Status.
inline Status answers( bool isAsStated )
{
	return isAsStated ? Status{} : Status{ kBad, "the call answers otherwise than its documentation says" };
}

template <class T>
Status statusOf( const Result<T>& result )
{
	return result.status;
}

/// A structure of settings with one value changed.
template <class Struct, class Value>
Struct changed( Struct all, Value Struct::*field, Value value )
{
	all.*field = value;
	return all;
}

/// Calls `call` with vectors that hold a bad number.
template <class Call>
Answers forBadVectors( const Call& call )
{
	return { call( btVector3( kNan, 0, 0 ) ), call( btVector3( 0, kInf, 0 ) ), call( btVector3( 0, 0, -kInf ) ) };
}

/// Calls `call` with indices out of 0 to count - 1.
template <class Call>
Answers forBadIndices( int count, const Call& call )
{
	return { call( -1 ), call( count ), call( INT_MAX ), call( INT_MIN ) };
}

/// Makes each misuse in a scene; expects its result, unchanged bytes, and that the scene continues like one without the misuse.
void expectNothingChanges( BodyState state, const Misuse* first, const Misuse* last );

template <std::size_t N>
void expectNothingChanges( BodyState state, const Misuse ( &table )[N] )
{
	expectNothingChanges( state, table, table + N );
}

} // namespace pliant::test
