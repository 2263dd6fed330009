#include "adapt/moments/fine_moments.h"

#include "adapt/constants.h"
#include "adapt/moments/quadratics.h"

namespace pliant {

namespace {

constexpr int kMonomials = 9;

/// A symmetric matrix over the monomials, or its lower triangle.
using Covariance = std::array<std::array<double, kMonomials>, kMonomials>;

/// Two doubles in a vector register, as all supported compilers provide them.
using D2 = double __attribute__( ( vector_size( 16 ) ) );
constexpr std::size_t kPairs = ( kMonomials + 1 ) / 2;

/// The monomials in pairs; the second element of the last pair is unused.
using Monomials = std::array<D2, kPairs>;
/// Rows in pairs: the first i / 2 + 1 of row i are used. Values above the diagonal are ignored.
using Squares = std::array<std::array<D2, kPairs>, kMonomials>;

Monomials monomials( const Vec3d& s )
{
	return { D2{ s.x(), s.y() }, D2{ s.z(), s.x() * s.x() }, D2{ s.y() * s.y(), s.z() * s.z() }, D2{ s.y() * s.z(), s.x() * s.z() },
		D2{ s.x() * s.y(), 0.0 } };
}

/// lower triangle += weight m m^T
void addSquare( const Monomials& m, double weight, Squares& sum )
{
#pragma GCC unroll 9
	for ( std::size_t i = 0; i < kMonomials; ++i )
	{
		const double scaled = weight * m[i / 2][i % 2];
#pragma GCC unroll 5
		for ( std::size_t j = 0; j <= i / 2; ++j )
		{
			sum[i][j] += scaled * m[j];
		}
	}
}

/// Packs the lower triangle, row by row.
template <class Entry>
void pack( Entry&& entry, std::array<float, 45>& packed )
{
	for ( std::size_t i = 0, k = 0; i < kMonomials; ++i )
	{
		for ( std::size_t j = 0; j <= i; ++j, ++k )
		{
			packed[k] = float( entry( i, j ) );
		}
	}
}

Covariance unpack( const std::array<float, 45>& packed )
{
	Covariance covariance;
	for ( std::size_t i = 0, k = 0; i < kMonomials; ++i )
	{
		for ( std::size_t j = 0; j <= i; ++j, ++k )
		{
			covariance[i][j] = covariance[j][i] = double( packed[k] );
		}
	}
	return covariance;
}

/// Moves the origin by `t`: ( s + t )_a ( s + t )_b = s_a s_b + t_a s_b + t_b s_a + constant, rows first, then columns.
void shift( const Vec3d& t, Covariance& c )
{
	for ( std::size_t k = 0; k < 6; ++k )
	{
		const std::size_t a = std::size_t( kQuadraticFirst[k] ), b = std::size_t( kQuadraticSecond[k] );
		for ( std::size_t j = 0; j < kMonomials; ++j )
		{
			c[3 + k][j] += t[int( a )] * c[b][j] + t[int( b )] * c[a][j];
		}
	}
	for ( std::size_t i = 0; i < kMonomials; ++i )
	{
		for ( std::size_t k = 0; k < 6; ++k )
		{
			const std::size_t a = std::size_t( kQuadraticFirst[k] ), b = std::size_t( kQuadraticSecond[k] );
			c[i][3 + k] += t[int( a )] * c[i][b] + t[int( b )] * c[i][a];
		}
	}
}

} // namespace

// About the region's own mean, with monomials about its owner's rest centre.
void measureFineRegion( const Lattice& lattice, const FineRegions& fine, std::uint32_t cell, FineMoments& moments )
{
	const Vec3d at = lattice.restCentre[cell].cast<double>();
	double mass = 0.0;
	Monomials mean{};
	Squares second{};
	for ( std::uint32_t k = fine.set.start[cell]; k < fine.set.start[cell + 1]; ++k )
	{
		const std::uint32_t c = fine.set.member[k];
		const double a = fine.mass[c] * kMassUnit;
		const Monomials m = monomials( ( lattice.restCentre[c].cast<double>() - at ) / double( lattice.cellSize ) );
		mass += a;
		for ( std::size_t j = 0; j < kPairs; ++j )
		{
			mean[j] += a * m[j];
		}
		addSquare( m, a, second );
	}
	addSquare( mean, -1.0 / mass, second );
	pack( [&second]( std::size_t i, std::size_t j ) { return second[i][j / 2][j % 2]; }, moments.covariance[cell] );
}

// Sums the children's stored moments: where few of them change, few are measured again.
void sumFineMoments( const Octree& octree, const Lattice& lattice, std::uint32_t node, FineMoments& moments )
{
	Covariance sum{};
	for ( std::uint32_t k = octree.childStart[node]; k < octree.childStart[node + 1]; ++k )
	{
		const std::uint32_t child = octree.child[k];
		Covariance part = unpack( moments.covariance[child] );
		shift( ( octree.restCentre[child] - octree.restCentre[node] ).cast<double>() / double( lattice.cellSize ), part );
		for ( std::size_t i = 0; i < kMonomials; ++i )
		{
			for ( std::size_t j = 0; j <= i; ++j )
			{
				sum[i][j] += part[i][j];
			}
		}
	}
	pack( [&sum]( std::size_t i, std::size_t j ) { return sum[i][j]; }, moments.covariance[node] );
}

FineMoments buildFineMoments( const Octree& octree, const Lattice& lattice, const FineRegions& fine )
{
	FineMoments moments;
	moments.covariance.resize( octree.parent.size() );
	for ( std::uint32_t n = 0; n < std::uint32_t( octree.nodeCount() ); ++n ) // children precede their parents
	{
		if ( n < octree.levelStart[1] )
		{
			measureFineRegion( lattice, fine, n, moments );
		}
		else
		{
			sumFineMoments( octree, lattice, n, moments );
		}
	}
	return moments;
}

} // namespace pliant
