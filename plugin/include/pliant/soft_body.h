#pragma once

// A soft body in a Bullet world: an ordinary btCollisionObject whose shape is a compound of node spheres.

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
using SoftBodyResult = Result<std::unique_ptr<SoftBody>>;

/// The skinned render mesh, valid until the body is next stepped. Vertex i is the input mesh's vertex i as long as nothing has broken; then
/// vertices stand for the sides of cracks, and topologyVersion says when to take the indices and texture coordinates anew. World
/// coordinates relative to `origin` (add it in your own precision; it keeps float vertices exact far from the world's centre).
struct SurfaceView
{
	btVector3 origin;                 ///< world position the vertices are relative to, m
	const float* positions = nullptr; ///< 3 floats a vertex, m
	const float* normals = nullptr;   ///< 3 floats a vertex, unit length
	const std::uint32_t* indices = nullptr;
	/// 2 floats a vertex; null when the mesh had none and nothing has broken.
	const float* textureCoordinates = nullptr;
	/// Of each triangle: the input's triangle it is a piece of, or kInside for the face of a crack. Null: triangle i is the input's
	/// triangle i.
	const std::uint32_t* triangleSource = nullptr;
	static constexpr std::uint32_t kInside = 0xffffffffu;
	int vertexCount = 0;
	int triangleCount = 0;
	unsigned topologyVersion = 0; ///< changes when indices or counts change
	/// What has to be uploaded again where the version that was uploaded is `changedSince`: vertices from firstNewVertex on, triangles from
	/// firstNewTriangle on, and triangles firstChangedTriangle .. lastChangedTriangle - 1. Everything, where another version was.
	unsigned changedSince = 0;
	int firstNewVertex = 0, firstNewTriangle = 0, firstChangedTriangle = 0, lastChangedTriangle = 0;
	unsigned frame = 0; ///< changes when positions change
};

/// A soft body. The game owns what it creates; the world never deletes it. Material settings that Bullet knows are set as on any
/// btCollisionObject: setFriction, setRestitution, setRollingFriction, setCollisionFlags, setUserPointer, setActivationState. Without
/// restitution too a stiff body comes back by its elasticity. Bullet's contact points hold the impulses of the whole game step.
class PLIANT_API SoftBody : public btCollisionObject
{
public:
	BT_DECLARE_ALIGNED_ALLOCATOR();

	/// What getInternalType() says of a soft body, a bit of its own: tests for other types (`& CO_RIGID_BODY`, `& ( CO_USER_TYPE + 1 )`) do
	/// not match it.
	static constexpr int kInternalType = 1 << 16;

	/// Place the template's mass centre at transform applied to the template's mesh (mesh coordinates go through `transform`). Refused
	/// (BadArgument) where the transform scales, shears or mirrors by more than a hundredth: scale the mesh.
	static SoftBodyResult create( std::shared_ptr<const BodyTemplate> bodyTemplate, const btTransform& transform,
		const Material& material = {}, const Adaptivity& adaptivity = {}, const StiffnessField& stiffness = {} );
	~SoftBody() override;

	/// The soft body behind any collision object: itself, or one of its node bodies as named by a manifold. Null for others.
	static SoftBody* upcast( btCollisionObject* object );
	static const SoftBody* upcast( const btCollisionObject* object );

	// --- nodes: 0 to nodeCount() - 1. Of a node that is not there: zeros, and in a build with assertions the end of the program ------
	int nodeCount() const;
	btVector3 nodePosition( int node ) const; ///< world, m
	btVector3 nodeVelocity( int node ) const; ///< m/s
	btScalar nodeMass( int node ) const;      ///< kg
	btScalar nodeRadius( int node ) const;    ///< of the collision sphere, m
	/// The node behind a child shape's index, as ray, sweep and contact tests report it; -1 when there is none.
	/// Node spheres stand for the surface and one layer below; contact points carry the node's own number.
	int nodeOfShapeIndex( int shapeIndex ) const;
	/// Nearest node to a world point; -1 never (a body has nodes). With levels of detail: the one whose sphere is nearest.
	int nearestNode( const btVector3& worldPoint ) const;

