#pragma once

// Which lattice positions hold material, and for those the surface passes through, which of their samples do.
// Ohta et al. 2009, "Preprocessing".

#include "lattice/inside/grid.h"
#include "lattice/inside/rows.h"

#include <cstdint>
#include <vector>

namespace pliant {

/// What is known of one sample of a cut cell.
enum SampleFlag : std::uint8_t
{
	kInside = 1,
	kBlockedX = 2, ///< both this sample and the next along x are inside, but a gap lies between them
	kBlockedY = 4,
	kBlockedZ = 8,
	kSliver = 16 ///< outside, but material thinner than the sample spacing passes close by
};

/// Material that no sample hits, or just one, found where a row passes in and out of it.
struct Sliver
{
	std::int32_t cutCell;
	std::uint16_t sample;
	std::uint8_t axis;
	bool hasSample; ///< takes that sample's place in the sums
	float fraction; ///< of a whole cell
	Vec3d point;    ///< in cells, from the low corner of the grid
};

/// Lattice positions by kind. Anything not listed is outside. All lists ascend.
struct Voxels
{
	Grid grid;
	std::vector<std::uint64_t> full; ///< keys of positions within the material
	std::vector<std::uint64_t> cut;  ///< keys of positions that the surface passes through or near
	std::vector<std::uint8_t> flags; ///< of each cut cell's samples, x fastest
	std::vector<Sliver> slivers;     ///< of cut cells with thin material; by cell, then sample

	std::size_t samplesPerCell() const { return std::size_t( grid.samplesPerCell() ); }
};

/// Tells the game how far building has come, never going back.
class Progress
{
public:
	explicit Progress( const LatticeSettings& settings ) : m_settings( settings ) {}

	/// False: the game wants to stop.
	bool report( float fraction );

private:
	const LatticeSettings& m_settings;
	float m_done = 0.0f;
};

struct VoxelizeOptions
{
	double gap = 0.0;       ///< m; material parted by less than this is not parted
	double mostCells = 0.0; ///< gives up above it
	TaskRunner* runner = nullptr;
	Progress& progress;
};

/// Fails with TooManyCells or Cancelled; the sentence is the caller's.
ResultCode voxelize( const SnappedSurface& surface, const VoxelizeOptions& options, Voxels& out );

} // namespace pliant
