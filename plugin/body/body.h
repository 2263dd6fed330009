#pragma once

// One soft body's state and its step, without any world around it. Knows no Bullet.
// A substep: accelerateTowardGoals (shape matching), applyForces, [contacts], integrate.

#include "pliant/adaptivity.h"
#include "pliant/fracture.h"
#include "pliant/material.h"
#include "pliant/result.h"

#include "body/levels/level_energy.h"
#include "lattice/lattice.h"
#include "matching/kernels/kernels.h"
#include "matching/node_state.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace pliant {

class Matcher;
class LatticeMatcher;
class Levels;
class ImplicitMotion;
class TaskRunner;
struct TemplateCache;
struct Breaking;
struct BodyPiece;
struct BreakReport;
struct CellLink;
struct PieceOfLevels;
struct LinkLimits;

/// A rigid placement in double precision.
struct Placement
{
	Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
	Vec3d position = Vec3d::Zero(); ///< where the mass centre goes, m
};

/// Sums over the nodes, in double, in a fixed order. Positions are relative to `NodeState::origin`.
struct BodySums
{
	double mass = 0.0;              ///< kg
	Vec3d centre = Vec3d::Zero();   ///< mass centre relative to the origin, m
	Vec3d momentum = Vec3d::Zero(); ///< kg m/s
	Vec3d spin = Vec3d::Zero();     ///< angular momentum about the mass centre, kg m^2/s
	double kineticEnergy = 0.0;     ///< J
};

/// How a piece with levels comes to its octree and its regions.
enum class PieceRoad : int
{
	TakeOver,   ///< from those of the whole, which are kept where no link changed
	FromNothing ///< from its lattice: the slow twin
};

enum class BodyHealth : int
{
	Good,
	Quarantined ///< a number stopped being finite: the body was put back to its last finite state and stopped
};

class Body
{
public:
	/// Refuses bad settings and running out of memory. Bodies of one lattice share their tables through `cache` (may be null).
	/// Levels need Method::Lattice.
	static Result<std::unique_ptr<Body>> create( std::shared_ptr<const Lattice> lattice, const Material& material,
		const Placement& placement, std::shared_ptr<TemplateCache> cache = nullptr, const Adaptivity& adaptivity = {},
		const StiffnessField& stiffness = {} );
	~Body();

	// --- state, flat arrays; write freely between steps -------------------------------------------------------------
	NodeState& nodes() { return m_nodes; }
	const NodeState& nodes() const { return m_nodes; }
	int nodeCount() const { return m_nodes.count; }
	const Lattice& lattice() const { return *m_lattice; }
	const Material& material() const { return m_material; }
	const Matcher& matcher() const { return *m_matcher; }

	/// New stiffness, damping, density ...; refused (and nothing changed) when `material` fails its check. What has flowed plastically
	/// outlives changes that leave the regions as they are: other methods, weights, widths, beta and kept volume begin at the first rest
	/// shape.
	Status setMaterial( const Material& wanted );

	/// Rigid placement of the rest shape; velocities zero; matching history forgotten.
	void place( const Placement& placement );
	/// Moves and turns the body as it is (deformation kept); velocities turn along.
	void teleport( const Placement& by );

	/// A pinned node keeps the velocity it is given (`NodeState::v`) and is not moved by matching or forces.
	void setPinned( int node, bool pinned );

	// --- levels of detail --------------------------------------------------------------------------------------------
	/// Null where the body has none: node i is then cell i.
	const Levels* levels() const { return m_levels.get(); }
	/// Splits and merges nodes as strain and requests ask for it; to be called at the start of a substep. True when nodes changed: their
	/// numbers did then too (Levels::lastChange).
	bool adaptLevels( float h );
	/// The two halves of it: whether there is something to change, and the change.
	bool reviewLevels( float h );
	/// A game step begins: Adaptivity::nodesPerStep holds for all its changes together, and what had to wait comes now.
	void openLevelBudget();
	void applyLevels( TaskRunner* tasks = nullptr );
	/// Splits and merges octree nodes by name; see changeCut.
	void changeLevels( const std::vector<std::uint32_t>& split, const std::vector<std::uint32_t>& merge );
	/// What all regions and nodes hold now, in an explicit step: nothing in others. For who moves nodes of a change (oweSince).
	LevelEnergy heldEnergy();
	/// What explicit substeps keep, J, without damping and contacts.
	double joules( const LevelEnergy& held, float h, float alpha ) const;
	/// What the body holds more than it did then is taken off as what changes bring.
	void oweSince( const LevelEnergy& before );
	void requestSplit( int node );
	void keepNode( int node ); ///< from being merged
	void setFinestLevel( int level );
	/// F of each node's region, 9 floats a node, row by row. Only for bodies with levels.
	void nodeDeformations( float* gradients ) const;
	/// The same of a few, ascending.
	void nodeDeformationsOf( const std::vector<std::uint32_t>& nodes, float* gradients ) const;
	/// The rotation of a body with levels, as the last substep found it.
	Eigen::Quaternionf levelFrame() const;