	btScalar mass() const;             ///< kg
	btVector3 massCentre() const;      ///< world, m
	btVector3 linearVelocity() const;  ///< of the mass centre, m/s
	btVector3 angularMomentum() const; ///< about the mass centre, kg m^2/s
	/// The rigid motion that fits the deformed body best; maps mesh coordinates to the world.
	btTransform bestFitTransform() const;

	// --- levels of detail (Adaptivity); without them every node is on level 0 and none of this changes anything --------
	/// 0: a finest cell; l: up to 8^l of them.
	int nodeLevel( int node ) const;
	/// The node that holds a finest cell of the template; cells without levels are nodes. -1 where there is no such cell, or another piece
	/// has it.
	int nodeOfCell( int cell ) const;
	/// Changes when nodes are split or merged: nodes then have other numbers. Pins follow.
	unsigned levelVersion() const;
	/// Splits all nodes that reach into a world box, level by level, as the budget allows, and keeps them for Adaptivity::mergeDelay: call
	/// it as long as they are wanted. Wakes nothing.
	void requestRefinement( const btVector3& low, const btVector3& high );
	/// Nothing finer than this level is used from now on, 0 to Adaptivity::coarseLevels; finer nodes are merged. For bodies far from view.
	void setFinestLevel( int level );

	// --- breaking: Fracture. Off by default; pieces take their body's settings over -----------------------------------
	/// Whether and how links between cells break. `toughness` is asked once for every link.
	Status setFracture( const Fracture& fracture, const ToughnessField& toughness = {} );
	/// What was set; BreakRule::Never when nothing was.
	Fracture fracture() const;
	/// Makes now what the first crack of a body makes, the most of what it costs: what bodies of one template share until then, and of one
	/// that is drawn its inside and all that cracks are drawn with. Takes a cracked body's memory. Before setFracture or a cut or after, of
	/// a whole body; nothing looks otherwise for it.
	Status prepareCracks();
	/// Finest cells of this body; nodes without levels of detail.
	int cellCount() const;
	/// Links between them that stand, each counted once.
	int linkCount() const;
	/// Changes when links have broken: nodes and cells then have other numbers. Pins follow.
	unsigned fractureVersion() const;

	// --- cutting: also bodies whose rule is Never. Links between cells are cut where the straight line between the cells' middles, as they
	// --- are now, goes through the cut; they part at the start of the next substep, and what comes off is a fragment like any other. Each
	// --- returns the number of links that were not cut already, and wakes the body if there are any; 0 too where a
	// --- number is bad or memory does not suffice.
	/// By a plane, or a disc of it about `point`. A middle in the plane is on the side `normal` points to.
	int cutPlane( const btVector3& point, const btVector3& normal, btScalar radius = SIMD_INFINITY );
	/// By the surface of a sphere.
	int cutSphere( const btVector3& centre, btScalar radius );
	/// By a blade whose edge has gone from p0 p1 to q0 q1: the triangles p0 p1 q0 and q0 p1 q1.
	int cutSweep( const btVector3& p0, const btVector3& p1, const btVector3& q0, const btVector3& q1 );
	/// The inverse: puts back links the template has, that were cut or broke, between cells of this one body that are now within `reach`
	/// times their distance at rest. From the next substep on; returns how many. Toughness of healed links is 1.
	int heal( btScalar reach = btScalar( 1.2 ) );
	/// SmallPieces::Fade: 1 when it has just come off, 0 when its time is up; 1 for all others.
	float fadeFraction() const;

