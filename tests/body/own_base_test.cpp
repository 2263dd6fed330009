// Bodies share their template's data until their links change; then each has a copy, which it changes in place.

#include "body/breaking.h"
#include "body/levels/levels.h"
#include "support/block_body.h"
#include "support/block_lattice.h"
#include "support/explicit_material.h"
#include "support/same_levels.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

/// A piece's positions are those of the whole, translated: one rounding each.
constexpr float kBaseRounding = 2e-5f;

std::vector<BodyPiece> cutAtFour( Body& body, int most, PieceBuild road = PieceBuild::Reuse )
{
	body.breakLinks( test::linksAtFour( body.lattice(), most ) );
	while ( body.mustRefineToBreak() )
	{
		body.refineToBreak();
	}
	BreakReport report;
	return body.breakApart( report, 10, road );
}

/// A notch, then a full cut: the lower cells come off, and the remaining cells are renumbered.
std::vector<BodyPiece> cutTwice( Body& body, PieceBuild road = PieceBuild::Reuse )
{
	std::vector<BodyPiece> notched = cutAtFour( body, 3, road );
	EXPECT_EQ( notched.size(), 1u );
	return cutAtFour( *notched[0].body, 8, road );
}

void expectSamePieces( const std::vector<BodyPiece>& got, const std::vector<BodyPiece>& wanted, float allowed )
{
	ASSERT_EQ( got.size(), wanted.size() );
	for ( std::size_t k = 0; k < got.size(); ++k )
	{
		EXPECT_EQ( got[k].cellBefore, wanted[k].cellBefore );
		test::expectNearBase( got[k].body->levels()->base(), wanted[k].body->levels()->base(), allowed );
		test::expectNearTables( *got[k].body->levels()->tables(), *wanted[k].body->levels()->tables(), allowed );
	}
}

struct OwnBase : testing::Test
{
	std::shared_ptr<const Lattice> lattice = std::make_shared<const Lattice>( makeBlockLattice( 16, 8, 8, 0.1f ) );
	std::shared_ptr<TemplateCache> cache = std::make_shared<TemplateCache>();

	std::unique_ptr<Body> body() const
	{
		Adaptivity settings;
		settings.coarseLevels = 2;
		return std::move( Body::create( lattice, test::explicitMaterial(), {}, cache, settings ).value );
	}
};

TEST_F( OwnBase, ChangesInPlaceWhenSomethingComesOff )
{
	const std::unique_ptr<Body> one = body(), other = body();
	const std::vector<BodyPiece> got = cutTwice( *one ), wanted = cutTwice( *other, PieceBuild::FromScratch );
	ASSERT_EQ( got.size(), 2u );
	ASSERT_NE( got[0].cellBefore[0], 0u ); // otherwise nothing would have to be renumbered
	expectSamePieces( got, wanted, kBaseRounding );
}

TEST_F( OwnBase, KeepsTheBaseOfOtherBodies )
{
	const std::unique_ptr<Body> whole = body(), first = body(), second = body();
	cutTwice( *first );
	const std::unique_ptr<Body> fresh = body();
	EXPECT_EQ( &fresh->levels()->base(), &whole->levels()->base() );
	cache = std::make_shared<TemplateCache>();
	const std::unique_ptr<Body> alone = body();
	test::expectNearBase( whole->levels()->base(), alone->levels()->base(), 0.0f );
	expectSamePieces( cutTwice( *second ), cutTwice( *alone ), 0.0f );
}

/// Also with a single body: the template can find its base as long as the body exists.
TEST_F( OwnBase, OfASingleBodyIsTheTemplatesAtFirst )
{
	const std::unique_ptr<Body> only = body();
	const std::vector<BodyPiece> notched = cutAtFour( *only, 3 );
	const std::unique_ptr<Body> later = body();
	cache = std::make_shared<TemplateCache>();
	const std::unique_ptr<Body> alone = body();
	test::expectNearBase( later->levels()->base(), alone->levels()->base(), 0.0f );
	expectSamePieces( notched, cutAtFour( *alone, 3 ), 0.0f );
}

/// Another thread may create a body of the template while this one changes: the base that it finds is complete.
TEST_F( OwnBase, AloneIsTakenApart )
{
	Adaptivity settings;
	settings.coarseLevels = 2;
	const std::vector<float> stiffness;
	std::shared_ptr<const LevelBase> base = cache->levels.find( *lattice, test::explicitMaterial(), settings );
	Cut cut = firstCut( base->octree, settings );
	Levels levels(
		std::move( base ), *lattice, test::explicitMaterial(), settings, stiffness, std::move( cut ) ); // the only ones of the template
	EXPECT_TRUE( levels.takeBaseScratch().moments.covariance.empty() );
	EXPECT_FALSE( levels.base().moments.covariance.empty() );
	levels.ownBase();
	EXPECT_FALSE( levels.takeBaseScratch().moments.covariance.empty() );
}

TEST_F( OwnBase, IsMadeAhead )
{
	const std::unique_ptr<Body> prepared = body(), unprepared = body();
	prepared->prepareToBreak();
	EXPECT_NE( &prepared->levels()->base(), &unprepared->levels()->base() );
	const LevelBase* const own = &prepared->levels()->base();
	prepared->prepareToBreak();
	EXPECT_EQ( &prepared->levels()->base(), own ); // created once
	expectSamePieces( cutTwice( *prepared ), cutTwice( *unprepared ), 0.0f );
}

} // namespace
} // namespace pliant
