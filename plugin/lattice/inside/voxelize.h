#pragma once

// Determines which lattice positions hold material, and which samples do in those that the surface passes through. Ohta et al. 2009,
// "Preprocessing".

#include "lattice/inside/grid.h"
#include "lattice/inside/rows.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pliant {

/// State of one sample of a cut cell.
enum SampleFlag : std::uint8_t
{
	kInside = 1,
	kBlockedX = 2, ///< both this sample and the next along x are inside, but a gap lies between them
	kBlockedY = 4,
	kBlockedZ = 8,
	kSliver = 16 ///< outside, but material thinner than the sample spacing passes close by
};

/// By axis.
constexpr std::array<std::uint8_t, 3> kBlocked = { kBlockedX, kBlockedY, kBlockedZ };

/// Material that contains at most one sample, found where a row enters and leaves it.
struct Sliver
{
	std::int32_t cutCell;
	std::uint16_t sample;
	std::uint8_t axis;
	bool hasSample; ///< replaces that sample in the sums
	float fraction; ///< of a whole cell
	Vec3d point;    ///< in cells, from the low corner of the grid
};

/// Lattice positions by kind. Positions not listed are outside. All lists ascend.
struct Voxels
{
	Grid grid;
	std::vector<std::uint64_t> full; ///< keys of positions within the material
	std::vector<std::uint64_t> cut;  ///< keys of positions that the surface passes through or near
	std::vector<std::uint8_t> flags; ///< of each cut cell's samples, x fastest
	std::vector<Sliver> slivers;     ///< of cut cells with thin material; by cell, then sample

	std::size_t samplesPerCell() const { return std::size_t( grid.samplesPerCell() ); }
};

/// Reports the progress of building to the game; it never decreases.
class Progress
{
public:
	explicit Progress( const LatticeSettings& settings ) : m_settings( settings ) {}

	/// Returns false where the game cancels.
	bool report( float fraction );

private:
	const LatticeSettings& m_settings;
	float m_done = 0.0f;
};

struct VoxelizeOptions
{
	double gap = 0.0;      ///< m; narrower gaps are ignored
	double maxCells = 0.0; ///< limit above which voxelizing is abandoned
	TaskRunner* runner = nullptr;
	Progress& progress;
};

/// Fails with TooManyCells or Cancelled; the caller adds the message.
ResultCode voxelize( const SnappedSurface& surface, const VoxelizeOptions& options, Voxels& out );

} // namespace pliant