	// --- breaking ----------------------------------------------------------------------------------------------------
	/// Whether and when links break. Refuses bad settings, and methods without a lattice of regions. BreakRule::Never drops all that is
	/// kept for breaking; what becomes of pieces that are cut off is kept with any rule.
	Status setFracture( const Fracture& fracture, const ToughnessField& toughness = {} );
	/// What was set.
	const Fracture& fracture() const { return m_fracture; }
	/// Null for a body that cannot break.
	const Breaking* breaking() const { return m_breaking.get(); }
	/// Looks for links that are stretched too far; to be called after `integrate`. They break in the next `breakApart`.
	void testLinks( float h );
	/// Breaks links by name, whatever they bear: `links` ascending, each once, all of them there. Also for bodies that do not break by
	/// themselves. Returns how many had not been broken so before.
	int breakLinks( const std::vector<CellLink>& links );
	/// Puts links back by name: ascending, each once, none of them there, between 26-neighbours. Returns how many had not been before.
	int healLinks( const std::vector<CellLink>& links );
	/// Where each finest cell is now, relative to `NodeState::origin`; those under a big node where its region's deformation has them.
	std::vector<Vec3d> cellPositions() const;
	/// Makes ahead what the first links that go need and bodies of one template share until then.
	void prepareToBreak();
	/// Whether there are links to be taken out or put back.
	bool hasBrokenLinks() const;
	/// Big nodes above such links, and above what will be rigid pieces: they are split, one level at a time, before anything else is done.
	/// Numbers of nodes change with each (Levels::lastChange).
	bool mustRefineToBreak() const;
	void refineToBreak();
	/// The parts that are left, by mass, heaviest first, equals in the order of their lowest cells; at least one. Together they have this
	/// body's mass, momentum and spin, places and speeds to the bit, but for small ones that are removed (SmallPieces). At most `most` of
	/// them, at least 1: what is too many stays one body with the heaviest. Nothing is left of this body afterwards but nodeCount() and
	/// firstCells().
	std::vector<BodyPiece> breakApart( BreakReport& report, int most, PieceRoad road = PieceRoad::TakeOver );
	/// The node that holds a finest cell.
	int nodeOfCell( std::uint32_t cell ) const;
	/// Of each finest cell: its number in the lattice the first body of the family was made of. Empty: the same.
	const std::vector<std::uint32_t>& firstCells() const { return m_firstCell; }
	/// The other way round: the number here of a cell of that lattice; kNoNode where this body has none of it.
	std::uint32_t ownCell( std::uint32_t first ) const;

	// --- one substep of length h, s ---------------------------------------------------------------------------------
	/// Shape matching and damping: v += (alpha e + k de) / h, and the wobble's share of v. `runner` may be null (calling thread alone).
	void accelerateTowardGoals( float h, float alpha, TaskRunner* runner );
	/// v += h (gravity + f / m), after matching, or damping would take its share of what holds a loaded body in shape. Forces f are left as
	/// they are (the world clears them once a game step).
	void applyForces( float h, const Vec3& gravity, TaskRunner* runner = nullptr );

	// The implicit substep (docs/design/implicit.md) in the place of the two above: pushImplicitly, [contacts and the system's solution],
	// integrate.
	/// Whether there are regions to linearise, of one size or several: Method::Lattice with conserving weights and no far levels.
	bool canStepImplicitly() const;
	/// The same with the reason.
	Status implicitStatus() const;
	/// How much harder than others a region of the body answers at most (link_moments.h).
	float largestRegionFraction() const;
	/// Prepares `implicit()`; leaves the nodes with the speeds of free flight. `alpha` may be of any size.
	void pushImplicitly( float h, float alpha, const Vec3& gravity, TaskRunner* runner );
	/// For a body whose forces are applied: it takes part in other bodies' system with its masses alone.
	ImplicitMotion& takePartFreely();
	/// Null before the first of the two.
	ImplicitMotion* implicit() { return m_implicit.get(); }
	/// Speeds at the start of the substep.
	const Vec3Array& velocityBefore() const { return m_velocityBefore; }
	/// The end of pushImplicitly for a body that touches nothing; returns how many products it took.
	int solveAlone( TaskRunner* runner );

	/// x += h v   (Ohta et al. 2009, eq. 4); moves the origin along when the body strays from it. Checks every number: see BodyHealth.
	BodyHealth integrate( float h, TaskRunner* runner = nullptr );
	/// Of all nodes once their forces are applied, m/s.
	const VelocityBounds& velocities() const { return m_velocities; }
	/// Of all nodes where `integrate` has left them; places relative to `NodeState::origin`.
	const MotionSums& motion() const { return m_motion; }
	/// The same of the nodes as they are (`sums`): the slow twin.
	MotionSums measureMotion() const;

