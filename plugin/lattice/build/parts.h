#pragma once

// One cell per piece of material in a lattice position. Steinemann et al. 2008, section 4.1; Ohta et al. 2009, "Preprocessing".

#include "lattice/inside/voxelize.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace pliant {

/// A cell before it becomes an entry of the lattice's arrays.
struct CellDraft
{
	std::uint64_t key;
	std::int32_t cutCell; ///< index in Voxels::cut; -1: a full position
	float fill;
	Vec3d centre; ///< of its material, in cells from the low corner of the grid
};

/// The cells in the lattice's order, and the map from samples to cells.
class Parts
{
public:
	static constexpr std::int32_t kNone = -1;

	/// Pieces below `minimumFill` are omitted.
	Parts( const Voxels& voxels, const InsideField& field, float minimumFill, TaskRunner* runner );

	const std::vector<CellDraft>& cells() const { return m_cells; }
	const Voxels& voxels() const { return m_voxels; }

	/// The cell whose material contains a sample; kNone outside or where the piece was omitted.
	std::int32_t cellAt( const Eigen::Vector3i& position, const Eigen::Vector3i& sample ) const;

	/// The cells at a position: the first, and one past the last.
	std::pair<std::int32_t, std::int32_t> cellsAt( std::uint64_t key ) const;

	std::size_t sampleNumber( const Eigen::Vector3i& sample ) const
	{
		const int s = m_voxels.grid.samples;
		return std::size_t( ( sample.z() * s + sample.y() ) * s + sample.x() );
	}

private:
	/// The pieces of some cut cells, in order.
	struct Pieces
	{
		std::vector<CellDraft> cell;
		std::vector<std::uint8_t> pieceCount;  ///< by cut cell: 0, 1, or kSeveral
		std::vector<std::uint16_t> label;      ///< of each sample, for cut cells with several pieces
		std::vector<std::int32_t> cellOfLabel; ///< by label: index among the cut cell's kept pieces, or kNone
		std::vector<std::uint32_t> labelCount; ///< by cut cell with several pieces
	};
	static constexpr std::uint8_t kSeveral = 2;

	void cutPieces( std::size_t cutCell, float minimumFill, const InsideField& field, Pieces& out ) const;
	std::uint32_t labelSamples( std::size_t cutCell, const InsideField& field, std::vector<std::uint16_t>& label ) const;
	void joinDiagonally( std::size_t cutCell, const InsideField& field, class UnionFind& sets ) const;
	void mergeWithFull( std::vector<Pieces>& pieces );

	const Voxels& m_voxels;
	std::vector<CellDraft> m_cells;
	std::vector<std::uint64_t> m_keys;      ///< of m_cells
	std::vector<std::int32_t> m_labelStart; ///< by cut cell: index into m_label in units of samplesPerCell, or kNone
	std::vector<std::uint16_t> m_label;
	std::vector<std::int32_t> m_mapStart; ///< by labelled cut cell: index into m_cellOfLabel
	std::vector<std::int32_t> m_cellOfLabel;
	std::unique_ptr<PositionIndex> m_index;
};

/// True where the segment from a sample to its diagonal neighbour does not cross the surface; called when no sample next to it is inside.
bool isUnobstructed( const InsideField& field, const Grid& grid, const Eigen::Vector3i& sample, const Eigen::Vector3i& step );

/// The 10 of 20 diagonal steps that come after their opposites.
const std::vector<Eigen::Vector3i>& diagonalSteps();

} // namespace pliant
