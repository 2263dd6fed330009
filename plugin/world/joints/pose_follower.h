#pragma once

// The data of a body that follows a pose (pliant/game/skeleton.h). Cells are those of the template: fragments and bodies with levels find
// theirs by Body::firstCells. Each substep the targets of a node's cells become one velocity and one gain (body/implicit/node_pull.h).

#include "body/body.h"
#include "lattice/lattice.h"

#include <array>
#include <memory>
#include <vector>

namespace pliant {

class Archive;

/// The immutable part, which all pieces of a body share.
struct PoseModel
{
	static constexpr int kMostBones = 4;
	struct Weights
	{
		std::array<int, kMostBones> bone = { 0, 0, 0, 0 };
		std::array<float, kMostBones> weight = { 0.0f, 0.0f, 0.0f, 0.0f };
	};
	int boneCount = 0;            ///< 0: targets are given
	std::vector<Weights> weights; ///< by cell; empty where targets are given
	std::vector<Vec3d> rest;      ///< by cell: centre of mass, mesh coordinates, m
	std::vector<float> strength;  ///< by cell, [0, 1]
	std::vector<float> reach;     ///< by cell: largest distance, m
	std::vector<float> fill;      ///< by cell: a node's cells count by their masses
	double frequency = 0.0;       ///< rad/s
	double dampingRatio = 0.0;
};

class PoseFollower
{
public:
	std::shared_ptr<const PoseModel> model;
	double blend = 1.0;
	bool hasPose = false;
	std::vector<Vec3d> before, target; ///< by cell, world, m: at the start and the end of the game step
	bool isMoving = false;             ///< they differ

	// Sums over the game step so far, and the means over the last one; angular ones about the origin of the world.
	Vec3d impulse = Vec3d::Zero(), angularImpulse = Vec3d::Zero(); ///< N s, N m s
	double time = 0.0;                                             ///< s
	Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();           ///< N, N m, the torque about the centre of mass

	/// Sets targets, by cell.
	void setTargets( std::vector<Vec3d> wanted, bool jumps );
	/// Adds `by`, m, to the targets.
	void shift( const Vec3d& by );
	/// Fills the body's NodePull for a substep of length h, s, which is `number` of `count`; clears it where nothing acts. `gravity`: of
	/// the body, m/s^2.
	void pull( Body& body, double h, int number, int count, const Vec3& gravity );
	/// Adds the impulses of the nodes in a substep, with their present velocities.
	void sum( const Body& body, double h );
	/// At the end of a game step: its targets are reached.
	void endStep( const Vec3d& massCentre );

	/// Writes or reads the model, for a template of so many cells; and the data that changes from step to step.
	void archiveMake( Archive& archive, std::size_t cells );
	void archiveState( Archive& archive );

private:
	/// Where a node is to be: means over its cells.
	struct NodeTarget
	{
		double mass = 0.0, strength = 0.0, reach = 0.0;
		Vec3d at = Vec3d::Zero(), displacement = Vec3d::Zero();
	};
	void gather( const Body& body, double reached );

	std::vector<NodeTarget> m_nodes; ///< scratch
};

/// Distributes the bone weights of a mesh's vertices over the cells: `start`, `cell` and `share` are rows of each vertex's cells. A cell
/// without vertices takes the mean of its linked neighbours, from the surface inwards.
std::vector<PoseModel::Weights> weightsOfCells( const Lattice& lattice, int boneCount, int vertexCount,
	const std::vector<std::uint32_t>& start, const std::vector<std::uint32_t>& cell, const std::vector<float>& share,
	const std::vector<PoseModel::Weights>& vertices );

} // namespace pliant
