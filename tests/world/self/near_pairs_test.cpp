// Pairs kept from step to step, through motion, changes of levels and cuts, equal those of a new search.

#include "world/levels/adaptive_bodies.h"

#include "support/shapes.h"

#include <algorithm>
#include <random>
#include <set>

namespace pliant::test {
namespace {

constexpr float kPairCell = 0.05f; // m

std::vector<std::uint64_t> keysOf( const std::vector<NodeHit>& hits )
{
	std::vector<std::uint64_t> keys;
	for ( const NodeHit& hit : hits )
	{
		keys.push_back( hit.key );
	}
	return keys;
}

/// Compares the pairs of the body's continuing search with those of a new one, at the nodes' positions; a fast node is predicted by half a
/// margin or more.
std::size_t compare( SoftBody& soft, const char* after )
{
	SelfSearch fresh;
	const std::vector<std::uint64_t> expected = keysOf( fresh.find( soft, 0.0 ) ),
									 found = keysOf( soft.impl().self->search.find( soft, 0.0 ) );
	EXPECT_EQ( found, expected ) << after;
	return found.size();
}

/// Pushes a layer of nodes, and its neighbours, at random: some far, most not.
void push( SoftBody& soft, std::mt19937& random )
{
	NodeState& nodes = soft.impl().body->nodes();
	const auto any = [&random] { return float( random() % 1000 ) / 500.0f - 1.0f; };
	const float at = 8.0f * kPairCell * any(), wide = 2.0f * kPairCell;
	const Vec3 displacement = Vec3( any(), any(), any() ) * kPairCell;
	for ( int i = 0; i < nodes.count; ++i )
	{
		if ( std::abs( nodes.x0.x[i] - at ) < wide && nodes.freedom[i] != 0.0f )
		{
			nodes.x.set( i, nodes.x.get( i ) + displacement );
		}
	}
	soft.impl().shape->place( nodes, soft.impl().shapeShift );
}

void cut( SoftBody& soft, std::mt19937& random )
{
	const auto any = [&random] { return btScalar( random() % 1000 ) / btScalar( 500 ) - btScalar( 1 ); };
	const btVector3 foot = btScalar( 8.0f * kPairCell ) * btVector3( any(), any() / 2, 0 ),
					along = btScalar( 8.0f * kPairCell ) * btVector3( any(), any(), 0 ), edge( 0, 0, 1 );
	soft.cutSweep( foot - edge, foot + edge, foot + along - edge, foot + along + edge );
}

class NearPairsOf : public testing::TestWithParam<int>
{};

TEST_P( NearPairsOf, ACutAndSplitBodyEqualThoseOfANewSearch )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const soft = test.addSoft( block( 16, 8, 4, kPairCell ), at( 0, 0, 0 ), stiff( 2e4f ), levels( GetParam() ) );
	EXPECT_TRUE( soft->setSelfCollision( true ).ok() );
	std::mt19937 random( 5 );
	std::size_t found = 0;
	int cuts = 0, splits = 0;
	for ( int round = 0; round < 80; ++round )
	{
		push( *soft, random );
		found += compare( *soft, "a push" );
		if ( GetParam() > 0 && round % 3 == 0 )
		{
			std::vector<std::uint32_t> split = coarseNodes( *soft, anyNode );
			split.resize( std::min( split.size(), std::size_t( 2 ) ) );
			changeLevels( *soft, split, {} );
			splits += int( split.size() );
			found += compare( *soft, "a split" );
		}
		if ( round % 4 == 1 )
		{
			cut( *soft, random );
			++cuts;
		}
		test.run( 1 );
		found += compare( *soft, "a step" );
	}
	EXPECT_GT( found, 300u );
	EXPECT_GT( test.world.softBodyCount(), 1 ); // fragments have separated
	EXPECT_GT( splits, GetParam() > 0 ? 20 : -1 );
}

INSTANTIATE_TEST_SUITE_P( Levels, NearPairsOf, testing::Values( 0, 1, 2 ) );

/// Without motion, pairs that were connected before a cut are searched again.
TEST_P( NearPairsOf, TheSidesOfACutAreFound )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const soft = test.addSoft( block( 16, 8, 4, kPairCell ), at( 0, 0, 0 ), stiff( 2e4f ), levels( GetParam() ) );
	soft->requestRefinement( btVector3( -1, -1, -1 ), btVector3( 1, 1, 1 ) );
	EXPECT_TRUE( soft->setSelfCollision( true ).ok() );
	test.run( 4 );
	EXPECT_EQ( compare( *soft, "nothing" ), 0u );
	soft->cutSweep( btVector3( 0, 0, -1 ), btVector3( 0, 0, 1 ), btVector3( 1, 0, -1 ), btVector3( 1, 0, 1 ) );
	test.run( 1 );
	EXPECT_EQ( test.world.softBodyCount(), 1 );
	EXPECT_GT( compare( *soft, "a cut" ), 20u );
}

