#pragma once

// One event of ShardCracks: measures the borders between shards and the strain energy of shards and crumbs, and runs cracks along them.

#include "fracture/face_stretch.h"
#include "fracture/link_limits.h"
#include "lattice/lattice.h"

#include <cstdint>
#include <vector>

namespace pliant {

/// Settings of BreakRule::Shards for one material.
struct ShardLaw
{
	float breakStrain = 0.0f;
	double youngsModulus = 0.0; ///< Pa
	double toughness = 0.0;     ///< J/m^2
	double size = 0.0;          ///< of shards, m
};

/// A cell whose material is stretched beyond its strength.
struct ShardOverload
{
	std::uint32_t cell;
	float excess; ///< strain over the break strain
	Vec3d normal; ///< of the largest stretch, at rest
};

class ShardEvent
{
public:
	/// `shards`: of each cell. `positions`: of each cell, relative to any origin. `faces`: updated for the same positions. All arguments
	/// must outlive the event.
	ShardEvent( const Lattice& lattice, const LinkLimits& limits, const std::vector<std::uint32_t>& shards,
		const std::vector<Vec3d>& positions, const ShardLaw& law, FaceStretch& faces );

	/// Starts a crack at the border of the cell's shard that lies best across the pull, and runs it; nothing where none opens, or where a
	/// crack of this event unloads the material.
	void runFrom( const ShardOverload& overload );
	/// Opens borders all around an impact, the nearest first and those that lead away from it twice as far as those around it, as long as
	/// the energy of the whole body lasts.
	void runAround( std::uint32_t impact );
	/// Opens small borders without area, over edges and corners of cells alone, whose shards other borders no longer hold together there:
	/// call it when all cracks have run. `isCrumb`: by cell, 1 for those that come off; empty where none do.
	void openCorners( const std::vector<std::uint8_t>& isCrumb );
	/// Returns, by cell, 1 for those that come off as crumbs: where the energy left suffices for a crumb's whole surface, the densest
	/// first, up to `mass` of cells' fill, which is reduced.
	std::vector<std::uint8_t> crumble(
		const std::vector<std::uint32_t>& crumb, const std::vector<ShardOverload>& overloads, double& mass ) const;
	/// Whether the border that the k-th link of the limits crosses is open; false for links within a shard.
	bool isOpen( std::size_t k ) const { return m_borderOfLink[k] != kNone && m_borders[m_borderOfLink[k]].isBroken; }

private:
	static constexpr std::uint32_t kNone = 0xffffffffu;

	struct Border
	{
		std::uint32_t shard[2];                                ///< local numbers, ascending
		Eigen::Matrix3d now = Eigen::Matrix3d::Zero();         ///< sum p q^T over its links
		Eigen::Matrix3d rest = Eigen::Matrix3d::Zero();        ///< sum q q^T
		Eigen::Matrix3d deformation = Eigen::Matrix3d::Zero(); ///< F
		/// What bending along each normal of a thin part adds to the stretch at its faces.
		Eigen::Matrix3d bending[2] = { Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero() };
		std::vector<const ThinCell*> thin; ///< ends of its links in thin parts, until `bending` is measured
		Vec3d across = Vec3d::Zero();      ///< its area times its normal, towards the second shard, m^2
		Vec3d middle = Vec3d::Zero();      ///< at rest
		double toughness = 0.0;            ///< factor on the break strain, the mean over links that can break
		int links = 0;                     ///< that can break
		bool hasArea = false;              ///< some of its links cross a face of their cells
		bool keepsArea = false;            ///< some of these neither break in this event nor leave with a crumb
		bool isBroken = false;
		unsigned visit = 0; ///< the crack that last looked at it
	};
	struct Crack
	{
		Vec3d point, normal; ///< at rest
		Vec3d low, high;     ///< bounding box of its borders' middles
	};

	Vec3d rest( std::uint32_t cell ) const { return m_lattice.restCentre[cell].cast<double>(); }
	double costOf( const Border& border ) const;
	void numberShards( const std::vector<std::uint32_t>& number );
	/// E e^2 / 2 a volume, from the strains of each cell's links (kLinkEnergyFactor).
	void measureEnergy();
	std::uint32_t borderBetween( std::uint32_t a, std::uint32_t b );
	void findBorders();
	void measureBending( Border& border );
	void addLink( Border& border, std::uint32_t a, std::uint32_t b, double toughness );
	/// Stretch across a plane, in break strains of the border.
	double pullOn( Border& border, const Vec3d& normal );
	/// Whether the border opens in a crack across `normal`.
	bool opens( Border& border, const Vec3d& normal );
	void open( Border& border );
	/// A crack unloads the material beside it over a distance of its length, less where the load is many times what it takes.
	bool isShielded( const ShardOverload& overload ) const;
	/// The border of the cell's shard that lies best across the pull; kNone where none opens.
	std::uint32_t startOf( const ShardOverload& overload );
	bool isCrossed( const Border& border, const Crack& crack ) const;
	/// Calls visit( shard ) for those that a border with area joins to a shard, until it returns true; returns whether it did.
	/// `beforeEvent`: with the area that borders had when the event began.
	template <class Visit>
	bool anyNeighbour( std::uint32_t shard, bool beforeEvent, Visit&& visit ) const;
	/// Whether at most three borders with area lead from one side of a border to the other.
	bool areJoined( const Border& border, bool beforeEvent );
	void findKeptAreas( const std::vector<std::uint8_t>& isCrumb );
	/// The largest number of links of a border of either shard that has lost its area.
	int mostLostLinks( const Border& border ) const;

	const Lattice& m_lattice;
	const LinkLimits& m_limits;
	const std::vector<Vec3d>& m_at;
	const ShardLaw& m_law;
	FaceStretch& m_faces;
	std::vector<std::uint32_t> m_shard;   ///< by cell: local number
	std::vector<double> m_energy, m_left; ///< by shard, J: all, and what cracks have not used
	std::vector<Vec3d> m_centre;          ///< by shard, at rest
	std::vector<double> m_cellEnergy;     ///< J
	std::vector<Border> m_borders;
	std::vector<std::vector<std::uint32_t>> m_bordersOf; ///< by shard
	std::vector<std::uint32_t> m_borderOfLink;           ///< by link of the limits
	std::vector<Crack> m_cracks;
	std::vector<std::uint8_t> m_isNear; ///< by shard, while areJoined searches; else 0
};

} // namespace pliant
