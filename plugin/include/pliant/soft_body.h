#pragma once

// A soft body in a Bullet world: a btCollisionObject whose shape is its drawn surface; contacts are those of its nodes.

#include "pliant/adaptivity.h"
#include "pliant/body_template.h"
#include "pliant/export.h"
#include "pliant/fracture.h"
#include "pliant/material.h"
#include "pliant/result.h"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <LinearMath/btTransform.h>
#include <LinearMath/btVector3.h>

#include <memory>

class btRigidBody;

namespace pliant {

class SoftBody;
struct Gas;
struct GpuSurfaceView;
using SoftBodyResult = Result<std::unique_ptr<SoftBody>>;

/// The skinned render mesh of a body. Until something has broken, vertex i is the input mesh's vertex i. Cracks give it other vertices and
/// triangles (vertexSources): when topologyVersion changes, all but positions has to be read again. Pointers: see SoftBody::surface.
struct SurfaceView
{
	btVector3 origin; ///< world position that the vertices are relative to, m. Keeps float vertices exact far from the world's origin.
	const float* positions = nullptr;       ///< 3 floats per vertex, m, relative to `origin`, along the world's axes
	const float* normals = nullptr;         ///< 3 floats per vertex, unit length
	const std::uint32_t* indices = nullptr; ///< 3 per triangle
	/// 2 floats per vertex; null when the input mesh had none and nothing has broken.
	const float* textureCoordinates = nullptr;
	/// For each triangle the index of the input triangle that it is part of, or kInside for a crack face. Null: triangle i is the input's
	/// triangle i.
	const std::uint32_t* triangleSource = nullptr;
	/// Value of triangleSource for a triangle of a crack face.
	static constexpr std::uint32_t kInside = 0xffffffffu;
	int vertexCount = 0;          ///< vertices in `positions` and `normals`
	int triangleCount = 0;        ///< triangles in `indices`
	unsigned topologyVersion = 0; ///< changes when indices or counts change
	unsigned frame = 0;           ///< changes when positions change
};

/// A soft body. The game owns the bodies that it creates; the world never deletes them. Contact properties and flags are set as on any
/// btCollisionObject: setFriction, setRestitution, setRollingFriction, setCollisionFlags, setUserPointer, setActivationState. A stiff body
/// rebounds by its elasticity even with restitution 0. Bullet's contact points hold the impulses of the whole game step. In the
/// following a bad number is NaN or infinite. Calls that change the body wake it unless noted otherwise; a refused call changes nothing.
class PLIANT_API SoftBody : public btCollisionObject
{
public:
	BT_DECLARE_ALIGNED_ALLOCATOR();

	/// Value of getInternalType(), a bit that Bullet does not use: tests for other types (`& CO_RIGID_BODY`, `& ( CO_USER_TYPE + 1 )`) do
	/// not match it.
	static constexpr int kInternalType = 1 << 16;

	/// Creates a body at rest in the undeformed shape; `transform` maps mesh coordinates to the world. Errors: BadArgument for a null
	/// template, for a transform with a bad number, that leads further out than 1e9 m or that scales, shears or mirrors by more than 1 %
	/// (scale the mesh instead), or for a bad `stiffness`; BadMaterial; BadSettings for `adaptivity`, also where it has levels and the
	/// material does not allow them; OutOfMemory.
	static SoftBodyResult create( std::shared_ptr<const BodyTemplate> bodyTemplate, const btTransform& transform,
		const Material& material = {}, const Adaptivity& adaptivity = {}, const StiffnessField& stiffness = {} );
	~SoftBody() override;

	/// The soft body that a collision object is, or whose node it represents in a manifold. Null for other objects and for null.
	[[nodiscard]] static SoftBody* upcast( btCollisionObject* object );
	/// The same for const objects.
	[[nodiscard]] static const SoftBody* upcast( const btCollisionObject* object );