	// --- measures ---------------------------------------------------------------------------------------------------
	BodySums sums() const;
	/// The rigid motion that fits the body best (mass centre in world coordinates, rotation of all nodes together).
	/// `guess`: the rotation where the nodes leave it open (few of them, or in one line).
	Placement bestFit( const Eigen::Quaterniond& guess = Eigen::Quaterniond::Identity() ) const;
	/// A unit quaternion (x, y, z, w) a node: the rotation of its own region from rest to now. 4 floats a node.
	void nodeRotations( float* quaternions ) const;
	/// Whether rest shapes have flowed, and each node's stretch of it, 9 floats a node, row by row: the goals of its region are R S_p.
	bool hasFlowed() const;
	void nodeFlow( float* stretches ) const;
	/// Bytes of the body's state, its matching, and of the lattice and tables it shares with others of its template.
	std::size_t bytes() const;
	/// Cells whose eight-corner frame has turned inside out, as a share of those that can be tested.
	float invertedFraction() const;

private:
	Body();
	Body( Body&& ) noexcept;
	void owe( const LevelEnergy& brought );
	void payForLevels( float h, float alpha );
	void rebase();
	Status sampleStiffness( const StiffnessField& field );
	void makeNodes( const Adaptivity& adaptivity );
	std::unique_ptr<Matcher> makeMatcher( const Material& material );
	std::unique_ptr<Matcher> makePieceMatcher( const Body& from, const BodyPiece& piece );
	/// E h^2 / ( rho d^2 ), all levels together.
	double stiffnessMoment( float h, float alpha ) const;
	float wobbleRate( float h, float alpha ) const;
	float bodyFraction( float h, float alpha ) const;
	void makeMeasures( bool isOnePart );
	void refineBeforeBreaking();
	std::vector<CellLink> brokenLinks() const;
	bool isSmall( const std::vector<std::uint32_t>& cells ) const { return int( cells.size() ) <= m_fracture.smallCells; }
	bool makesRigid() const;
	void addNodesOfRigid( std::vector<std::uint32_t>& nodes ) const;
	void removeSmall( std::vector<std::vector<std::uint32_t>>& parts, BreakReport& report ) const;
	std::vector<std::uint32_t> nodesAboveBroken() const;
	BreakReport reportOn( const std::vector<CellLink>& broken ) const;
	std::unique_ptr<Body> makePiece( std::shared_ptr<const Lattice> lattice, BodyPiece& piece, PieceRoad road ) const;
	std::unique_ptr<Body> relinkWhole( const std::shared_ptr<const Lattice>& lattice, BodyPiece& piece );
	PieceOfLevels pieceOfLevels( const Body& from, const BodyPiece& piece, PieceRoad road ) const;
	void inheritLevels( const Body& from, BodyPiece& piece, PieceRoad road );
	LinkLimits limitsOf( const Breaking& from, const BodyPiece& piece ) const;
	void inheritNodes( const Body& from, const BodyPiece& piece );
	void inheritBreaking( const Breaking& from, const BodyPiece& piece );
	void reserveMotionScratch();
	void keepVelocities( TaskRunner* runner );
	void keepFiniteState();
	void restoreFiniteState();

	std::shared_ptr<const Lattice> m_lattice;
	std::shared_ptr<TemplateCache> m_cache;
	Material m_material;
	std::vector<float> m_stiffness; ///< share of each finest cell; empty: 1 everywhere
	NodeState m_nodes;
	std::unique_ptr<Matcher> m_matcher;
	std::unique_ptr<ImplicitMotion> m_implicit; ///< null until the first implicit substep
	Vec3Array m_velocityBefore;                 ///< of it
	AlignedArray<float> m_pushed;
	std::unique_ptr<Levels> m_levels;
	LatticeMatcher* m_levelMatcher = nullptr; ///< m_matcher where there are levels
	std::unique_ptr<Breaking> m_breaking;     ///< null: cannot break
	Fracture m_fracture;
	std::vector<CellLink> m_cutLinks, m_healedLinks; ///< by name, ascending
	std::vector<std::uint32_t> m_firstCell;
	int m_reviewIn = 0;         ///< substeps until strains are measured
	float m_sinceReview = 0.0f; ///< s
	LevelDebt m_owed;           ///< of explicit steps
	bool m_wasImplicit = false; ///< the last substep
	bool m_isOnePart = true;
	double m_secondMoment = 0.0; ///< m^2, mean over the axes, per mass
	double m_restLength = 1.0;   ///< m, longest edge of the rest shape's box
	VelocityBounds m_velocities;
	MotionSums m_motion;
	AlignedArray<float> m_lastFinite, m_kept; ///< x of the last finite state, component after component; and room for the next
	Vec3d m_lastFiniteOrigin = Vec3d::Zero();
	double m_strayLimit = 4.0; ///< m; node 0 may be this far from the origin before the origin follows
};

} // namespace pliant
