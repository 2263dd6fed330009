#pragma once

// One soft body's state and its step, without a world. Independent of Bullet.
// A substep: accelerateTowardGoals (shape matching), applyForces, [contacts], integrate.

#include "pliant/adaptivity.h"
#include "pliant/fracture.h"
#include "pliant/material.h"
#include "pliant/result.h"

#include "body/implicit/node_pull.h"
#include "body/levels/level_energy.h"
#include "lattice/lattice.h"
#include "matching/kernels/kernels.h"
#include "matching/node_state.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace pliant {

class Archive;
class Matcher;
class LatticeMatcher;
class Levels;
class ImplicitMotion;
class TouchedNodes;
class TaskRunner;
struct TemplateCache;
class CellPositions;
struct Breaking;
struct BodyPiece;
struct BreakReport;
struct CellLink;
struct ConnectedParts;
struct PieceOfLevels;
struct PartTurn;
struct LinkLimits;
struct RigidMotion;
struct RigidState;

/// A rigid placement in double precision.
struct Placement
{
	Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
	Vec3d position = Vec3d::Zero(); ///< of the mass centre, m
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

/// How a piece with levels obtains its octree and regions.
enum class PieceBuild : int
{
	Reuse,      ///< from those of the whole, kept where no link changed
	FromScratch ///< from its lattice: the reference implementation
};

/// Returns the nearest possible origin of a body's nodes. Origins lie on a grid, so that they are the same number in float and in double.
Vec3d snapped( const Vec3d& position );

enum class BodyHealth : int
{
	Good,
	Quarantined ///< a non-finite number occurred: the body was restored to its last finite state and stopped
};

class Body
{
public:
	/// Fails on invalid settings or lack of memory. Bodies of one lattice share their tables through `cache` (may be null). Levels need
	/// Method::Lattice.
	static Result<std::unique_ptr<Body>> create( std::shared_ptr<const Lattice> lattice, const Material& material,
		const Placement& placement, std::shared_ptr<TemplateCache> cache = nullptr, const Adaptivity& adaptivity = {},
		const StiffnessField& stiffness = {} );
	~Body();

	// --- state, flat arrays; may be written between steps -------------------------------------------------------------
	NodeState& nodes() { return m_nodes; }
	const NodeState& nodes() const { return m_nodes; }
	/// Forces on nodes by force fields and gas in this substep only, N, besides NodeState::force. Empty where there are none.
	Vec3Array& fieldForce() { return m_fieldForce; }
	int nodeCount() const { return m_nodes.count; }
	const Lattice& lattice() const { return *m_lattice; }
	const Material& material() const { return m_material; }
	const Matcher& matcher() const { return *m_matcher; }

	/// Sets stiffness, damping, density ...; fails and changes nothing when `material` is invalid. Plastic flow survives changes that keep
	/// the regions: another method, weights, half-width, beta or volume keeping restarts from the original rest shape.
	Status setMaterial( const Material& wanted );

	/// Grows or shrinks a body of Method::Lattice without levels and far levels to the size of `lattice`, which is its own, scaled:
	/// positions about the mass centre, masses by density. Velocities and plastic flow stay. Throws std::bad_alloc before any change.
	void rescale( std::shared_ptr<const Lattice> lattice );

	/// Places the rest shape rigidly, with zero velocities, and discards the matching history.
	void place( const Placement& placement );
	/// Moves and rotates the body with its deformation; velocities are rotated too.
	void teleport( const Placement& by );
	/// The world's origin moves: the body's coordinates change by this, m; exactly, by whole multiples of kOriginGrid.
	void shift( const Vec3d& by );

	/// A pinned node keeps its given velocity (`NodeState::v`) and is not moved by matching or forces.
	void setPinned( int node, bool pinned );

