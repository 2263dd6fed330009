#pragma once

// What a body that can break keeps beside its state: the rule, how long each link may get, and what broke in the last substep.
// Ohta et al. 2009, "Fracturing".

#include "fracture/link_limits.h"
#include "fracture/plane_cracks.h"
#include "pliant/fracture.h"
#include "pliant/material.h"

#include <Eigen/Geometry>

#include <memory>
#include <vector>

namespace pliant {

class Body;

/// The stretch at which a link of toughness 1 breaks.
inline float breakStrain( const Fracture& fracture, const Material& material )
{
	return fracture.strength > 0.0f ? fracture.strength / material.youngsModulus : fracture.breakStrain;
}

struct Breaking
{
	Fracture settings;
	LinkLimits limits;
	std::vector<CellLink> broken;          ///< waiting to be taken out, ascending
	float sinceLook = 0.0f;                ///< s since planes were looked at
	float coolDown = 0.0f;                 ///< s until links are tested again, or new cracks may begin
	CellRefinementStates refinementStates; ///< bodies with levels only
	std::unique_ptr<PlaneCracks> planes;   ///< BreakRule::Plane only

	/// Limits and planes for the settings.
	void prepare( const Lattice& lattice, float strain, std::vector<float> toughness );
};

/// A part of a body that has come apart. Its nodes are some of the body's, in their order.
struct BodyPiece
{
	std::unique_ptr<Body> body;
	std::vector<std::uint32_t> nodeBefore; ///< of each node: its number in the body before
	std::vector<std::uint32_t> cellBefore; ///< of each finest cell: its number there
	std::vector<std::uint32_t> touched;    ///< finest cells, ascending, that lost links or got some
	std::vector<std::uint32_t> treeBefore; ///< LevelBaseUpdate::nodeBefore; empty where nothing is taken over
	bool isOnePart = true;
	bool isLast = false;                                      ///< made last: what the whole needs no more may be taken
	bool isSmall = false;                                     ///< Fracture::smallCells
	bool isRigid = false;                                     ///< one rigid cluster
	Eigen::Quaternionf turn = Eigen::Quaternionf::Identity(); ///< of the material at one of its nodes
};

/// What one event did.
struct BreakReport
{
	int links = 0;                ///< broken
	double area = 0.0;            ///< m^2, of one side, from the links between cells that share a face
	double energy = 0.0;          ///< J: what the broken links held, E e^2 / 2 over their share of the material
	std::vector<CellLink> broken; ///< by the numbers of the body before
	bool hasHealed = false;       ///< links were put back
	int removedPieces = 0;        ///< SmallPieces::Remove
	double removedMass = 0.0;     ///< kg
};

} // namespace pliant
