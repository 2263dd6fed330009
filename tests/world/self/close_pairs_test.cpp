// Spatial hashing finds the same pairs as a test of all pairs.

#include "world/self/close_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace pliant {
namespace {

using Spheres = std::vector<ClosePairs::Sphere>;

/// Adjacency rows of connected spheres, in both directions.
struct Rows
{
	std::vector<std::uint32_t> start, to;

	ClosePairs::Held held() const { return { start, to }; }
	bool stands( std::uint32_t a, std::uint32_t b ) const
	{
		return std::find( to.begin() + start[a], to.begin() + start[a + 1], b ) != to.begin() + start[a + 1];
	}
	bool hold( std::uint32_t a, std::uint32_t b ) const
	{
		return stands( a, b ) || std::any_of( to.begin() + start[a], to.begin() + start[a + 1], [this, b]( std::uint32_t third ) {
			return stands( b, third );
		} );
	}
};

Rows someRows( std::mt19937& random, std::uint32_t numbers )
{
	std::vector<std::vector<std::uint32_t>> rows( numbers );
	for ( std::uint32_t k = 0; k < 2 * numbers; ++k )
	{
		const std::uint32_t a = random() % numbers, b = random() % numbers;
		rows[a].push_back( b );
		rows[b].push_back( a );
	}
	Rows flat;
	flat.start.push_back( 0 );
	for ( const std::vector<std::uint32_t>& row : rows )
	{
		flat.to.insert( flat.to.end(), row.begin(), row.end() );
		flat.start.push_back( std::uint32_t( flat.to.size() ) );
	}
	return flat;
}

std::vector<std::uint64_t> allClose( const Spheres& spheres, float slop, float margin )
{
	std::vector<std::uint64_t> pairs;
	for ( const ClosePairs::Sphere& a : spheres )
	{
		for ( const ClosePairs::Sphere& b : spheres )
		{
			const float reach = ( a.radius + b.radius ) * ( 1.0f + slop ) + margin;
			if ( a.number < b.number && ( a.position - b.position ).squaredNorm() <= reach * reach )
			{
				pairs.push_back( std::uint64_t( a.number ) << 32 | b.number );
			}
		}
	}
	std::sort( pairs.begin(), pairs.end() );
	return pairs;
}

/// Spheres of `sizes` radii, each half of the one before, in a box with the given edges.
Spheres someSpheres( std::mt19937& random, int count, int sizes, const Vec3& box )
{
	std::uniform_real_distribution<float> any( -0.5f, 0.5f );
	Spheres spheres;
	for ( int i = 0; i < count; ++i )
	{
		const Vec3 position( any( random ), any( random ), any( random ) );
		const float full = std::ldexp( 0.1f, -int( random() % unsigned( sizes ) ) );
		spheres.push_back( { position.cwiseProduct( box ), full * ( 1.0f - 0.4f * std::abs( any( random ) ) ), std::uint32_t( 3 * i ) } );
	}
	std::shuffle( spheres.begin(), spheres.end(), random );
	return spheres;
}

TEST( ClosePairs, EqualTheTestOfAllPairs )
{
	std::mt19937 random( 7 );
	ClosePairs finder;
	std::size_t found = 0;
	for ( int round = 0; round < 60; ++round )
	{
		const Vec3 box = round % 3 == 0 ? Vec3( 2.0f, 2.0f, 2.0f ) : round % 3 == 1 ? Vec3( 40.0f, 0.1f, 0.3f ) : Vec3( 3.0f, 0.0f, 3.0f );
		const Spheres spheres = someSpheres( random, 20 * ( round % 20 ), 1 + round % 4, box );
		const std::vector<std::uint64_t> expected = allClose( spheres, 0.04f, 0.03f );
		std::vector<std::uint64_t> pairs;
		finder.find( spheres, 0.04f, 0.03f, nullptr, pairs );
		std::sort( pairs.begin(), pairs.end() );
		ASSERT_EQ( pairs, expected ) << round;
		found += pairs.size();
	}
	EXPECT_GT( found, 5000u );
}

TEST( ClosePairs, ExcludeConnectedPairs )
{
	std::mt19937 random( 9 );
	ClosePairs finder;
	std::size_t found = 0, heldBack = 0;
	for ( int round = 0; round < 30; ++round )
	{
		const Spheres spheres = someSpheres( random, 300, 1 + round % 3, Vec3( 1.5f, 1.5f, 1.5f ) );
		const Rows rows = someRows( random, 900 ); // indices in groups of three
		std::vector<std::uint64_t> expected;
		for ( const std::uint64_t pair : allClose( spheres, 0.04f, 0.03f ) )
		{
			const bool isHeld = rows.hold( std::uint32_t( pair >> 32 ), std::uint32_t( pair ) );
			heldBack += isHeld ? 1 : 0;
			if ( !isHeld )
			{
				expected.push_back( pair );
			}
		}
		std::vector<std::uint64_t> pairs;
		const ClosePairs::Held held = rows.held();
		finder.find( spheres, 0.04f, 0.03f, &held, pairs );
		std::sort( pairs.begin(), pairs.end() );
		ASSERT_EQ( pairs, expected ) << round;
		found += pairs.size();
	}
	EXPECT_GT( found, 5000u );
	EXPECT_GT( heldBack, 100u );
}

TEST( ClosePairs, OfASubsetAreThePairsThatContainItsMembers )
{
	std::mt19937 random( 10 );
	ClosePairs finder;
	std::size_t found = 0;
	for ( int round = 0; round < 30; ++round )
	{
		const Spheres spheres = someSpheres( random, 10 * round, 1 + round % 3, Vec3( 1.0f, 1.0f, 1.0f ) );
		const Rows rows = someRows( random, 900 );
		const ClosePairs::Held held = rows.held();
		std::vector<std::uint8_t> isOf( 900, 0 );
		std::generate( isOf.begin(), isOf.end(), [&random] { return std::uint8_t( random() % 5 == 0 ); } );
		std::vector<std::uint64_t> all, expected, pairs;
		finder.find( spheres, 0.04f, 0.03f, &held, all );
		std::copy_if( all.begin(), all.end(), std::back_inserter( expected ),
			[&isOf]( std::uint64_t pair ) { return isOf[pair >> 32] != 0 || isOf[std::uint32_t( pair )] != 0; } );
		finder.findOf( spheres, isOf, 0.04f, 0.03f, &held, pairs );
		std::sort( expected.begin(), expected.end() );
		std::sort( pairs.begin(), pairs.end() );
		ASSERT_EQ( pairs, expected ) << round;
		found += pairs.size();
	}
	EXPECT_GT( found, 1000u );
}

/// One sphere has flown beyond the range of cell indices; the others' grid remains valid.
TEST( ClosePairs, AreFoundDespiteADistantSphere )
{
	std::mt19937 random( 8 );
	for ( const float radius : { 0.1f, 0.4f } ) // in the others' grid, and in a grid of its own
	{
		Spheres spheres = someSpheres( random, 200, 1, Vec3( 1.0f, 1.0f, 1.0f ) );
		spheres.push_back( { Vec3( 1e12f, -1e12f, 0.0f ), radius, 1000 } );
		const std::vector<std::uint64_t> expected = allClose( spheres, 0.0f, 0.0f );
		std::vector<std::uint64_t> pairs;
		ClosePairs().find( spheres, 0.0f, 0.0f, nullptr, pairs );
		std::sort( pairs.begin(), pairs.end() );
		EXPECT_EQ( pairs, expected );
		EXPECT_FALSE( pairs.empty() );
	}
}

} // namespace
} // namespace pliant