	// --- nodes, 0 to nodeCount() - 1. For an index out of range: an assertion; without assertions zero ---------------------------------
	/// Number of nodes, at least 1. Changes with levels of detail and when the body breaks (levelVersion, fractureVersion).
	[[nodiscard]] int nodeCount() const;
	[[nodiscard]] btVector3 nodePosition( int node ) const; ///< world, m
	[[nodiscard]] btVector3 nodeVelocity( int node ) const; ///< m/s
	[[nodiscard]] btScalar nodeMass( int node ) const;      ///< kg
	[[nodiscard]] btScalar nodeRadius( int node ) const;    ///< of the collision sphere, m
	/// The node of the index that ray, sweep and contact tests report, the colliding one nearest to where they meet the surface; -1 for an
	/// index out of range. Only nodes of the surface and of one layer below it collide. Contact points hold the node's index instead.
	[[nodiscard]] int nodeOfShapeIndex( int shapeIndex ) const;
	/// The node nearest to a world position, m; with levels of detail the one whose sphere is nearest. Never -1: every body has a node.
	/// Node 0 for bad numbers.
	[[nodiscard]] int nearestNode( const btVector3& worldPoint ) const;

	[[nodiscard]] btScalar mass() const;             ///< kg
	[[nodiscard]] btVector3 massCentre() const;      ///< world, m
	[[nodiscard]] btVector3 linearVelocity() const;  ///< of the centre of mass, m/s
	[[nodiscard]] btVector3 angularMomentum() const; ///< about the centre of mass, kg m^2/s
	/// Of the rigid part of the motion, rad/s: that of a rigid body with these nodes and the same angular momentum. Nearly collinear nodes
	/// have no spin about their axis; a body of one node has none.
	[[nodiscard]] btVector3 angularVelocity() const;
	/// The rigid transform that fits the deformed body best; maps mesh coordinates to the world.
	[[nodiscard]] btTransform bestFitTransform() const;

	// --- levels of detail (Adaptivity); without them every node is on level 0 and the functions that change levels do nothing ---------
	/// The settings given to `create`; for a body without levels of detail the default ones, with coarseLevels 0.
	[[nodiscard]] Adaptivity adaptivity() const;
	/// Level of a node: 0 for a finest cell; a node of level l holds up to 8^l cells.
	[[nodiscard]] int nodeLevel( int node ) const;
	/// The node that holds a finest cell of the template (without levels of detail each cell is a node). -1 for an index out of range or a
	/// cell of another piece.
	[[nodiscard]] int nodeOfCell( int cell ) const;
	/// The inverse: the finest cell of the template that a node stands for; for a node of several cells the one of them with the lowest
	/// number. -1 for an index out of range.
	[[nodiscard]] int cellOfNode( int node ) const;
	/// Changes when nodes are split or merged, which renumbers the nodes. Pins are kept.
	[[nodiscard]] unsigned levelVersion() const;
	/// Splits all nodes that overlap a world box (corners, m), level by level within the budget Adaptivity::nodesPerStep, and keeps them
	/// split for Adaptivity::mergeDelay; call it as long as the detail is needed. Does not wake the body. Ignored for bad numbers.
	void requestRefinement( const btVector3& low, const btVector3& high );
	/// Sets the finest level in use, 0 to Adaptivity::coarseLevels (clamped); finer nodes are merged. For bodies far from the viewer.
	void setFinestLevel( int level );
	/// The level last set; 0: all levels may be used. Default.
	[[nodiscard]] int finestLevel() const;