	// --- levels of detail --------------------------------------------------------------------------------------------
	/// Null for a body without levels: node i is then cell i.
	const Levels* levels() const { return m_levels.get(); }
	/// Splits and merges nodes according to strain and requests; call at the start of a substep. Returns true when nodes, and thereby node
	/// indices, changed (Levels::lastChange).
	bool adaptLevels( float h );
	/// The two halves of adaptLevels: whether there is something to change, and the change.
	bool reviewLevels( float h );
	/// Starts a game step: Adaptivity::nodesPerStep limits all its changes together, and postponed changes come first.
	void openLevelBudget();
	void applyLevels( TaskRunner* tasks = nullptr );
	/// Splits and merges the given octree nodes; see changeCut.
	void changeLevels( const std::vector<std::uint32_t>& split, const std::vector<std::uint32_t>& merge );
	/// Current energy of all regions and nodes in an explicit step; zero in others. For use with addEnergyDebtSince.
	LevelEnergy storedEnergy();
	/// Energy that explicit substeps conserve without damping and contacts, J.
	double joules( const LevelEnergy& stored, float h, float alpha ) const;
	/// Registers the energy added since `before` for removal, like the energy that level changes add.
	void addEnergyDebtSince( const LevelEnergy& before );
	void requestSplit( int node );
	void keepNode( int node ); ///< excludes the node from merging
	/// Does so for the nodes nearest to `node` that have the given mass together, kg, of which it splits the coarse ones.
	void refineAround( int node, double mass );
	void setFinestLevel( int level );
	/// F of each node's region, 9 floats per node, row-major. Only for bodies with levels.
	void nodeDeformations( float* gradients ) const;
	/// The same for some nodes, ascending.
	void nodeDeformationsOf( const std::vector<std::uint32_t>& nodes, float* gradients ) const;
	/// The rotation of a body with levels, as of the last substep.
	Eigen::Quaternionf levelFrame() const;

	// --- breaking ----------------------------------------------------------------------------------------------------
	/// Sets the rule by which links break. Fails on invalid settings, and for methods without a lattice of regions. BreakRule::Never
	/// discards all breaking data; the handling of cut-off pieces is kept with any rule.
	Status setFracture( const Fracture& fracture, const ToughnessField& toughness = {}, const ShardCentres& centres = {} );
	/// The settings last set.
	const Fracture& fracture() const { return m_fracture; }
	/// Null for a body that cannot break.
	const Breaking* breaking() const { return m_breaking.get(); }
	/// The strain at which the weakest part of it breaks; infinity where nothing of it can break but crumbs.
	double weakestBreakStrain() const;
	/// Finds overstretched links; call after `integrate`, or restLinks without a test. They are removed in the next `breakApart`.
	void testLinks( float h );
	void restLinks( float h );
	/// Of an implicit body that can break, before `integrate`: links are tested without the stretch by which `x += h v` rotates it.
	void noteTurns( float h );
	/// The next testLinks tests the nodes displaced by `peak`, m, component after component, in an impact of `energy`, J. If it can break.
	void noteImpact( const float* peak, double energy );
	/// Breaks the given links at any stretch: `links` ascending, without duplicates, all of them existing. Also for bodies that do not
	/// break by themselves. Returns the number of links not yet marked as broken.
	int breakLinks( const std::vector<CellLink>& links );
	/// Restores links: ascending, without duplicates, none of them existing, between 26-neighbours. Returns the number not yet marked.
	int healLinks( const std::vector<CellLink>& links );
	/// Position of each finest cell, relative to `NodeState::origin`; under a coarse node by its region's deformation.
	std::vector<Vec3d> cellPositions() const;
	/// Precomputes data for the first broken links, which bodies of one template share until then.
	void prepareToBreak();
	/// True where there are links to be removed or restored.
	bool hasBrokenLinks() const;
	/// Coarse nodes above such links, and above future rigid pieces, are split first, one level at a time. Node indices change
	/// (Levels::lastChange).
	bool mustRefineToBreak() const;
	void refineToBreak();
	/// Returns the remaining parts by mass, heaviest first, equal ones in the order of their lowest cells; at least one. Together they have
	/// this body's mass, momentum and spin, with bitwise equal positions and velocities, except for removed small pieces (SmallPieces). At
	/// most `most` >= 1 parts: surplus parts stay one body with the heaviest. Only nodeCount() and firstCells() of this body stay valid.
	std::vector<BodyPiece> breakApart( BreakReport& report, int most, PieceBuild build = PieceBuild::Reuse );
	/// The node that contains a finest cell.
	int nodeOfCell( std::uint32_t cell ) const;
	/// Index of each finest cell in the lattice of the family's first body. Empty: the same index.
	const std::vector<std::uint32_t>& firstCells() const { return m_firstCell; }
	/// The inverse: index in this body of a cell of that lattice; kNoNode where this body does not contain it.
	std::uint32_t ownCell( std::uint32_t first ) const;
	/// Index in that lattice of the first of the cells that a node contains.
	std::uint32_t firstCellOfNode( int node ) const;

