#pragma once

// Lattices of arbitrary shape from a rule, for tests and experiments without a mesh.

#include "lattice/lattice.h"

#include <algorithm>
#include <functional>
#include <random>

namespace pliant::test {

using CellRule = std::function<bool( int x, int y, int z )>;
using LinkRule = std::function<bool( int a, int b )>; ///< called with a < b, once per link

/// Full cells where `isInside` is true; links between all 26-neighbours for which `isLinked` is true.
inline Lattice makeShapeLattice( const Eigen::Vector3i& extent, float cellSize, const CellRule& isInside, const LinkRule& isLinked = {} )
{
	Lattice lattice;
	lattice.cellSize = cellSize;
	lattice.extent = extent;
	std::vector<int> cellAt( std::size_t( extent.prod() ), -1 );
	const auto slot = [&extent]( int x, int y, int z ) { return std::size_t( ( z * extent.y() + y ) * extent.x() + x ); };
	Vec3d sum = Vec3d::Zero();
	for ( int z = 0; z < extent.z(); ++z )
	{
		for ( int y = 0; y < extent.y(); ++y )
		{
			for ( int x = 0; x < extent.x(); ++x )
			{
				if ( isInside( x, y, z ) )
				{
					cellAt[slot( x, y, z )] = int( lattice.coordinate.size() );
					lattice.coordinate.push_back(
						Eigen::Matrix<std::int16_t, 3, 1>( std::int16_t( x ), std::int16_t( y ), std::int16_t( z ) ) );
					sum += Vec3d( x + 0.5, y + 0.5, z + 0.5 );
				}
			}
		}
	}
	const std::size_t count = lattice.coordinate.size();
	lattice.massCentre = sum / double( count ) * double( cellSize );
	lattice.fill.assign( count, 1.0f );
	std::vector<std::vector<std::uint32_t>> links( count );
	for ( std::size_t i = 0; i < count; ++i )
	{
		const Eigen::Vector3i c = lattice.coordinate[i].cast<int>();
		lattice.restCentre.push_back(
			( ( c.cast<double>() + Vec3d::Constant( 0.5 ) ) * double( cellSize ) - lattice.massCentre ).cast<float>() );
		for ( int k = 14; k < 27; ++k ) // the neighbours with a higher index
		{
			const Eigen::Vector3i o = c + Eigen::Vector3i( k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1 );
			if ( ( o.array() < 0 ).any() || ( o.array() >= extent.array() ).any() )
			{
				continue;
			}
			const int j = cellAt[slot( o.x(), o.y(), o.z() )];
			if ( j >= 0 && ( !isLinked || isLinked( int( i ), j ) ) )
			{
				links[i].push_back( std::uint32_t( j ) );
				links[std::size_t( j )].push_back( std::uint32_t( i ) );
			}
		}
	}
	lattice.linkStart.push_back( 0 );
	for ( auto& list : links )
	{
		std::sort( list.begin(), list.end() );
		lattice.isSurface.push_back( list.size() < 26 );
		lattice.linkTo.insert( lattice.linkTo.end(), list.begin(), list.end() );
		lattice.linkStart.push_back( std::uint32_t( lattice.linkTo.size() ) );
	}
	return lattice;
}

/// Metaballs: cells where the sum of falloffs exceeds one half. `cells` along the longest edge; the same seed gives the same solid.
inline Lattice makeBlobLattice( int cells, float cellSize, unsigned seed, int balls = 6, const LinkRule& isLinked = {} )
{
	std::mt19937 random( seed );
	const auto fraction = [&random] { return double( random() ) / 4294967296.0; };
	std::vector<Vec3d> centre;
	for ( int k = 0; k < balls; ++k )
	{
		centre.emplace_back( 0.27 + 0.46 * fraction(), 0.27 + 0.46 * fraction(), 0.27 + 0.46 * fraction() );
	}
	const CellRule rule = [&centre, cells]( int x, int y, int z ) {
		const Vec3d p = Vec3d( x + 0.5, y + 0.5, z + 0.5 ) / cells;
		double field = 0.0;
		for ( const Vec3d& c : centre )
		{
			const double s = 1.0 - ( p - c ).squaredNorm() / ( 0.34 * 0.34 );
			field += s > 0.0 ? s * s * s : 0.0;
		}
		return field > 0.5;
	};
	return makeShapeLattice( Eigen::Vector3i::Constant( cells ), cellSize, rule, isLinked );
}

} // namespace pliant::test