	// --- breaking (Fracture); off by default; pieces inherit the settings of their body -----------------------------------------------
	/// Sets whether and how links between cells break. `toughness` is called once for every link; `centres` are for BreakRule::Shards and
	/// not looked at by others. Errors: BadSettings for settings out of range and for another method than Method::Lattice; BadArgument for
	/// a toughness not above 0 and for bad centres; OutOfMemory. A build without Feature::Fracture ignores settings with BreakRule::Never
	/// and refuses all others (BadArgument).
	Status setFracture( const Fracture& fracture, const ToughnessField& toughness = {}, const ShardCentres& centres = {} );
	/// The settings of the last setFracture; BreakRule::Never when there was none.
	[[nodiscard]] Fracture fracture() const;
	/// Computes in advance the data for the first crack of a body, which is most of its cost: data that bodies of one template share until
	/// then and, for a drawn body, the crack faces. Takes the memory of a cracked body. For whole bodies, after setFracture, whose rule it
	/// prepares for; changes nothing visible. Errors: OutOfMemory; BadArgument in a build without Feature::Fracture or Feature::Surface.
	Status prepareCracks();
	/// Number of finest cells of this body; equals the number of nodes without levels of detail.
	[[nodiscard]] int cellCount() const;
	/// Number of unbroken links between them, each counted once.
	[[nodiscard]] int linkCount() const;
	/// Changes when links break, which renumbers nodes and cells. Pins are kept.
	[[nodiscard]] unsigned fractureVersion() const;

	// --- cutting, also of bodies whose rule is Never. A link is cut where the straight line between the current positions of its two cells
	// --- crosses the cut. Parts separate at the start of the next substep and become fragments like any other. All return the number of
	// --- links that were newly cut, and wake the body if there are any; 0 for bad numbers, when out of memory, and in a build without
	// --- Feature::Fracture. World coordinates, m.
	/// Cuts by a plane, or by a disc about `point`. `normal` of any length above 0; a cell in the plane counts as on the side that it
	/// points to.
	int cutPlane( const btVector3& point, const btVector3& normal, btScalar radius = SIMD_INFINITY );
	/// Cuts by the surface of a sphere.
	int cutSphere( const btVector3& centre, btScalar radius );
	/// Cuts by a blade whose edge moves from p0 p1 to q0 q1: by the triangles p0 p1 q0 and q0 p1 q1.
	int cutSweep( const btVector3& p0, const btVector3& p1, const btVector3& q0, const btVector3& q1 );
	/// The inverse: restores cut or broken links of the template between cells of this body that are at most `reach` times their rest
	/// distance apart, from the next substep on. Returns their number. Restored links have toughness 1.
	int heal( btScalar reach = btScalar( 1.2 ) );
	/// SmallPieces::Fade and DebrisBudget: falls from 1 when the piece separates, or when it is found to be over the budget, to 0 when its
	/// time is up. 1 for all other bodies.
	[[nodiscard]] float fadeFraction() const;
	/// Whether the world's DebrisBudget leaves the body alone; its pieces inherit it. Default false.
	void setKept( bool isKept );
	/// The value last set.
	[[nodiscard]] bool isKept() const;

	// --- motion. Refused with BadArgument: bad numbers, a node index out of range, and values that would make a node faster than 1e5 m/s
	// --- along an axis: directly by velocities and impulses, within 1/60 s by forces and gravity.
	Status setLinearVelocity( const btVector3& velocity );                     ///< of every node, m/s
	Status setVelocities( const btVector3& linear, const btVector3& angular ); ///< rigid motion about the centre of mass, m/s and rad/s
	Status applyCentralForce( const btVector3& force );                        ///< N, distributed by mass, until the end of the step
	Status applyForce( const btVector3& force, int node );                     ///< N, on one node, until the end of the step
	Status applyCentralImpulse( const btVector3& impulse );                    ///< N s, distributed by mass
	Status applyImpulse( const btVector3& impulse, int node );                 ///< N s, on one node
	/// Replaces the world's gravity for this body, m/s^2; `clearGravity` restores the world's.
	Status setGravity( const btVector3& gravity );
	/// The gravity that acts on the body, m/s^2: its own where one was set, else the world's; zero for a body without its own in no world.
	[[nodiscard]] btVector3 gravity() const;
	/// Whether setGravity has set one.
	[[nodiscard]] bool hasOwnGravity() const;
	/// Restores the world's gravity. Wakes the body.
	void clearGravity();
	/// Fills the closed cavities of a hollow body with gas (pliant/game/forces.h). The gas is gone once a crack opens the cavity; pieces
	/// keep theirs. Errors: BadSettings; BadArgument for a body without a cavity.
	Status setGas( const Gas& gas );
	/// The gas last set; GasLaw::None when there was none.
	[[nodiscard]] Gas gas() const;
	/// Gauge pressure of a cavity in the last step, Pa; 0 for a cavity that does not exist. Cavities count from 0.
	[[nodiscard]] btScalar gasPressure( int cavity = 0 ) const;
	/// The volume of a cavity with gas, m^3; 0 for a cavity that is not there. Not during a step.
	[[nodiscard]] btScalar gasVolume( int cavity = 0 ) const;

