// Spatial hashing finds the pairs that asking all of them finds.

#include "world/close_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace pliant {
namespace {

using Spheres = std::vector<ClosePairs::Sphere>;

std::vector<std::uint64_t> allClose( const Spheres& spheres, float slop, float margin )
{
	std::vector<std::uint64_t> pairs;
	for ( const ClosePairs::Sphere& a : spheres )
	{
		for ( const ClosePairs::Sphere& b : spheres )
		{
			const float reach = ( a.radius + b.radius ) * ( 1.0f + slop ) + margin;
			if ( a.number < b.number && ( a.place - b.place ).squaredNorm() <= reach * reach )
			{
				pairs.push_back( std::uint64_t( a.number ) << 32 | b.number );
			}
		}
	}
	std::sort( pairs.begin(), pairs.end() );
	return pairs;
}

/// `sizes` of spheres, each half of the one before, in a box of those edges.
Spheres someSpheres( std::mt19937& random, int count, int sizes, const Vec3& box )
{
	std::uniform_real_distribution<float> any( -0.5f, 0.5f );
	Spheres spheres;
	for ( int i = 0; i < count; ++i )
	{
		const Vec3 place( any( random ), any( random ), any( random ) );
		const float full = std::ldexp( 0.1f, -int( random() % unsigned( sizes ) ) );
		spheres.push_back( { place.cwiseProduct( box ), full * ( 1.0f - 0.4f * std::abs( any( random ) ) ), std::uint32_t( 3 * i ) } );
	}
	std::shuffle( spheres.begin(), spheres.end(), random );
	return spheres;
}

TEST( ClosePairs, AreThoseOfAskingAll )
{
	std::mt19937 random( 7 );
	ClosePairs finder;
	std::size_t found = 0;
	for ( int round = 0; round < 60; ++round )
	{
		const Vec3 box = round % 3 == 0 ? Vec3( 2.0f, 2.0f, 2.0f ) : round % 3 == 1 ? Vec3( 40.0f, 0.1f, 0.3f ) : Vec3( 3.0f, 0.0f, 3.0f );
		Spheres spheres = someSpheres( random, 20 * ( round % 20 ), 1 + round % 4, box );
		const std::vector<std::uint64_t> expected = allClose( spheres, 0.04f, 0.03f );
		std::vector<std::uint64_t> pairs;
		finder.find( spheres, 0.04f, 0.03f, pairs );
		std::sort( pairs.begin(), pairs.end() );
		ASSERT_EQ( pairs, expected ) << round;
		found += pairs.size();
	}
	EXPECT_GT( found, 5000u );
}

/// One has flown off farther than there are numbers for cells: the others' grid still holds.
TEST( ClosePairs, AreFoundBesideOneThatHasFlownOff )
{
	std::mt19937 random( 8 );
	for ( const float radius : { 0.1f, 0.4f } ) // in the others' grid, and in its own
	{
		Spheres spheres = someSpheres( random, 200, 1, Vec3( 1.0f, 1.0f, 1.0f ) );
		spheres.push_back( { Vec3( 1e12f, -1e12f, 0.0f ), radius, 1000 } );
		const std::vector<std::uint64_t> expected = allClose( spheres, 0.0f, 0.0f );
		std::vector<std::uint64_t> pairs;
		ClosePairs().find( spheres, 0.0f, 0.0f, pairs );
		std::sort( pairs.begin(), pairs.end() );
		EXPECT_EQ( pairs, expected );
		EXPECT_FALSE( pairs.empty() );
	}
}

} // namespace
} // namespace pliant
