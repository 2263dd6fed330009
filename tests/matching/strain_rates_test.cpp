// The implicit step's operator compared with its definition, and its properties.

#include "matching/constants.h"
#include "matching/strain_rates_case.h"
#include "pliant/task_runner.h"
#include "support/kept_links.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace pliant {
namespace {
using test::RatesCase;
using test::RatesOperator;

/// A block whose upper half is slit: regions that are not full cubes.
Lattice slitLattice()
{
	Lattice lattice = makeBlockLattice( 6, 5, 4, 0.1f );
	test::keepLinks( lattice, [&]( std::uint32_t i, std::uint32_t j ) {
		const auto a = lattice.coordinate[i], b = lattice.coordinate[j];
		return ( a.x() <= 2 ) == ( b.x() <= 2 ) || std::max( a.y(), b.y() ) < 2;
	} );
	return lattice;
}

/// A line of cells: the rotation of its regions about their own axis is undetermined, and suppressed.
bool isLine( const RatesCase& c )
{
	return c.lattice.cellCount() == 5;
}

std::vector<RatesCase> cases()
{
	std::vector<RatesCase> all;
	all.push_back( { makeBlockLattice( 7, 6, 5, 0.1f ), 1, Summation::BoxSums } );
	all.push_back( { makeBlockLattice( 7, 6, 5, 0.1f ), 2, Summation::BoxSums } );
	all.push_back( { makeBlockLattice( 7, 6, 5, 0.1f ), 1, Summation::Table } );
	all.push_back( { slitLattice(), 1, Summation::Automatic } );
	all.push_back( { slitLattice(), 2, Summation::Automatic } );
	all.push_back( { makeBlockLattice( 5, 1, 1, 0.1f ), 1, Summation::Table } );
	RatesCase uneven{ makeBlockLattice( 6, 4, 4, 0.1f ), 1, Summation::Automatic };
	for ( int i = 0; i < uneven.lattice.cellCount(); ++i )
	{
		uneven.stiffness.push_back( i % 3 == 0 ? 0.25f : 1.0f );
	}
	all.push_back( std::move( uneven ) );
	return all;
}

double product( const std::vector<double>& a, const std::vector<double>& b )
{
	double sum = 0.0;
	for ( std::size_t k = 0; k < a.size(); ++k )
	{
		sum += a[k] * b[k];
	}
	return sum;
}

/// The definition, one region after the other, in double.
std::vector<double> byDefinition( const RatesCase& c, const NodeState& nodes, const std::vector<double>& v, double stiffness )
{
	const RegionSet regions = buildRegions( c.lattice, c.halfWidth );
	const std::size_t padded = std::size_t( nodes.padded );
	const auto speed = [&]( std::size_t i ) { return Vec3d( v[i], v[padded + i], v[2 * padded + i] ); };
	std::vector<double> to( v.size(), 0.0 );
	const auto add = [&]( std::size_t i, const Vec3d& value ) {
		for ( std::size_t k = 0; k < 3; ++k )
		{
			to[k * padded + i] += value[int( k )];
		}
	};
	for ( std::size_t i = 0; i < std::size_t( nodes.count ); ++i )
	{
		add( i, double( nodes.mass[i] ) * speed( i ) );
	}
	for ( std::size_t r = 0; r < std::size_t( nodes.count ); ++r )
	{
		double mass = 0.0;
		Vec3d centre = Vec3d::Zero(), mean = Vec3d::Zero(), spin = Vec3d::Zero();
		const auto each = [&]( auto&& what ) {
			for ( std::uint32_t k = regions.start[r]; k < regions.start[r + 1]; ++k )
			{
				const std::size_t i = regions.member[k];
				what( i, double( nodes.mass[i] ) / double( regions.size[i] ) );
			}
		};
		each( [&]( std::size_t i, double a ) {
			mass += a;
			centre += a * nodes.x.get( int( i ) ).cast<double>();
			mean += a * speed( i );
		} );
		centre /= mass;
		mean /= mass;
		Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
		each( [&]( std::size_t i, double a ) {
			const Vec3d arm = nodes.x.get( int( i ) ).cast<double>() - centre;
			spin += a * arm.cross( speed( i ) - mean );
			inertia += a * ( arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose() );
		} );
		const Vec3d turn = flooredInverse( inertia, 1e-9 ) * spin;
		const double fraction = c.stiffness.empty() ? 1.0 : double( c.stiffness[r] );
		each( [&]( std::size_t i, double a ) {
			const Vec3d arm = nodes.x.get( int( i ) ).cast<double>() - centre;
			add( i, stiffness * fraction * a * ( speed( i ) - mean - turn.cross( arm ) ) );
		} );
	}
	return to;
}

double differenceFromDefinition( const RatesCase& c, RatesOperator& resist )
{
	const std::vector<double> v = resist.random( 5 ), wanted = byDefinition( c, resist.nodes, v, 3.0 ), got = resist( v, 3.0f );
	double error = 0.0;
	for ( std::size_t k = 0; k < v.size(); ++k )
	{
		error += ( got[k] - wanted[k] ) * ( got[k] - wanted[k] );
	}
	return std::sqrt( error / product( wanted, wanted ) );
}

TEST( StrainRates, AgreeWithTheirDefinition )
{
	for ( const RatesCase& c : cases() )
	{
		// A line of cells: its rotation about its own axis is undetermined.
		const double tolerance = isLine( c ) ? 0.1 : 2e-5;
		RatesOperator resist( c );
		EXPECT_LT( differenceFromDefinition( c, resist ), tolerance ) << c.lattice.cellCount() << " w " << c.halfWidth;

		if ( isLine( c ) )
		{
			continue;
		}
		const Eigen::Quaternionf rotation = test::rotationBy( 1.3f );
		RatesOperator stiff( c, test::hardlyStrained( c.lattice, rotation, 11 ) );
		stiff.prepareStiff( rotation, kLeastFramedStiffness );
		EXPECT_LT( differenceFromDefinition( c, stiff ), tolerance ) << c.lattice.cellCount() << " w " << c.halfWidth << ", stiff";
	}
}

TEST( StrainRates, AreSymmetricAndNeverPush )
{
	for ( const RatesCase& c : cases() )
	{
		RatesOperator resist( c );
		for ( unsigned seed = 1; seed < 6; ++seed )
		{
			const std::vector<double> a = resist.random( seed ), b = resist.random( seed + 100 );
			const std::vector<double> aa = resist( a, 50.0f ), ab = resist( b, 50.0f );
			const double size = std::sqrt( product( aa, aa ) * product( b, b ) );
			EXPECT_LT( std::abs( product( a, ab ) - product( b, aa ) ), 1e-5 * size );
			std::vector<double> inertia = resist( a, 0.0f );
			EXPECT_GT( product( a, aa ), product( a, inertia ) * ( 1.0 - 1e-6 ) );
		}
	}
}

TEST( StrainRates, KnowWhoHasThinRegions )
{
	for ( const RatesCase& c : cases() )
	{
		EXPECT_EQ( RatesOperator( c ).rates.hasRaisedRegions(), isLine( c ) )
			<< c.lattice.cellCount() << " w " << c.halfWidth; // other bodies have no cost
	}
}

TEST( StrainRates, LeaveRigidMotionsAloneHoweverStiff )
{
	for ( const RatesCase& c : cases() )
	{
		RatesOperator resist( c );
		const std::vector<double> v = resist.rigid( Vec3d( 3, -2, 1 ), Vec3d( 4, 5, -6 ) ), mv = resist( v, 0.0f ),
								  av = resist( v, 3000.0f );
		const double size = std::sqrt( product( mv, mv ) );
		double error = 0.0;
		for ( std::size_t k = 0; k < v.size(); ++k )
		{
			error += ( av[k] - mv[k] ) * ( av[k] - mv[k] );
		}
		EXPECT_LT( std::sqrt( error ) / size, 2e-3 ); // 3000 times float's rounding
	}
}

TEST( StrainRates, MoveNoMomentum )
{
	for ( const RatesCase& c : cases() )
	{
		RatesOperator resist( c );
		const std::vector<double> v = resist.random( 9 ), to = resist( v, 100.0f );
		double leak = 0.0;
		for ( const Vec3d& axis : { Vec3d( 1, 0, 0 ), Vec3d( 0, 1, 0 ), Vec3d( 0, 0, 1 ) } )
		{
			const std::vector<double> shift = resist.rigid( axis, Vec3d::Zero() ), turn = resist.rigid( Vec3d::Zero(), axis );
			leak = std::max( leak, std::abs( product( shift, to ) - product( v, resist( shift, 0.0f ) ) ) );
			leak = std::max( leak, std::abs( product( turn, to ) - product( v, resist( turn, 0.0f ) ) ) );
		}
		EXPECT_LT( leak, 1e-4 * std::sqrt( product( to, to ) ) );
	}
}

TEST( StrainRates, GiveTheSameBitsOnEveryInstructionSetAndAnyThreadCount )
{
	for ( const RatesCase& c : cases() )
	{
		RatesOperator best( c );
		const std::vector<double> v = best.random( 3 ), wanted = best( v, 7.0f );
		for ( const KernelTarget target : { KernelTarget::Baseline, KernelTarget::Avx2, KernelTarget::Avx512 } )
		{
			if ( const Kernels* kernels = findKernels( target ) )
			{
				RatesOperator other( c, *kernels );
				EXPECT_EQ( other( v, 7.0f ), wanted ) << kernels->name;
			}
		}
	}
	const RatesCase large{ makeBlockLattice( 20, 20, 20, 0.1f ), 1, Summation::Automatic };
	RatesOperator resist( large );
	const std::vector<double> v = resist.random( 3 ), wanted = resist( v, 7.0f );
	const auto threads = createThreadPool( 3 );
	EXPECT_EQ( resist( v, 7.0f, threads.get() ), wanted );
}

// Lattices that fill their grid are summed row by row for each component, without records.
TEST( StrainRates, SumFlatRowsToTheBitsOfRecords )
{
	std::vector<RatesCase> boxes;
	for ( int halfWidth = 1; halfWidth <= 4; ++halfWidth )
	{
		boxes.push_back( { makeBlockLattice( 7, 6, 5, 0.1f ), halfWidth, Summation::BoxSums } );
		boxes.push_back( { makeBlockLattice( 9, 2, 3, 0.1f ), halfWidth, Summation::BoxSums } ); // less than a half-width along some axes
		boxes.push_back( { makeBlockLattice( 2, 3, 9, 0.1f ), halfWidth, Summation::BoxSums } );
		boxes.push_back( { makeBlockLattice( 16, 16, 1, 0.1f ), halfWidth, Summation::BoxSums } ); // no padding
	}
	boxes.push_back( { makeBlockLattice( 14, 13, 12, 0.1f ), 1, Summation::BoxSums } ); // several chunks
	for ( const RatesCase& c : boxes )
	{
		RatesOperator flat( c ), records( c );
		ASSERT_TRUE( flat.matcher->usesBoxSums() );
		records.rates.sumByRecords();
		records.rates.prepare( *records.matcher, records.nodes, nullptr );
		const std::vector<double> v = flat.random( 17 );
		EXPECT_EQ( flat( v, 5.0f ), records( v, 5.0f ) ) << c.lattice.extent.transpose() << " w " << c.halfWidth;
	}
}

/// The mean of the operator's three diagonal entries of node i, without its mass, at a stiffness of 1.
double diagonalOf( RatesOperator& resist, int i )
{
	const std::size_t padded = std::size_t( resist.nodes.padded );
	double sum = 0.0;
	for ( std::size_t k = 0; k < 3; ++k )
	{
		std::vector<double> unit( 3 * padded, 0.0 );
		unit[k * padded + std::size_t( i )] = 1.0;
		sum += resist( unit, 1.0f )[k * padded + std::size_t( i )] / double( resist.nodes.mass[i] );
	}
	return sum / 3.0 - 1.0;
}

// At rest it is exact, however few nodes a region has and however thin it is; the preconditioner is made from it. An earlier estimate,
// twice a node's fraction of the mass, was off by up to .017, of some .5.
TEST( StrainRates, NameTheirDiagonal )
{
	for ( const RatesCase& c : cases() )
	{
		RatesOperator atRest( c, test::restNodes( c.lattice ) ), resist( c );
		for ( int i = 0; i < resist.nodes.count && !isLine( c ); ++i )
		{
			EXPECT_NEAR( diagonalOf( atRest, i ), double( atRest.rates.diagonal()[std::size_t( i )] ), 1e-3 ) << i;
			EXPECT_NEAR( diagonalOf( resist, i ), double( resist.rates.diagonal()[std::size_t( i )] ), 0.05 ) << i;
		}
	}
}

} // namespace
} // namespace pliant
