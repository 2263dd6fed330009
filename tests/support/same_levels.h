#pragma once

// Compares the data of bodies with levels array by array.

#include "matching/regions/level_tables.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace pliant::test {

inline void expectSameTree( const Octree& got, const Octree& wanted )
{
	EXPECT_EQ( got.levelStart, wanted.levelStart );
	EXPECT_EQ( got.parent, wanted.parent );
	EXPECT_EQ( got.childStart, wanted.childStart );
	EXPECT_EQ( got.child, wanted.child );
	EXPECT_EQ( got.cells, wanted.cells );
	EXPECT_EQ( got.cellStart, wanted.cellStart );
	EXPECT_EQ( got.cellCount, wanted.cellCount );
	EXPECT_EQ( got.coordinate, wanted.coordinate );
	EXPECT_EQ( got.isSurface, wanted.isSurface );
	EXPECT_EQ( got.mass, wanted.mass );
}

/// `allowed`: relative error of values above 1, absolute error of others; 0: bit-identical.
template <class Array>
void expectNear( const Array& got, const Array& wanted, float allowed, const char* what )
{
	ASSERT_EQ( got.size(), wanted.size() ) << what;
	float worst = 0.0f;
	for ( std::size_t i = 0; i < got.size(); ++i )
	{
		worst = std::max( worst, std::abs( got[i] - wanted[i] ) / std::max( 1.0f, std::abs( wanted[i] ) ) );
	}
	EXPECT_LE( worst, allowed ) << what;
}

inline void expectNearBase( const LevelBase& got, const LevelBase& wanted, float allowed )
{
	expectSameTree( got.octree, wanted.octree );
	EXPECT_EQ( got.fine.set.start, wanted.fine.set.start );
	EXPECT_EQ( got.fine.set.member, wanted.fine.set.member );
	EXPECT_EQ( got.fine.set.size, wanted.fine.set.size );
	EXPECT_EQ( got.fine.mass, wanted.fine.mass );
	ASSERT_EQ( got.moments.covariance.size(), wanted.moments.covariance.size() );
	for ( std::size_t n = 0; n < got.moments.covariance.size(); ++n )
	{
		expectNear( got.moments.covariance[n], wanted.moments.covariance[n], allowed, "covariance" );
		expectNear( got.octree.spread[n], wanted.octree.spread[n], allowed, "spread" );
		EXPECT_LE( ( got.octree.restCentre[n] - wanted.octree.restCentre[n] ).norm(), allowed );
	}
}

inline void expectNearTables( const RegionTables& got, const RegionTables& wanted, float allowed )
{
	EXPECT_EQ( got.matrix->start, wanted.matrix->start );
	EXPECT_EQ( got.matrix->member, wanted.matrix->member );
	EXPECT_EQ( got.matrix->mass, wanted.matrix->mass );
	EXPECT_EQ( got.matrix->fraction, wanted.matrix->fraction );
	EXPECT_EQ( got.matrix->unit, wanted.matrix->unit );
	expectNear( got.pull, wanted.pull, allowed, "pull" );
	expectNear( got.beta, wanted.beta, allowed, "beta" );
	expectNear( got.eta, wanted.eta, allowed, "eta" );
	expectNear( got.moments.nodeWeight, wanted.moments.nodeWeight, allowed, "nodeWeight" );
	expectNear( got.moments.inverseCover, wanted.moments.inverseCover, allowed, "inverseCover" );
	expectNear( got.moments.inverseMass, wanted.moments.inverseMass, allowed, "inverseMass" );
	expectNear( got.moments.regionWeight, wanted.moments.regionWeight, allowed, "regionWeight" );
	for ( std::size_t k = 0; k < 9; ++k )
	{
		expectNear( got.blend[k], wanted.blend[k], allowed, "blend" );
	}
	for ( std::size_t k = 0; k < 6; ++k )
	{
		expectNear( got.moments.moment[k], wanted.moments.moment[k], allowed, "moment" );
		expectNear( got.moments.inverseMoment[k], wanted.moments.inverseMoment[k], allowed, "inverseMoment" );
		expectNear( got.outOfPlane[k], wanted.outOfPlane[k], allowed, "outOfPlane" );
		expectNear( got.moments.centre[k / 2], wanted.moments.centre[k / 2], allowed, "centre" );
	}
}

} // namespace pliant::test