	// --- rigid while stiff (Material::rigidStrain) -----------------------------------------------------------------------
	/// Null while the body deforms.
	const RigidState* rigidState() const { return m_rigid.get(); }
	/// Whether its strains and vibrations are below `largestInvisibleStrain`, and nothing else prevents the rigid state: several parts,
	/// plastic flow, broken links, pinned nodes that leave it a rotation. A body that has been at rest for a while may be strained by more
	/// in some parts; one with pinned nodes has to be at rest.
	bool canBecomeRigid( bool isAtRest ) const;
	/// From now on nodes keep their positions relative to each other; momentum and spin stay as they are, vibrations end.
	void becomeRigid();
	/// Sets the nodes' positions and velocities to those of the rigid motion. Only for rigid bodies.
	void moveAsRigid( const RigidMotion& motion );
	/// Sets the motion that the nodes will have from the next moveAsRigid on, m/s and rad/s. Only for rigid bodies.
	void setRigidVelocities( const Vec3d& linear, const Vec3d& angular );
	/// After the nodes' velocities were changed: the rigid motion takes their momentum and spin, and the nodes its velocities. Does nothing
	/// to a body that deforms.
	void followVelocities();
	/// v += h ( gravity + field / m ), m/s^2 and N. Only for rigid bodies.
	void applyRigidForces( float h, const Vec3d& gravity );
	/// Nodes keep positions and velocities.
	void becomeDeformable();
	/// The smaller of Material::rigidStrain and a part of the strain at which the weakest link breaks.
	double largestInvisibleStrain() const;
	/// Of a vibration or an approach that strains the body by as much, m/s. `breaks`: or by what breaks it.
	double largestInvisibleVelocity( bool breaks = true ) const;

	// --- one substep of length h, s ---------------------------------------------------------------------------------
	/// Shape matching and damping: v += (alpha e + k de) / h, and wobble damping of v. `runner` may be null (calling thread only).
	void accelerateTowardGoals( float h, float alpha, TaskRunner* runner );
	/// v += h (gravity + f / m), after matching: before it, damping would reduce the forces that hold a loaded body in shape. Forces f are
	/// not cleared (the world does so once per game step).
	void applyForces( float h, const Vec3& gravity, TaskRunner* runner = nullptr );

	// The implicit substep (docs/design/implicit.md) replaces these two: pushImplicitly, [contacts, linear solve], integrate.
	/// True where the body's regions can be linearised: Method::Lattice with conserving weights and no far levels.
	bool canStepImplicitly() const;
	/// Returns true if nothing in it deforms: a single node, or a small piece of SmallPieces::Rigid.
	bool isInelastic() const;
	/// The same with the reason.
	Status implicitStatus() const;
	/// Upper bound of the ratio of the stiffness of any region to the nominal one (link_moments.h).
	float largestRegionFraction() const;
	/// Prepares `implicit()`; leaves the nodes with their velocities of free flight. `alpha` may have any size.
	void pushImplicitly( float h, float alpha, const Vec3& gravity, TaskRunner* runner );
	/// Numerical damping of the implicit substeps from now on, [0, 1]; without a value that of the material, as at first.
	void dampNumerically( std::optional<float> damping ) { m_numericalDamping = damping; }
	float numericalDamping() const { return m_numericalDamping.value_or( m_material.numericalDamping ); }
	/// Whether the body turns about an axis across `up`, a unit vector, from 0 (it rocks at rest, is held or in several parts) to 1.
	double turnFreedom( const Vec3d& up ) const;
	/// Until the next call 1 - `rolling`, [0, 1], of the material's wobble damping acts: the strain of a rolling body is at rest in space
	/// and turns in its material, which the damping takes for a vibration.
	void rollFreely( double rolling ) { m_rolling = rolling; }
	/// For a body with forces applied: it takes part in other bodies' system with its masses only, as a whole.
	ImplicitMotion& joinFreely();
	/// The same with the nodes that will be added.
	TouchedNodes& joinByContacts();
	/// For a body that wakes between its forces and its contacts: it joins by contacts, from its present velocities.
	void joinAtRest() { keepVelocities( nullptr ); }
	/// Measures the rigid motions of such a body, in `implicit()`.
	ImplicitMotion& measureRigidMotions();
	/// Null before the first call of pushImplicitly, joinFreely or measureRigidMotions.
	ImplicitMotion* implicit() { return m_implicit.get(); }
	/// Velocities at the start of the substep.
	const Vec3Array& velocityBefore() const { return m_velocityBefore; }

	// Nodes that are drawn toward velocities (node_pull.h): set before the substep, of the present nodes.
	NodePull& pull() { return m_pull; }
	/// Of an explicit body, after applyForces. An implicit body's are part of its system.
	void applyPull();
	/// The impulse and angular impulse about the origin of the world that the nodes have got with their present velocities, N s and N m s.
	void pullImpulse( Vec3d& linear, Vec3d& angular ) const;

