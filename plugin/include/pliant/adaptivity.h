#pragma once

// Levels of detail of a body: which cells are simulated as one node, how the regions of such nodes are built, and when the levels change.
// Steinemann et al. 2008, sections 4 and 5; Ohta et al. 2009, "Deformation" and "Changing the Subdivision Level".

#include "pliant/export.h"
#include "pliant/result.h"

namespace pliant {

/// How the region of a node is built when nodes differ in size.
enum class RegionRule : int
{
	Multiplicity, ///< the sum of the finest regions of the node's cells; a cell counts once for each of them that contains it. Default.
	Union,        ///< the union of the finest regions of the node's cells (Ohta et al. 2009, "Preprocessing")
	Interval      ///< all nodes within a distance w through the material, optionally up to ( 1 + eps ) w (Steinemann et al. 2008, 4.2)
};

/// How much softer a coarse region is made, so that the stiffness is the same on all levels.
enum class Softening : int
{
	None,        ///< not at all: coarse nodes are stiffer (Steinemann et al. 2008)
	Ohta1D,      ///< Ohta et al. 2009, eq. 8
	Ohta2D,      ///< Ohta et al. 2009, eq. 9
	Ohta3D,      ///< Ohta et al. 2009, eq. 10
	Energy,      ///< one factor for all directions, from the second moments of the region's material
	EnergyTensor ///< one factor for each direction, exact for every affine deformation. Default.
};

/// Which fraction eta of the non-affine part of the deformation a coarse region leaves uncorrected.
enum class ResidualRule : int
{
	Keep,      ///< eta = 0 (Ohta et al. 2009, eq. 5)
	Soften,    ///< eta = beta, as for the affine part. Needs no matrix inverse; the cheapest and most robust.
	Quadratic, ///< quadratic deformations store the same energy as in the finest regions
	Larger     ///< the larger of Soften and Quadratic. Default.
};

/// Settings of the levels of detail; off by default. A body without levels allocates nothing for them and runs no extra code per node.
struct Adaptivity
{
	/// Number of levels above the finest cells, 0 to 4. 0: the uniform lattice. A node of level l holds up to 8^l cells.
	int coarseLevels = 0;

	/// A coarse node replaces its children where its mass is at least this fraction of a full node's mass. Above 0; above 1: never.
	float keepMass = 0.5f;
	/// Whether cells at the surface always stay on the finest level, regardless of keepMass.
	bool isSurfaceFine = false;

	/// How the regions of nodes of different sizes are built.
	RegionRule regions = RegionRule::Multiplicity;
	/// How much softer coarse regions are made.
	Softening softening = Softening::EnergyTensor;
	/// How much of the non-affine deformation coarse regions leave uncorrected.
	ResidualRule residual = ResidualRule::Larger;
	/// Factor on 1 - beta and 1 - eta of coarse regions, (0, 1]. Below 1 coarse regions yield more in violent impacts.
	float coarseStiffness = 1.0f;
	/// eps of RegionRule::Interval, [0, 4].
	float intervalSlack = 0.5f;
	/// How the sums of RegionRule::Interval are computed: through the octree (true; Steinemann et al. 2008, section 4.3) or node by node.
	/// The results are equal up to rounding.
	bool hierarchicalSums = true;

	/// A node is split when a singular value of its region's stretch differs from 1 by more than this, [0, 10]. 0: never by strain.
	float refineStrain = 0.0f;
	/// Sibling nodes are merged when the strain of all of them is below this fraction of refineStrain, [0, 1), ...
	float mergeFraction = 0.5f;
	/// ... and nothing has requested the finer nodes, for this long, s, [0, 60]. keepMass and isSurfaceFine still limit what is merged.
	float mergeDelay = 0.1f;
	/// Whether nodes that touch another object are split down to the finest level.
	bool refinesOnContact = false;
	/// Largest number of nodes that level changes may create in one game step, 8 to 1 000 000. The rest waits for the next game step; the
	/// most strained nodes are split first.
	int nodesPerStep = 1000;
};

/// Settings that reproduce Steinemann et al. 2008, for comparison.
[[nodiscard]] PLIANT_API Adaptivity steinemannAdaptivity( int coarseLevels );
/// Settings that reproduce Ohta et al. 2009, for comparison.
[[nodiscard]] PLIANT_API Adaptivity ohtaAdaptivity( int coarseLevels );

/// Returns Ok, or BadSettings with a sentence about the first setting that is out of its range (NaN included). BadArgument where this build
/// lacks Feature::Levels and coarseLevels is above 0.
PLIANT_API Status check( const Adaptivity& adaptivity );

} // namespace pliant
