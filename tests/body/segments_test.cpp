// Segments of large bodies: they divide a body, move with it, and resist as the operator of the implicit step does.

#include "body/implicit/segments.h"

#include "body/implicit_levels_case.h"
#include "matching/implicit/strain_rates.h"
#include "matching/step/lattice_matcher.h"
#include "support/block_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <vector>

namespace pliant {
namespace {

using namespace implicit_case;

constexpr float kPlateCell = 0.1f; // m
constexpr float kPlateStiffness = 1e4f;

/// A plate of 40 x 2 x 40 cells, or a part of one.
class Plate
{
public:
	explicit Plate( const Lattice& lattice = makeBlockLattice( 40, 2, 40, kPlateCell ) )
	{
		Result<std::unique_ptr<Body>> made = Body::create( std::make_shared<Lattice>( lattice ), material( 1.0f ), {} );
		EXPECT_TRUE( made.ok() ) << made.status.sentence;
		body = std::move( made.value );
		segments.layOut( body->lattice() );
		matcher = std::make_unique<LatticeMatcher>( body->lattice(), body->material() );
		rates.prepare( *matcher, body->nodes(), nullptr );
		segments.measure( body->nodes(), double( kPlateCell ), rates.diagonal().data(), double( kPlateStiffness ) );
	}
	/// m^T K m for six velocities a segment.
	double energy( const std::vector<double>& motions ) const
	{
		const auto of = [&motions]( int segment ) { return Eigen::Map<const Segments::Vector6>( motions.data() + 6 * segment ); };
		double sum = 0.0;
		for ( int k = 0; k < segments.count(); ++k )
		{
			sum += of( k ).dot( segments.own( k ) * of( k ) );
		}
		for ( const Segments::Pair& pair : segments.pairs() )
		{
			sum += 2.0 * of( pair.first ).dot( pair.coupling * of( pair.second ) );
		}
		return sum;
	}
	std::vector<float> velocities( const std::vector<double>& motions ) const
	{
		std::vector<float> v( 3 * std::size_t( body->nodes().padded ), 0.0f );
		segments.addMotions( body->nodes(), motions.data(), v.data() );
		return v;
	}