	/// Of an implicit body, before integrate: parts that rotate go along arcs; with contacts only fast ones of bodies that can break.
	void bendToArcs( float h, bool isTouched );
	/// Of an implicit body on levels, before integrate: the rotation by which turnFrame() turns the regions' frame after it. Cells under
	/// coarse nodes of one layer lie across it as their region does, whose rotation was fitted before.
	void noteFrameTurn( float h );
	void turnFrame();
	/// x += h v   (Ohta et al. 2009, eq. 4); the origin follows when the body moves away from it. Checks every number: see BodyHealth.
	BodyHealth integrate( float h, TaskRunner* runner = nullptr );
	/// Velocity bounds of all nodes after their forces are applied, m/s.
	const VelocityBounds& velocities() const { return m_velocities; }
	/// Sums over all nodes after `integrate`; positions relative to `NodeState::origin`.
	const MotionSums& motion() const { return m_motion; }
	/// The same from the current nodes (`sums`): the reference implementation.
	MotionSums measureMotion() const;

	// --- measures ---------------------------------------------------------------------------------------------------
	BodySums sums() const;
	/// The inertia of all nodes as mass points about a point relative to `NodeState::origin`, kg m^2.
	Eigen::Matrix3d inertiaAbout( const Vec3d& point ) const;
	/// The inverse of that about the mass centre, with a least inertia about any axis; zero for nodes in one point.
	Eigen::Matrix3d inverseInertia( const BodySums& whole ) const;
	/// The spin over the inertia of all nodes as mass points, rad/s; zero about an axis on which all nodes lie.
	Vec3d angularVelocity() const;
	/// The same for another spin about the mass centre, kg m^2/s.
	Vec3d angularVelocityOf( const Vec3d& spin ) const;
	/// The largest rate at which a link between two nodes changes its length, in rest lengths, 1/s. May return 0 where none exceeds
	/// `least`.
	double stretchRate( double least ) const;
	/// The rigid motion that fits the body best (mass centre in world coordinates, rotation of all nodes together). `guess`: the rotation
	/// where the nodes leave it undetermined (few of them, or collinear ones).
	Placement bestFit( const Eigen::Quaterniond& guess = Eigen::Quaterniond::Identity() ) const;
	/// Unit quaternions (x, y, z, w) of the rotation of each node's own region from rest to the current shape. 4 floats per node.
	void nodeRotations( float* quaternions ) const;
	/// Whether rest shapes have flowed, and each node's plastic stretch, 9 floats per node, row-major: the goals of its region are R S_p.
	bool hasFlowed() const;
	void nodeFlow( float* stretches ) const;

