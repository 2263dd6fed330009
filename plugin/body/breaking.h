#pragma once

// Additional state of a body that can break: the rule, the limit of each link, and the links broken in the last substep. Ohta et al. 2009,
// "Fracturing".

#include "fracture/cut_links.h"
#include "fracture/face_stretch.h"
#include "fracture/link_limits.h"
#include "fracture/plane_cracks.h"
#include "pliant/fracture.h"
#include "pliant/material.h"

#include <Eigen/Geometry>

#include <memory>
#include <vector>

namespace pliant {

class Body;
class ShardCracks;

/// The strain at which a link of toughness 1 breaks.
inline float breakStrain( const Fracture& fracture, const Material& material )
{
	return fracture.strength > 0.0f ? fracture.strength / material.youngsModulus : fracture.breakStrain;
}

struct Breaking
{
	Breaking();
	~Breaking();

	Fracture settings;
	LinkLimits limits;
	std::vector<CellLink> broken;          ///< to be removed, ascending
	float sinceTest = 0.0f;                ///< s since planes were last tested
	float coolDown = 0.0f;                 ///< s until links are tested again, or new cracks may start
	CellRefinementStates refinementStates; ///< bodies with levels only
	/// Of each part, from the nodes' positions to those without the stretch of an implicit step's rotation; empty: none.
	std::vector<Eigen::Matrix3f> unturned;
	/// The nodes' displacement to their positions at the peak of an impact that the substep does not resolve, m, component after
	/// component; empty: none.
	AlignedArray<float> peak;
	double impactEnergy = 0.0;           ///< of that impact, J
	double energy = 0.0;                 ///< J, of the links in `broken` when they were tested
	FaceStretch faces;                   ///< scratch of BreakRule::Distance, and of the energy of events
	Vec3Array untested;                  ///< scratch: the nodes' positions while others are tested
	std::unique_ptr<PlaneCracks> planes; ///< BreakRule::Plane only
	std::unique_ptr<ShardCracks> shards; ///< BreakRule::Shards only

	/// Computes limits and planes for the settings, and adapts shards to the material. Keeps limits.thin.
	void prepare( const Lattice& lattice, const Material& material, std::vector<float> toughness );
	/// Strain for limitLinks that finds candidates of the rule, which breaks at `strain`.
	float candidateStrain( float strain ) const;
	/// Writes or reads settings and limits. `isWhole`: the lattice is the template's, whose limits follow from the settings.
	void archiveMake( Archive& archive, const Lattice& lattice, const Material& material, bool isWhole );
	/// Writes or reads the data that changes from step to step.
	void archiveState( Archive& archive, const Lattice& lattice );
};

/// A part of a body that has broken apart. Its nodes are a subset of the body's, in the same order.
struct BodyPiece
{
	std::unique_ptr<Body> body;
	std::vector<std::uint32_t> nodeBefore; ///< previous index of each node
	std::vector<std::uint32_t> cellBefore; ///< previous index of each finest cell
	std::vector<std::uint32_t> touched;    ///< finest cells, ascending, whose links changed
	std::vector<std::uint32_t> treeBefore; ///< LevelBaseUpdate::nodeBefore; empty where nothing is reused
	bool isOnePart = true;
	bool isLast = false;                                      ///< made last: may take data that the whole no longer needs
	bool isSmall = false;                                     ///< Fracture::smallCells
	bool isRigid = false;                                     ///< one rigid cluster
	Eigen::Quaternionf turn = Eigen::Quaternionf::Identity(); ///< of the material at one of its nodes
};

/// Result of one event.
struct BreakReport
{
	int links = 0;                ///< broken
	double area = 0.0;            ///< m^2, of one side, from the links between cells that share a face
	double energy = 0.0;          ///< J, of the broken links: E e^2 / 2 over their fraction of the material
	Vec3d point = Vec3d::Zero();  ///< centre of the crack, relative to NodeState::origin
	Vec3d normal = Vec3d::Zero(); ///< of the plane that fits it best; either sign
	double partingVelocity = 0.0; ///< m/s, mean of both sides
	std::vector<CutTrace> traces; ///< BreakRule::Shards: borders of shards, by the cells of the body before, mesh coordinates
	std::vector<CellLink> broken; ///< by the indices of the body before
	bool hasHealed = false;       ///< links were put back
	int removedPieces = 0;        ///< SmallPieces::Remove
	double removedMass = 0.0;     ///< kg
};

} // namespace pliant