/// Little motion requires few new searches.
TEST( NearPairs, AreSearchedAgainOnlyWhereNodesHaveMoved )
{
	TestWorld test;
	SoftBody* const soft = test.addSoft( block( 16, 8, 4, kPairCell ), at( 0, 0, 0 ), stiff( 2e4f ) );
	NearPairs pairs;
	pairs.of( *soft, 0.0 );
	const long long all = pairs.queryCount();
	EXPECT_GT( all, soft->nodeCount() / 2 );
	NodeState& nodes = soft->impl().body->nodes();
	for ( int i = 0; i < 5; ++i )
	{
		nodes.x.set( i, nodes.x.get( i ) + Vec3( 0.0f, kPairCell, 0.0f ) );
	}
	pairs.of( *soft, 0.0 );
	EXPECT_EQ( pairs.queryCount(), all + 5 );
	pairs.of( *soft, 0.0 );
	EXPECT_EQ( pairs.queryCount(), all + 5 );
}

/// Two changes of levels without a search in between: rows with the same nodes, whatever their indices, are not searched again.
TEST( NearPairs, AreSearchedAgainOnlyWhereNodesWereSplit )
{
	TestWorld test;
	SoftBody* const soft = test.addSoft( block( 48, 8, 4, kPairCell ), at( 0, 0, 0 ), stiff( 2e4f ), levels( 2 ) );
	const Levels& all = *soft->impl().body->levels();
	changeLevels( *soft, coarseNodes( *soft, anyNode ), {} );
	NearPairs pairs;
	pairs.of( *soft, 0.0 );
	const long long before = pairs.queryCount();
	std::set<std::uint32_t> reached;
	for ( int k = 0; k < 2; ++k )
	{
		const std::vector<std::uint32_t> coarse = coarseNodes( *soft, anyNode );
		ASSERT_FALSE( coarse.empty() );
		changeLevels( *soft, std::vector<std::uint32_t>( 1, coarse.front() ), {} );
		pairs.renumber( all.lastChange().keptAs );
		std::set<std::uint32_t> now;
		for ( const std::uint32_t node : reached )
		{
			now.insert( all.lastChange().keptAs[node] );
		}
		for ( std::uint32_t i = 0; i < std::uint32_t( soft->nodeCount() ); ++i )
		{
			if ( all.lastChange().keptAs[all.lastChange().source[i]] == kNoNode )
			{
				now.insert( all.matrix().member.begin() + all.matrix().start[i], all.matrix().member.begin() + all.matrix().start[i + 1] );
			}
		}
		reached = now;
	}
	pairs.of( *soft, 0.0 );
	EXPECT_GT( pairs.queryCount(), before );
	EXPECT_LE( pairs.queryCount() - before, (long long)( reached.size() ) );
	EXPECT_LT( reached.size(), std::size_t( soft->nodeCount() ) / 2 );
}

} // namespace
} // namespace pliant::test