	// --- what the game does to it; each wakes the body. Refused (BadArgument, and nothing is changed) where a number is NaN or infinite, a
	// node is
	// --- not there, or a node would pass 1e5 m/s: by velocities and impulses at once, by forces and gravity within a sixtieth of a second.
	Status setLinearVelocity( const btVector3& velocity );                     ///< of every node, m/s
	Status setVelocities( const btVector3& linear, const btVector3& angular ); ///< rigid motion about the mass centre, m/s and rad/s
	Status applyCentralForce( const btVector3& force );                        ///< N, spread by mass, until the step's end
	Status applyForce( const btVector3& force, int node );                     ///< N, on one node, until the step's end
	Status applyCentralImpulse( const btVector3& impulse );                    ///< N s
	Status applyImpulse( const btVector3& impulse, int node );                 ///< N s, on one node
	/// Overrides the world's gravity for this body, m/s^2; `clearGravity` goes back to the world's.
	Status setGravity( const btVector3& gravity );
	void clearGravity();
	/// Moves the whole body by a rigid transform, deformation kept; velocities turn along. Wakes what the body touches. Refused
	/// (BadArgument, the body stays) where a number is not finite, the way leads further out than 1e9 m, or the transform scales, shears or
	/// mirrors by more than a hundredth.
	Status teleport( const btTransform& by );
	/// Back to the rest shape at `transform`, at rest. Wakes what the body touches. Refused as teleport.
	Status reset( const btTransform& transform );

	/// Whether the body's own parts collide, sides of cuts among them; off by default, and then nothing is kept or done for it. Nodes that
	/// shape matching holds together never do. Pieces that come off take it over. Steinemann et al. 2008, section 7.
	void setSelfCollision( bool isOn );
	bool selfCollision() const;

	/// At any time; nodes and speeds stay as they are. Another method or other regions (weights, beta, half-width, `farLevels`,
	/// `volumeKeeping`) forget what has flowed, and are refused where the body has levels.
	Status setMaterial( const Material& material );
	const Material& material() const;
	/// Whether the last step was the implicit one (Material::elasticity).
	bool stepsImplicitly() const;
	/// Ok where this body can take the implicit step; else the reason why it steps explicitly.
	Status implicitStatus() const;
	/// What the last step could reach of the material's stiffness.
	const StiffnessPlan& stiffnessPlan() const;

	// --- pins -------------------------------------------------------------------------------------------------------
	/// Holds a node where it is. A pinned node stays until it is released.
	Status pinNode( int node );
	/// Ties a node to a rigid body: it follows the body's motion (one way; the rigid body does not feel it). The rigid body must be in a
	/// world, and in this body's where that is in one; else BadArgument. The pin is released when the rigid body leaves that world, by
	/// whatever call, and when this body is added to a world that the rigid body is not in.
	Status pinNodeToBody( int node, btRigidBody* body );
	/// The game moves the node: it reaches `worldPosition` at the end of the next step. Refused (BadArgument) where that is not finite or
	/// further from the node than a hundred times the body's size, 833 m at most.
	Status driveNode( int node, const btVector3& worldPosition );
	/// Nothing for a node that is not pinned.
	void releaseNode( int node );
	/// Pins every node whose middle is inside a world box; returns how many. A node of a body with levels is pinned as a whole: where the
	/// box is to hold to the cell, let `requestRefinement` split what is in it, and pin after the next step.
	int pinNodesInside( const btVector3& low, const btVector3& high );
	bool isPinned( int node ) const;

	// --- out --------------------------------------------------------------------------------------------------------
	/// Skins now if the body has moved since; a later step writes to the other buffer, so a render thread may read on until
	/// the step after next. Empty when the template was built with Skinning::None. From one thread at a time for all bodies of a world, and
	/// not during a step: the first call after one draws, on the world's threads, all bodies that were asked for after the last.
	SurfaceView surface() const;

	/// How far, in finest cells, a vertex may be from where skinning it anew would put it. A body whose nodes have moved as one rigid body,
	/// to within that, since it was skinned last has that skin turned and shifted; one that has not moved keeps its view, and
	/// SurfaceView::frame. It is measured against what was skinned last, however often it was turned since: many small moves do not add up.
	/// 0: always skinned anew when it has moved. Default 0.01; below 0 or not a number is taken for 0. Pieces that come off take it over.
	/// Bodies of 1 024 nodes or more and fewer than four vertices a node have no use of it.
	void setSurfaceTolerance( btScalar cells );
	btScalar surfaceTolerance() const;

	/// False once a number in the body stopped being finite: it stands at its last finite state until `reset`.
	bool isHealthy() const;
	const BodyTemplate& bodyTemplate() const;

	struct Impl;
	/// Private to Pliant's own sources.
	Impl& impl() { return *m_impl; }
	const Impl& impl() const { return *m_impl; }

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
