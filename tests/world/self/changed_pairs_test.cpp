// All pairs of a body's nodes that touch are found, through motion, changes of levels and cuts.

#include "world/levels/adaptive_bodies.h"
#include "world/self/all_pairs.h"

#include "support/shapes.h"

#include <algorithm>
#include <random>

namespace pliant::test {
namespace {

constexpr float kPairCell = 0.05f; // m

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

class ChangedPairs : public testing::TestWithParam<int>
{};

TEST_P( ChangedPairs, OfACutAndSplitBodyAreFound )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const soft = test.addSoft( block( 16, 8, 4, kPairCell ), at( 0, 0, 0 ), stiff( 2e4f ), levels( GetParam() ) );
	EXPECT_TRUE( soft->setSelfCollision( true ).ok() );
	std::mt19937 random( 5 );
	int found = 0;
	int cuts = 0, splits = 0;
	for ( int round = 0; round < 80; ++round )
	{
		push( *soft, random );
		found += expectAllPairs( *soft, soft->impl().self->search );
		if ( GetParam() > 0 && round % 3 == 0 )
		{
			std::vector<std::uint32_t> split = coarseNodes( *soft, anyNode );
			split.resize( std::min( split.size(), std::size_t( 2 ) ) );
			changeLevels( *soft, split, {} );
			splits += int( split.size() );
			found += expectAllPairs( *soft, soft->impl().self->search );
		}
		if ( round % 4 == 1 )
		{
			cut( *soft, random );
			++cuts;
		}
		test.run( 1 );
		found += expectAllPairs( *soft, soft->impl().self->search );
	}
	EXPECT_GT( found, 300 );
	EXPECT_GT( test.world.softBodyCount(), 1 ); // fragments have separated
	EXPECT_GT( splits, GetParam() > 0 ? 20 : -1 );
}

INSTANTIATE_TEST_SUITE_P( Levels, ChangedPairs, testing::Values( 0, 1, 2 ) );

/// Pairs that were connected before a cut.
TEST_P( ChangedPairs, AtTheSidesOfACutAreFound )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const soft = test.addSoft( block( 16, 8, 4, kPairCell ), at( 0, 0, 0 ), stiff( 2e4f ), levels( GetParam() ) );
	soft->requestRefinement( btVector3( -1, -1, -1 ), btVector3( 1, 1, 1 ) );
	EXPECT_TRUE( soft->setSelfCollision( true ).ok() );
	test.run( 4 );
	EXPECT_EQ( expectAllPairs( *soft, soft->impl().self->search ), 0 );
	soft->cutSweep( btVector3( 0, 0, -1 ), btVector3( 0, 0, 1 ), btVector3( 1, 0, -1 ), btVector3( 1, 0, 1 ) );
	test.run( 1 );
	EXPECT_EQ( test.world.softBodyCount(), 1 );
	EXPECT_GT( expectAllPairs( *soft, soft->impl().self->search ), 20 );
}

} // namespace
} // namespace pliant::test
