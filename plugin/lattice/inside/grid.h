#pragma once

// Lattice positions, their samples, and the integer coordinates of both.

#include "lattice/lattice.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pliant {

/// n cells of edge d along each axis, `samples` samples along each edge of a cell. A cell's edge is 2^bits quanta; quantum 0 is the low
/// corner. Samples lie at odd multiples of 1 / (2 samples) of an edge.
struct Grid
{
	double cellSize = 0.0;
	Vec3d corner = Vec3d::Zero();
	Eigen::Vector3i extent = Eigen::Vector3i::Ones();
	int samples = 1;
	int bits = 0;
	std::array<std::int32_t, 8> offset{}; ///< of the samples in a cell, quanta

	std::int32_t sampleAt( int index ) const { return ( ( index / samples ) << bits ) + offset[std::size_t( index % samples )]; }
	int sampleCount( int axis ) const { return extent[axis] * samples; }

	/// Number of samples at or below a coordinate, quanta, in [0, sampleCount]: the index of the first sample above it.
	int firstAbove( int axis, double coordinate ) const;
	/// The same for a whole number of quanta, as corners have: called three times per triangle of a mesh.
	int firstAbove( int axis, std::int64_t coordinate ) const
	{
		const std::int64_t cell = coordinate >> bits;
		if ( coordinate < 0 || cell >= extent[axis] )
		{
			return coordinate < 0 ? 0 : sampleCount( axis );
		}
		const std::int64_t within = coordinate - ( cell << bits );
		int k = 0;
		while ( k < samples && offset[std::size_t( k )] <= within )
		{
			++k;
		}
		return int( cell ) * samples + k;
	}

	double quantum() const { return cellSize / double( std::int64_t( 1 ) << bits ); }
	double samplesPerCell() const { return double( samples ) * samples * samples; }

	std::uint64_t positions() const { return std::uint64_t( extent.x() ) * std::uint64_t( extent.y() ) * std::uint64_t( extent.z() ); }
	std::uint64_t key( int x, int y, int z ) const
	{
		return ( std::uint64_t( z ) * std::uint64_t( extent.y() ) + std::uint64_t( y ) ) * std::uint64_t( extent.x() ) + std::uint64_t( x );
	}
	Eigen::Vector3i at( std::uint64_t key ) const
	{
		const std::uint64_t nx = std::uint64_t( extent.x() );
		const std::uint64_t ny = std::uint64_t( extent.y() );
		return { int( key % nx ), int( key / nx % ny ), int( key / nx / ny ) };
	}
	bool holds( const Eigen::Vector3i& p ) const { return p.minCoeff() >= 0 && ( extent - p ).minCoeff() >= 1; }
};

/// Cells of edge d centred on the box. False when more than kMaxExtent cells are needed along an axis.
bool makeGrid( const Vec3d& low, const Vec3d& high, double cellSize, int samples, Grid& out );

/// Maps a lattice position to an entry's index, by a table where the grid is small and by search where it is sparse.
class PositionIndex
{
public:
	static constexpr std::int32_t kNone = -1;

	/// Entries are numbered in the order of `keys`, ascending; of equal keys the first counts.
	PositionIndex( const Grid& grid, const std::vector<std::uint64_t>& keys );

	std::int32_t find( std::uint64_t key ) const;

private:
	const std::vector<std::uint64_t>& m_keys;
	std::vector<std::int32_t> m_table;
};

} // namespace pliant
