#pragma once

// The finest cells of a body at rest and the links between them: the result of preprocessing.
// Ohta et al. 2009, "Preprocessing"; Steinemann et al. 2008, section 4.1. Immutable once built; bodies share it.

#include "pliant/result.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace pliant {

class Archive;

using Vec3 = Eigen::Vector3f;
using Vec3d = Eigen::Vector3d;

/// The drawn surface in front of a cell: the best fitting sphere, whose centre lies on the line from the node along `normal`. See
/// contact_patches.h.
struct ContactPatch
{
	Vec3 normal = Vec3::Zero(); ///< outwards, of unit length, in the rest frame
	float height = 0.0f;        ///< of the surface above the node along the normal, m
	float radius = 0.0f;        ///< of the sphere, m, at least `height`; 0 where no patch exists, as at edges and in thin parts (edgeFace)
	std::uint8_t links = 0;     ///< of the cell at the time of the fit: with fewer links, a crack has opened other faces
};

struct Lattice
{
	float cellSize = 0.0f;                            ///< d, m
	Vec3d corner = Vec3d::Zero();                     ///< low corner of lattice position (0, 0, 0), in the mesh's coordinates, m
	Vec3d massCentre = Vec3d::Zero();                 ///< in the mesh's coordinates, m; rest centres are relative to it
	Eigen::Vector3i extent = Eigen::Vector3i::Zero(); ///< lattice positions along x, y, z; each coordinate is in [0, extent)

	std::vector<Eigen::Matrix<std::int16_t, 3, 1>> coordinate; ///< lattice position of a cell
	std::vector<float> fill;                                   ///< material fraction of the cell, (0, 1]
	std::vector<Vec3> restCentre;                              ///< centre of mass of the cell's material, relative to massCentre, m
	std::vector<std::uint8_t> isSurface;                       ///< 1 where the cell is not full or lacks one of its 26 links

	/// By cell; empty where no patches were fitted.
	std::vector<ContactPatch> patch;
	/// The faces in front of cells without a patch, at edges and in thin parts: edgeFace[ edgeFaceStart[i] .. edgeFaceStart[i + 1] ) of
	/// cell i.
	std::vector<ContactPatch> edgeFace;
	std::vector<std::uint32_t> edgeFaceStart;
	float overhang = 0.0f; ///< upper bound of how far a patch lies in front of its node's sphere, m

	/// The 26-neighbour links as compressed rows: cell i is linked to linkTo[ linkStart[i] .. linkStart[i + 1] ), ascending, both
	/// directions stored, without self-links.
	std::vector<std::uint32_t> linkStart;
	std::vector<std::uint32_t> linkTo;

	int cellCount() const { return int( fill.size() ); }
	int linkCount() const { return int( linkTo.size() / 2 ); }
};

/// Writes or reads a lattice; one that is not valid is refused.
void archive( Archive& archive, Lattice& lattice );

/// Checks every invariant of a lattice: sizes agree, cells are ordered, links are symmetric, sorted and between 26-neighbours, fills lie in
/// (0, 1], the mass centre is at zero. The message names the first violation.
Status validate( const Lattice& lattice );

} // namespace pliant