	std::unique_ptr<Body> body;
	std::unique_ptr<LatticeMatcher> matcher; // of `rates`
	Segments segments;
	StrainRates rates;
};

TEST( Segments, ContainEachCellOnce )
{
	const Plate plate;
	std::vector<int> cells( std::size_t( plate.segments.count() ), 0 );
	for ( int i = 0; i < plate.body->nodeCount(); ++i )
	{
		++cells[std::size_t( plate.segments.of( i ) )];
	}
	const auto [least, most] = std::minmax_element( cells.begin(), cells.end() );
	std::printf( "%d segments of %d to %d cells, %zu pairs\n", plate.segments.count(), *least, *most, plate.segments.pairs().size() );
	EXPECT_GT( *least, 0 );
	EXPECT_GE( plate.segments.count(), 64 );
	EXPECT_LE( plate.segments.pairs().size(), 400u );
}

TEST( Segments, RigidMotionsOfTheBodyMeetMassAlone )
{
	const Plate plate;
	const Eigen::Vector3d velocity( 0.3, -0.2, 0.5 ), turn( 0.4, 0.1, -0.6 );
	std::vector<double> motions;
	for ( int k = 0; k < plate.segments.count(); ++k )
	{
		const Eigen::Vector3d own = velocity + turn.cross( plate.segments.centre( k ) );
		motions.insert( motions.end(), own.data(), own.data() + 3 );
		motions.insert( motions.end(), turn.data(), turn.data() + 3 );
	}
	const std::vector<float> v = plate.velocities( motions );
	const NodeState& nodes = plate.body->nodes();
	double mass = 0.0;
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Eigen::Vector3d expected = velocity + turn.cross( nodes.x.get( i ).cast<double>() );
		for ( int k = 0; k < 3; ++k )
		{
			EXPECT_NEAR( double( v[std::size_t( k * nodes.padded + i )] ), expected[k], 1e-5 );
		}
		mass += double( nodes.mass[i] ) * expected.squaredNorm();
	}
	EXPECT_NEAR( plate.energy( motions ), mass, 0.05 * mass ); // their least moment of inertia counts too
}

TEST( Segments, SumWhatTheirMotionsMeet )
{
	const Plate plate;
	test::Seeded random( 3 );
	std::vector<double> motions( 6 * std::size_t( plate.segments.count() ) ), sums( motions.size() );
	std::vector<float> r( 3 * std::size_t( plate.body->nodes().padded ), 0.0f );
	std::generate( motions.begin(), motions.end(), [&random] { return double( random.uniform( -1, 1 ) ); } );
	for ( int k = 0; k < 3; ++k )
	{
		std::generate_n(
			r.begin() + k * plate.body->nodes().padded, plate.body->nodeCount(), [&random] { return random.uniform( -1, 1 ); } );
	}
	plate.segments.sum( plate.body->nodes(), r.data(), sums.data() );
	const std::vector<float> v = plate.velocities( motions );
	double power = 0.0, summed = 0.0; // ( P m ) . r = m . ( P^T r )
	for ( std::size_t k = 0; k < v.size(); ++k )
	{
		power += double( v[k] ) * double( r[k] );
	}
	for ( std::size_t k = 0; k < motions.size(); ++k )
	{
		summed += motions[k] * sums[k];
	}
	EXPECT_NEAR( summed, power, 1e-4 * double( r.size() ) );
}

TEST( Segments, ResistAsTheOperatorDoes )
{
	Plate plate;
	test::Seeded random( 5 );
	std::vector<double> motions( 6 * std::size_t( plate.segments.count() ) );
	for ( int kind = 0; kind < 6; ++kind ) // one component of all segments: along and across the plate, and turns
	{
		std::fill( motions.begin(), motions.end(), 0.0 );
		for ( std::size_t k = std::size_t( kind ); k < motions.size(); k += 6 )
		{
			motions[k] = double( random.uniform( -1, 1 ) );
		}
		const std::vector<float> v = plate.velocities( motions );
		const AlignedArray<float> given( v.begin(), v.end() );
		AlignedArray<float> resisted( v.size() );
		plate.rates.resist( given.data(), kPlateStiffness, resisted.data(), nullptr );
		double exact = 0.0;
		for ( std::size_t k = 0; k < v.size(); ++k )
		{
			exact += double( v[k] ) * double( resisted[k] );
		}
		const double ratio = plate.energy( motions ) / exact;
		std::printf( "component %d: %.2f of the operator's energy\n", kind, ratio );
		EXPECT_GT( ratio, 0.4 ) << kind;
		EXPECT_LT( ratio, 3.0 ) << kind;
	}
}

TEST( Segments, EndAtCracks )
{
	Lattice lattice = makeBlockLattice( 40, 2, 40, kPlateCell );
	const auto side = [&lattice]( std::uint32_t cell ) { return lattice.coordinate[cell][0] < 18; }; // within a cube
	std::vector<std::uint32_t> to, start( 1, 0 );
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		std::copy_if( lattice.linkTo.begin() + lattice.linkStart[i], lattice.linkTo.begin() + lattice.linkStart[i + 1],
			std::back_inserter( to ), [&]( std::uint32_t j ) { return side( i ) == side( j ); } );
		start.push_back( std::uint32_t( to.size() ) );
	}
	lattice.linkTo = to;
	lattice.linkStart = start;
	Segments segments;
	segments.layOut( lattice );
	std::vector<int> sideOf( std::size_t( segments.count() ), -1 );
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		int& own = sideOf[std::size_t( segments.of( int( i ) ) )];
		EXPECT_TRUE( own < 0 || own == int( side( i ) ) );
		own = int( side( i ) );
	}
	for ( const Segments::Pair& pair : segments.pairs() )
	{
		EXPECT_EQ( sideOf[std::size_t( pair.first )], sideOf[std::size_t( pair.second )] );
	}
}

} // namespace
} // namespace pliant
