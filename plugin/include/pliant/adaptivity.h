#pragma once

// Levels of detail of a body: which cells are simulated together, by which of the papers' methods, and when that changes.
// Steinemann et al. 2008, sections 4 and 5; Ohta et al. 2009, "Deformation" and "Changing the Subdivision Level".

#include "pliant/export.h"
#include "pliant/result.h"

namespace pliant {

/// How a node's region is made when nodes differ in size.
enum class RegionRule : int
{
	Multiplicity, ///< the sum of the finest regions under the node, each cell as often as it is in one: the default
	Union,        ///< the union of the finest regions under the node (Ohta et al. 2009, "Preprocessing")
	Interval      ///< all nodes nearer than w along the material, those up to (1 + eps) w as it suits (Steinemann et al. 2008, section 4.2)
};

/// How much softer a big region is made, so that stiffness is the same on all levels.
enum class Softening : int
{
	None,        ///< as Steinemann et al. 2008: big nodes are stiffer
	Ohta1D,      ///< Ohta et al. 2009, eq. 8
	Ohta2D,      ///< eq. 9
	Ohta3D,      ///< eq. 10
	Energy,      ///< from the second moments of what the region holds, one number for all directions
	EnergyTensor ///< the same in each direction, exact for every affine deformation: the default
};

/// How much of what no affine motion explains a big region leaves alone.
enum class ResidualRule : int
{
	Keep,      ///< nothing: Ohta et al. 2009, eq. 5
	Soften,    ///< as much as the affine part: eta = beta. No matrix is inverted; the cheapest and most robust
	Quadratic, ///< so that quadratic deformations cost what they cost the finest regions
	Larger     ///< the larger of the two: the default
};

/// Off by default. A body without levels allocates nothing for them and runs no branch per node.
struct Adaptivity
{
	/// Levels above the finest cells, 0 to 4; 0: the uniform lattice. A node of level l holds up to 8^l cells.
	int coarseLevels = 0;

	/// A node is used instead of its children where it has at least this share of a full node's material, (0, 1]. Above 1: never.
	float keepMass = 0.5f;
	/// Cells at the surface stay finest, whatever they weigh.
	bool isSurfaceFine = false;

	RegionRule regions = RegionRule::Multiplicity;
	Softening softening = Softening::EnergyTensor;
	ResidualRule residual = ResidualRule::Larger;
	/// 1 - beta and 1 - eta of big regions are multiplied by this, (0, 1]: below 1 they give way more in violent impacts.
	float coarseStiffness = 1.0f;
	/// eps of RegionRule::Interval, [0, 4].
	float intervalSlack = 0.5f;
	/// Sums of RegionRule::Interval go by way of the octree (Steinemann et al. 2008, section 4.3) or node by node; the same but for
	/// rounding.
	bool hierarchicalSums = true;

	/// A node is split when a singular value of its region's stretch is further from 1 than this, (0, 10]. 0: never by strain.
	float refineStrain = 0.0f;
	/// Siblings are merged when all are below this share of refineStrain, [0, 1), ...
	float mergeFraction = 0.5f;
	/// ... and nothing has asked for them, for this long, s, [0, 60]. Never beyond what keepMass and isSurfaceFine allow.
	float mergeDelay = 0.1f;
	/// Nodes that touch another object are split down to the finest level.
	bool refinesOnContact = false;
	/// Nodes that changes may bring in one game step; what is left waits for the next, most strained first. 8 to 1 000 000.
	int nodesPerStep = 1000;
};

/// The papers' own settings, for comparison.
PLIANT_API Adaptivity steinemannAdaptivity( int coarseLevels );
PLIANT_API Adaptivity ohtaAdaptivity( int coarseLevels );

/// The first thing wrong with the settings, or Ok.
PLIANT_API Status check( const Adaptivity& adaptivity );

} // namespace pliant
