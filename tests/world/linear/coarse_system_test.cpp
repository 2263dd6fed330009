// The coarse system gives the solution of the equivalent dense matrix, also when it is summed repeatedly.

#include "world/linear/coarse_system.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace pliant {
namespace {

/// Bodies in a row, alternately of 12 and 6 unknowns, each coupled with the next one and with the one `far` further on.
void solveRow( CoarseSystem& system, int bodies, int far )
{
	std::mt19937 random( 7 );
	const auto draw = [&random] { return double( random() % 2001 ) / 1000.0 - 1.0; };
	std::vector<int> sizes;
	std::vector<CoarseSystem::Pair> pairs;
	for ( int k = 0; k < bodies; ++k )
	{
		sizes.push_back( k % 2 == 0 ? 12 : 6 );
		for ( const int other : { k - 1, k - far } )
		{
			for ( int times = 0; times < 2 && other >= 0; ++times )
			{
				pairs.emplace_back( k, other );
			}
		}
	}
	system.layOut( sizes, pairs );
	EXPECT_EQ( bodies > 2 && system.has( 2, 0 ), bodies > 2 && far == 2 );
	for ( int sum = 0; sum < 2; ++sum )
	{
		system.clear();
		Eigen::MatrixXd whole = Eigen::MatrixXd::Zero( system.size(), system.size() );
		const auto add = [&]( int a, int b, const Eigen::MatrixXd& piece ) {
			system.block( a, b ) += piece;
			whole.block( system.offset( a ), system.offset( b ), sizes[std::size_t( a )], sizes[std::size_t( b )] ) += piece;
			if ( a != b )
			{
				whole.block(
					system.offset( b ), system.offset( a ), sizes[std::size_t( b )], sizes[std::size_t( a )] ) += piece.transpose();
			}
		};
		for ( int k = 0; k < bodies; ++k )
		{
			const int size = sizes[std::size_t( k )];
			add( k, k, Eigen::MatrixXd( 40.0 * Eigen::MatrixXd::Identity( size, size ) ) );
			for ( const int other : { k - 1, k - far } )
			{
				if ( other >= 0 )
				{
					add( k, other, Eigen::MatrixXd::NullaryExpr( size, sizes[std::size_t( other )], draw ) );
				}
			}
		}
		ASSERT_TRUE( system.factor() );
		const Eigen::VectorXd r = Eigen::VectorXd::NullaryExpr( system.size(), draw );
		Eigen::VectorXd x;
		system.solve( r, x );
		EXPECT_LT( ( whole * x - r ).norm(), 1e-12 * r.norm() ) << bodies;
	}
}

TEST( ImplicitCoarseSystem, EqualsTheDenseSolution )
{
	for ( const int bodies : { 1, 2, 4, 11, 40 } )
	{
		CoarseSystem system;
		solveRow( system, bodies, 3 );
	}
}

/// As in a heap: mostly the couplings are those of the step before, and now and then they change.
TEST( ImplicitCoarseSystem, IsLaidOutAgainWhenTheCouplingChanges )
{
	CoarseSystem system;
	for ( const int far : { 3, 3, 2, 5, 5, 3 } )
	{
		solveRow( system, 11, far );
	}
	solveRow( system, 12, 3 );
	solveRow( system, 11, 3 );
}

TEST( ImplicitCoarseSystem, IndefiniteMatricesYieldZero )
{
	for ( const int bodies : { 2, 20 } )
	{
		CoarseSystem system;
		std::vector<CoarseSystem::Pair> pairs;
		system.layOut( std::vector<int>( std::size_t( bodies ), 12 ), pairs );
		for ( int k = 0; k < bodies; ++k )
		{
			system.block( k, k ).setIdentity();
		}
		for ( const double wrong : { -1.0, 0.0, std::nan( "" ) } )
		{
			system.block( 1, 1 )( 3, 3 ) = wrong;
			EXPECT_FALSE( system.factor() ) << wrong;
			Eigen::VectorXd x;
			system.solve( Eigen::VectorXd::Ones( system.size() ), x );
			EXPECT_EQ( x.norm(), 0.0 );
		}
	}
}

} // namespace
} // namespace pliant