	/// Whether the world collects ContactEvents of this body. Default off, at no cost. Pieces inherit the setting.
	void setContactEvents( bool isOn );
	/// Whether it does.
	[[nodiscard]] bool contactEvents() const;

	/// Moves the whole body by a rigid transform; keeps its deformation and rotates its velocities. Wakes the objects that the body
	/// touches. Refused (BadArgument) if the transform holds a bad number, if it or the body's new position is farther than 1e9 m from the
	/// origin, or if it scales, shears or mirrors by more than 1 %.
	Status teleport( const btTransform& by );
	/// Returns the body to its rest shape, at rest; `transform` maps mesh coordinates to the world. Wakes the objects that the body
	/// touches. Ends quarantine (isHealthy). Refused as by teleport.
	Status reset( const btTransform& transform );

	/// Grows or shrinks the body to `scale` times the size of its template, 1e-3 to 1e3: rest shape, spheres, masses by density (times
	/// scale^3). Nodes move from or to the mass centre, velocities stay. Small steps let contacts follow. Copies the template each time.
	/// Errors: BadArgument for a scale out of range, for another method than Method::Lattice, with Material::farLevels, and for bodies with
	/// levels of detail or that have broken; OutOfMemory.
	Status setScale( btScalar scale );
	/// The scale last set; default 1.
	[[nodiscard]] btScalar scale() const;

	/// Whether the parts of the body collide with each other, sides of cuts included. Default off, at no cost. Nodes of one region never
	/// collide. Pieces inherit the setting. Steinemann et al. 2008, section 7. Errors: BadArgument in a build without
	/// Feature::SelfCollision; OutOfMemory.
	Status setSelfCollision( bool isOn );
	/// Whether they do.
	[[nodiscard]] bool selfCollision() const;

	/// Changes the material at any time; positions and velocities stay as they are. A change of the method or of its regions (weights,
	/// beta, half-width, `farLevels`, `volumeKeeping`) discards plastic deformation, and is refused for a body with levels of detail.
	/// Errors: BadMaterial, also for another method than Method::Lattice where the body can break; BadArgument where the build lacks a
	/// feature; OutOfMemory.
	Status setMaterial( const Material& material );
	/// The material. Valid as long as the body; Material::farLevels may be fewer than were set, where the body is too small for them.
	[[nodiscard]] const Material& material() const;
	/// Whether the body is in its rigid state (Material::rigidStrain): it does not deform now.
	[[nodiscard]] bool isRigid() const;
	/// Whether the last step was the implicit one (Material::elasticity).
	[[nodiscard]] bool stepsImplicitly() const;
	/// Ok where this body can take the implicit step; else BadMaterial or BadArgument with the reason.
	Status implicitStatus() const;
	/// The stiffness that the last step reached.
	[[nodiscard]] const StiffnessPlan& stiffnessPlan() const;