	// --- saving (body/state/): one description writes and reads --------------------------------------------------------
	/// The data of a template that its bodies share.
	struct Shared
	{
		std::shared_ptr<const Lattice> lattice;
		std::shared_ptr<TemplateCache> cache;
	};
	/// Writes or reads what the body is made of: settings, levels, and for a broken body its lattice and tables. Two bodies with equal
	/// bytes here can read each other's state.
	void archiveMake( Archive& archive, const Shared& shared );
	/// Writes or reads all that changes from step to step.
	void archiveState( Archive& archive );
	/// A body with nothing in it, for archiveMake and then archiveState to read into.
	static std::unique_ptr<Body> blank() { return std::unique_ptr<Body>( new Body ); }

private:
	Body();
	Body( Body&& ) noexcept;
	void archiveLevels( Archive& archive, const Shared& shared, bool isWhole );
	void archiveMatcher( Archive& archive, bool isWhole );
	void addEnergyDebt( const LevelEnergy& added );
	void reduceEnergyDebt( float h, float alpha );
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
	void noteCoarseOverloads();
	CellPositions testedPositions();
	void findBroken( float h, bool isCool );
	std::vector<CellLink> brokenLinks() const;
	bool isSmall( const std::vector<std::uint32_t>& cells ) const { return int( cells.size() ) <= m_fracture.smallCells; }
	bool makesRigid() const;
	void addNodesOfRigidPieces( std::vector<std::uint32_t>& nodes ) const;
	void removeSmall( std::vector<std::vector<std::uint32_t>>& parts, BreakReport& report ) const;
	std::vector<std::uint32_t> nodesAboveBroken() const;
	double energyOf( const std::vector<CellLink>& links ) const; ///< J, in the present positions
	BreakReport reportOn( const std::vector<CellLink>& broken ) const;
	std::unique_ptr<Body> makePiece( std::shared_ptr<const Lattice> lattice, BodyPiece& piece, PieceBuild build ) const;
	std::unique_ptr<Body> relinkWhole( const std::shared_ptr<const Lattice>& lattice, BodyPiece& piece );
	PieceOfLevels pieceOfLevels( const Body& from, const BodyPiece& piece, PieceBuild build ) const;
	void inheritLevels( const Body& from, BodyPiece& piece, PieceBuild build );
	LinkLimits limitsOf( const Breaking& from, const BodyPiece& piece ) const;
	void inheritNodes( const Body& from, const BodyPiece& piece );
	void inheritBreaking( const Breaking& from, const BodyPiece& piece );
	void reserveMotionScratch();
	void includePulled();
	void keepVelocities( TaskRunner* runner );
	double speedOfSound() const; ///< sqrt( E / rho ), m/s
	/// The strain of links as a fraction: root mean square, largest, and largest extension of those that can break. `hasFold`: whether a
	/// link has kFoldedStretch or kFoldedSquash; not with levels.
	struct StrainSize
	{
		double mean = 0.0, largest = 0.0, ofBreakable = 0.0;
		bool hasFold = false;
	};
	StrainSize strainSize() const;
	/// Whether every node's velocity differs from the rigid motion by less than a velocity that strains the body by `limit`.
	bool vibratesLess( double limit ) const;
	/// Whether some of it is strained by more than `largestInvisibleStrain`.
	bool isBent( const StrainSize& strain ) const { return strain.largest > largestInvisibleStrain(); }
	bool isFolded( const StrainSize& strain ) const;
	/// Gives the nodes the rest shape, about their mass centre.
	void unfold( const Vec3d& centre );
	/// Whether its mean strain is invisible, and none is near to breaking it.
	bool isHardlyStrained( const StrainSize& strain ) const;
	ImplicitMotion& madeImplicit();
	PartTurn turnOf( int part, float h ) const;
	const ConnectedParts* matchedParts() const;
	void keepFiniteState();
	void restoreFiniteState();

	std::shared_ptr<const Lattice> m_lattice;
	std::shared_ptr<TemplateCache> m_cache;
	Material m_material;
	std::vector<float> m_stiffness; ///< factor of each finest cell; empty: 1 everywhere
	NodeState m_nodes;
	Vec3Array m_fieldForce;
	std::unique_ptr<Matcher> m_matcher;
	std::unique_ptr<ImplicitMotion> m_implicit; ///< null until the first implicit substep
	std::unique_ptr<TouchedNodes> m_touched;    ///< null until the first joinByContacts()
	Vec3Array m_velocityBefore;                 ///< at the start of the substep
	AlignedArray<float> m_pushed;
	NodePull m_pull;
	std::unique_ptr<Levels> m_levels;
	LatticeMatcher* m_levelMatcher = nullptr; ///< m_matcher where there are levels
	std::unique_ptr<Breaking> m_breaking;     ///< null: cannot break
	std::unique_ptr<RigidState> m_rigid;      ///< null: deforms
	Fracture m_fracture;
	std::vector<CellLink> m_cutLinks, m_healedLinks; ///< ascending
	std::vector<std::uint32_t> m_firstCell;
	int m_reviewIn = 0;                            ///< substeps until strains are measured
	float m_sinceReview = 0.0f;                    ///< s
	LevelDebt m_energyDebt;                        ///< of explicit steps
	bool m_wasImplicit = false;                    ///< in the last substep
	bool m_isBent = false;                         ///< by bendToArcs, before integrate
	std::optional<Eigen::Quaterniond> m_frameTurn; ///< of noteFrameTurn, until turnFrame
	std::optional<float> m_numericalDamping;
	double m_rolling = 0.0; ///< of rollFreely
	bool m_isOnePart = true;
	double m_secondMoment = 0.0; ///< m^2, mean over the axes, per mass
	double m_restLength = 1.0;   ///< m, longest edge of the rest shape's box
	VelocityBounds m_velocities;
	MotionSums m_motion;
	AlignedArray<float> m_lastFinite, m_positionScratch; ///< x of the last finite state, component after component; and the next
	Vec3d m_lastFiniteOrigin = Vec3d::Zero();
	double m_originLimit = 4.0; ///< m; the origin follows when node 0 is farther away than this
};

/// Whether an object of the given length, m, that turns at `turn`, rad/s, does so about an axis across `up`, from 0 (it rocks) to 1.
double turnFreedom( const Vec3d& turn, const Vec3d& up, double length );

/// Checks lattice, octree and cut; the message names the first violation.
Status validate( const Body& body );

} // namespace pliant
