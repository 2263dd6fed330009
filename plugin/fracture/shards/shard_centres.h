#pragma once

// Where shards lie in the rest shape: the cells of a Voronoi diagram in a space that is compressed along the grain and gently bent, so that
// shards are longer along the grain and their borders curved. Fracture::shardSize.

#include "lattice/lattice.h"

#include <cstdint>
#include <vector>

namespace pliant {

class Archive;

/// Returns a cell's centre of mass in mesh coordinates, m.
inline Vec3d restOf( const Lattice& lattice, std::size_t cell )
{
	return lattice.massCentre + lattice.restCentre[cell].cast<double>();
}

/// The space in which the nearest centre is sought. Positions are in the mesh's coordinates.
class ShardSpace
{
public:
	ShardSpace() = default;
	/// `grain`: unit vector or zero. `length`: of a shard along it over its width. `bend`: amplitude of the bending and wavelength, m.
	ShardSpace( const Vec3d& grain, double length, double bend, double wavelength, unsigned seed );

	Vec3d map( const Vec3d& at ) const;
	/// The gradient of map( at ) . vector.
	Vec3d pulledBack( const Vec3d& at, const Vec3d& vector ) const;

	void archive( Archive& archive );

private:
	Eigen::Matrix3d m_metric = Eigen::Matrix3d::Identity();
	Eigen::Matrix3d m_wave = Eigen::Matrix3d::Zero(); ///< rows: wave vectors, rad/m
	Vec3d m_phase = Vec3d::Zero();
	double m_bend = 0.0;
};

/// Centres of shards, and a grid of bins to find the nearest.
class ShardCentreSet
{
public:
	static constexpr std::uint32_t kNone = 0xffffffffu;

	/// `size`: edge of a bin, about the distance of centres, m. Centres are in the mesh's coordinates.
	ShardCentreSet( const ShardSpace& space, double size, const std::vector<Vec3d>& centres );
	/// The same for centres at random cells of a lattice, none nearer to another than `size` in the space; shifted off the lattice.
	static ShardCentreSet scattered( const Lattice& lattice, const ShardSpace& space, double size, unsigned seed );
	/// Centres on rings about an axis, larger further away.
	static ShardCentreSet rings(
		const Lattice& lattice, const ShardSpace& space, double size, const Vec3d& point, const Vec3d& axis, unsigned seed );

	std::size_t count() const { return m_centre.size(); }
	/// Index of the centre nearest to a position; the lowest of equally near ones. kNone where there are none.
	std::uint32_t nearest( const Vec3d& at ) const;
	/// The border of two shards between two positions that are nearest to their centres: returns the fraction of the way from a to b, and
	/// the border's unit normal towards b.
	double borderBetween( const Vec3d& a, std::uint32_t centreA, const Vec3d& b, std::uint32_t centreB, Vec3d& normal ) const;

	/// Empty, to be read into.
	ShardCentreSet() : m_size( 1.0 ) {}
	void archive( Archive& archive );

private:
	explicit ShardCentreSet( const ShardSpace& space, double size ) : m_space( space ), m_size( size ) {}
	void openGrid( const Vec3d& low, const Vec3d& high );
	void add( const Vec3d& mapped );
	Eigen::Vector3i binOf( const Vec3d& mapped ) const;
	std::uint32_t nearestMapped( const Vec3d& mapped, double& square ) const;

	ShardSpace m_space;
	double m_size;               ///< of a bin, m
	std::vector<Vec3d> m_centre; ///< in the space
	Vec3d m_low = Vec3d::Zero(); ///< corner of the grid
	Eigen::Vector3i m_bins = Eigen::Vector3i::Zero();
	std::vector<std::uint32_t> m_first, m_next; ///< by bin; by centre
};

/// The direction in which the cells spread least, unit vector.
Vec3d thinnestDirection( const Lattice& lattice );

} // namespace pliant