	// --- pins: nodes that forces do not move. Errors: BadArgument -----------------------------------------------------------------------
	/// Holds a node at its current position until it is released.
	Status pinNode( int node );
	/// Attaches a node to a rigid body, whose motion it follows without a reaction on the rigid body. The rigid body must be in a world,
	/// and in this body's world if that is in one. The pin is released when the rigid body leaves that world, by any call, and when this
	/// body is added to a world that the rigid body is not in.
	Status pinNodeToBody( int node, btRigidBody* body );
	/// Moves a node so that it reaches `worldPosition`, m, at the end of the next step. Refused for a bad number and where the position is
	/// further from the node than a hundred times the body's size or 833 m.
	Status driveNode( int node, const btVector3& worldPosition );
	/// Ignored for a node that is not pinned.
	void releaseNode( int node );
	/// Pins every node whose position is inside a world box (corners, m); returns their number. A node of a body with levels of detail is
	/// pinned as a whole: for a pin exact to the cell, call `requestRefinement` for the box and pin after the next step. 0 for bad numbers.
	int pinNodesInside( const btVector3& low, const btVector3& high );
	/// Whether a node is pinned by any of these calls; false for an index out of range.
	[[nodiscard]] bool isPinned( int node ) const;

	// --- rendering --------------------------------------------------------------------------------------------------------------------
	/// Returns the skin, after computing it if the body has moved. Results are written to alternating buffers, so the pointers stay valid
	/// until the step after next: a render thread may go on reading. Empty with Skinning::None. Call it from one thread at a time for all
	/// bodies of a world, and not during a step. The first call after a step also skins, on the world's threads, all bodies whose surface
	/// was requested after the previous step.
	SurfaceView surface() const;

	/// The same skin as tables, which change only when something breaks or levels change, and node transforms for each frame: for a
	/// renderer that skins on the GPU (pliant/render/gpu_surface.h). Bodies read by this call alone are not skinned on the CPU. Pointers
	/// stay valid until the next step or the next call for this body. Empty with Skinning::None. To be called as `surface` is.
	GpuSurfaceView gpuSurface() const;

	/// Whether the drawn skin lies between the last two steps, by the time that stepSimulation has left over
	/// (SoftBodyHost::interpolationFraction), as that of Bullet's motion states does: for games that draw more often than they step.
	/// Applies to `surface` and `gpuSurface`, not to positions and contacts. Pieces inherit it. A body that is teleported, reset, asleep,
	/// static or kinematic is drawn where it is. Default off, at no cost. Does not wake the body.
	void setInterpolation( bool isOn );
	/// Whether it does.
	[[nodiscard]] bool interpolation() const;

	/// Sets the largest error of a reused skin, in finest cells. Where all nodes have moved as one rigid body since the last full skinning,
	/// up to this error, that skin is transformed rigidly; where they have not moved, the view and SurfaceView::frame stay the same. Errors
	/// do not accumulate: they are measured from the last full skinning. 0: every motion is skinned in full. Default 0.01; a negative value
	/// or a bad number counts as 0. Pieces inherit the setting. No effect without a skin, and on bodies of 1 024 or more nodes with fewer
	/// than four vertices per node.
	void setSurfaceTolerance( btScalar cells );
	/// The error last set, cells; 0 and above.
	[[nodiscard]] btScalar surfaceTolerance() const;

	/// False after a number in the body has become NaN or infinite: the body stays in its last finite state until `reset`.
	[[nodiscard]] bool isHealthy() const;
	/// The template that the body was made of; for a piece that of the body that broke. Valid as long as the body.
	[[nodiscard]] const BodyTemplate& bodyTemplate() const;

	/// @cond INTERNAL
	struct Impl;
	/// For Pliant's own sources only.
	Impl& impl() { return *m_impl; }
	const Impl& impl() const { return *m_impl; }
	/// @endcond

private:
	struct PinRequest
	{
		int node;
		int kind;
		btRigidBody* body;
		btVector3 point;
	};

	SoftBody();
	Status pin( const PinRequest& request );
	void hasMoved();
	std::unique_ptr<Impl> m_impl;
};

} // namespace pliant
