#pragma once

// Checks of a build that several lattice tests share.

#include "test_meshes.h"

#include "lattice/build/build_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace pliant::test {

/// Builds, expects success and a valid lattice.
inline LatticeBuild built( const Mesh& mesh, const LatticeSettings& settings )
{
	Result<LatticeBuild> result = buildLattice( mesh.view(), settings );
	EXPECT_TRUE( result.ok() ) << result.status.sentence;
	const Status valid = validate( result.value.lattice );
	EXPECT_TRUE( !result.ok() || valid.ok() ) << valid.sentence;
	return std::move( result.value );
}

inline LatticeSettings cellsOf( float size )
{
	LatticeSettings settings;
	settings.cellSize = size;
	return settings;
}

inline bool areLinked( const Lattice& lattice, int i, int j )
{
	const auto row = lattice.linkTo.begin();
	return std::binary_search(
		row + lattice.linkStart[std::size_t( i )], row + lattice.linkStart[std::size_t( i ) + 1], std::uint32_t( j ) );
}

/// All bits except those of the lattice's position.
inline void expectEqual( const Lattice& a, const Lattice& b )
{
	EXPECT_EQ( a.cellSize, b.cellSize );
	EXPECT_EQ( a.extent, b.extent );
	EXPECT_EQ( a.coordinate, b.coordinate );
	EXPECT_EQ( a.fill, b.fill );
	EXPECT_EQ( a.restCentre, b.restCentre );
	EXPECT_EQ( a.isSurface, b.isSurface );
	EXPECT_EQ( a.linkStart, b.linkStart );
	EXPECT_EQ( a.linkTo, b.linkTo );
}

/// Signed volume of a closed mesh, m^3: 1/6 sum a . ( b x c ).
inline double volumeOf( const Mesh& mesh )
{
	double sum = 0.0;
	const auto at = [&]( std::size_t k ) {
		const float* p = &mesh.positions[3 * std::size_t( mesh.indices[k] )];
		return Vec3d( p[0], p[1], p[2] );
	};
	for ( std::size_t k = 0; k < mesh.indices.size(); k += 3 )
	{
		const Vec3d a = at( k );
		const Vec3d b = at( k + 1 );
		const Vec3d c = at( k + 2 );
		sum += a.x() * ( b.y() * c.z() - b.z() * c.y() ) + a.y() * ( b.z() * c.x() - b.x() * c.z() ) +
			a.z() * ( b.x() * c.y() - b.y() * c.x() );
	}
	return sum / 6.0;
}

} // namespace pliant::test
