#pragma once

// The implementation of SoftBody: the core's body, the collision shape, pins, forces and skin buffers.

#include "body/body.h"
#include "body/breaking.h"
#include "pliant/soft_body.h"
#include "surface/crack_mesh/shared_crack_state.h"
#include "surface/render/skin_blend.h"
#include "surface/render/skin_tables.h"
#include "surface/render/vertex_data.h"
#include "surface/skin/rigid_skin.h"
#include "surface/skin/skin_fade.h"
#include "surface/skin/skinning.h"
#include "world/block/implicit_choice.h"
#include "world/constants.h"
#include "world/detect/node_contacts.h"
#include "world/game/contact_records.h"
#include "world/game/force_fields.h"
#include "world/joints/pose_follower.h"
#include "world/query/surface_shape.h"
#include "world/rigid/rigid_constants.h"
#include "world/rigid/rigid_proxy.h"
#include "world/shape/contact_proxy.h"
#include "world/shape/node_shape.h"
#include "world/shape/penetration_allowance.h"
#include "world/touch/contact_surface.h"

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

namespace pliant {

class Archive;
class SoftBodySystem;

enum class PinKind : int
{
	Still,
	FollowsBody,
	Driven
};

struct Pin
{
	int node = -1;
	PinKind kind = PinKind::Still;
	btRigidBody* body = nullptr;            ///< FollowsBody; in the same world as the soft body, if that is in one
	int bodyIndex = -1;                     ///< its last known index in the world's list of objects
	int bodyProxy = -1;                     ///< the id of its broadphase proxy when it was pinned
	btVector3 point = btVector3( 0, 0, 0 ); ///< FollowsBody: in the body's frame; Driven: target in the world
	bool hasTarget = false;                 ///< Driven: the target has not been reached yet
};

/// The data published by SoftBody::gpuSurface.
struct GpuSkin
{
	SkinTableStreams tables;
	bool isShown = false; ///< the tables have been made
	unsigned fractureVersion = 0, levelVersion = 0, offsetVersion = 0;
	unsigned frame = 0, mapVersion = 0; ///< SkinBuffers::mapVersion of the frame
	double fraction = 1.0;              ///< between steps, of the frame
};

/// The data for SoftBody::setInterpolation.
struct StepBlend
{
	SkinBlend kept;           ///< maps at the start of the last step
	AlignedArray<float> maps; ///< between the steps
	unsigned mapVersion = 0;  ///< that `maps` were made of
	double fraction = -1.0;   ///< of `maps`; -1: none yet
};

struct SkinBuffers
{
	/// The shown skin, the one shown before it, and for rigidly moving bodies the last fully computed one.
	static constexpr int kCount = 3;
	std::vector<float> positions[kCount], normals[kCount];
	btVector3 origin[kCount] = { btVector3( 0, 0, 0 ), btVector3( 0, 0, 0 ), btVector3( 0, 0, 0 ) };
	std::vector<float> rotations, gradients, flow;
	std::vector<float> gradientsScratch;    ///< for changes of levels
	AlignedArray<float> maps;               ///< SkinScratch::nodeMap of the shown skin
	std::unique_ptr<GpuSkin> gpu;           ///< null: never requested
	std::unique_ptr<StepBlend> blend;       ///< null: no interpolation between steps
	std::unique_ptr<VertexData> vertexData; ///< null: neither sources nor tangents were requested
	double fraction = 1.0;                  ///< between steps, of the shown skin
	SkinFade fade;                          ///< for bodies with levels
	RigidSkin rigid;
	double tolerance = kSurfaceTolerance; ///< in cells
	int current = 0;
	int full = 0; ///< index of the last fully computed skin
	unsigned frame = 0;
	unsigned requestedIn = 0; ///< the world's step after which the surface was last requested; 0: never
	bool isStale = true;
	bool areRotationsKnown = false; ///< rotations and flow are up to date
	bool isPoseKnown = false;       ///< gradients are up to date too
	bool isMapKnown = false;        ///< `maps` are up to date too
	unsigned moves = 0;             ///< counts placements of the nodes (placeSpheres)
	unsigned mapVersion = 0;        ///< counts the changes of `maps`

	/// Whether the surface has ever been read, by whichever call.
	bool isRead() const { return frame > 0 || gpu; }
	void interpolate( bool isOn ); ///< between steps
	/// The body has been moved instantaneously: nothing lies between its last two positions.
	void jumped()
	{
		nodesMoved();
		blend ? blend->kept.forget() : void();
	}
	void nodesMoved()
	{
		isStale = true;
		areRotationsKnown = isPoseKnown = isMapKnown = false;
	}
	/// Discards the data kept for rigidly moving bodies: nodes were renumbered, or the drawn surface has changed.
	void nodesChanged()
	{
		nodesMoved();
		rigid.forget();
	}
};

/// Another body that this one broke off from. Their spheres may overlap as deep as they did at that time, and no deeper.
struct SeparatedPair
{
	unsigned other; ///< serial of the other body
	double slack;   ///< allowed overlap, m; only decreases; infinity until measured

	friend bool operator<( const SeparatedPair& a, const SeparatedPair& b ) { return a.other < b.other; }
};

/// The node positions that the body's motion is measured from before it sleeps (activation.cpp).
struct RestPositions
{
	std::vector<Vec3> positions; ///< relative to `origin`, m; empty: none
	Vec3d origin = Vec3d::Zero();
	unsigned numbering = 0; ///< SoftBody::Impl::numbering of the positions
};

/// State of SmallPieces::Fade. A faded piece is removed from the world once; its owner may add it again.
struct Fading
{
	float time = 0.0f; ///< duration of the fade, s; 0: the body does not fade
	double left = 0.0; ///< remaining time, s
	bool isOver = false;
};

/// State of SoftBody::setSelfCollision.
struct SelfCollision
{
	SelfSearch search;
	std::unique_ptr<PairContacts> contacts; ///< null while the body is in no world
};

struct SoftBody::Impl
{
	std::shared_ptr<const BodyTemplate> bodyTemplate;
	std::unique_ptr<Body> body;
	std::unique_ptr<NodeShape> shape;
	std::unique_ptr<BodyShape> queried; ///< the body's collision shape as Bullet sees it
	/// Origin of the object's transform in the nodes' coordinates: the centre of mass, rounded to Bullet's precision. The shape's spheres
	/// are relative to it.
	Vec3 shapeShift = Vec3::Zero();
	double mass = 0.0;                ///< kg, of all nodes
	double meanSquareSpeed = 0.0;     ///< m^2/s^2, weighted by mass, after the last substep
	double slowTime = 0.0;            ///< time since it was last faster than kAllowanceCalm, s
	double restTime = 0.0;            ///< time since it was last faster than after a fall over its largest node, s
	bool isBroken = false;            ///< the last substep produced a number that is not finite
	bool isHit = false;               ///< asleep, and something awake touches it in this pass
	SoftBodySystem* system = nullptr; ///< of the world the body is in

	StiffnessPlan plan;
	ElasticityState elasticity;     ///< for Elasticity::Automatic
	bool isImplicit = false;        ///< takes the implicit step in this substep
	double lastSubstep = 0.0;       ///< length of the last substep, s; 0: none yet
	double gravityShare = 1.0;      ///< of gravity's impulse h m g in this substep
	int block = -1, blockPart = -1; ///< indices in this substep's implicit solution; -1: none
	bool isGuarded = false;         ///< it was fast and is near an obstacle: the tunneling guard still applies though it is slow now
	bool isHealthy = true;
	int stateBefore = ACTIVE_TAG; ///< activation state before quarantine
	bool hasOwnGravity = false;
	btVector3 gravity = btVector3( 0, 0, 0 );
	btVector3 centralForce = btVector3( 0, 0, 0 );
	bool hasNodeForces = false;
	std::unique_ptr<SurfaceForces> forces;              ///< null: none has been needed
	btVector3 fieldAcceleration = btVector3( 0, 0, 0 ); ///< the mean of force fields, m/s^2
	std::unique_ptr<ContactRecords> contactRecords;     ///< null: no contact events are requested

	std::unique_ptr<RigidProxy> rigidProxy; ///< null while the body deforms
	RigidLoad rigidLoad;
	bool mustDeform = false; ///< from the next step on; ignored without a rigid proxy
	/// Game steps until the body is tested for its rigid state. In that state: above 0 until its first contacts are found, then minus the
	/// game steps since.
	int rigidWait = kRigidStart;
	int rigidPause = kRigidPause / 2; ///< game steps for which it deformed at least when it last left its rigid state

	std::vector<Vec3d> heldBefore; ///< node positions of a static or kinematic body at the last game step, world, m

	unsigned serial = 0;       ///< unique in its world, never reused
	bool isWorldOwned = false; ///< a fragment that has not been released
	unsigned fractureVersion = 0;
	std::shared_ptr<int> family;                       ///< number of bodies from the same original body; null: it never broke
	mutable std::vector<SeparatedPair> separatedPairs; ///< ascending by serial
	mutable PenetrationAllowance allowance;            ///< updated by collision detection
	Fading fading;
	double separatedAt = 0.0;                      ///< time of the world at which the piece came off, s
	bool isKept = false;                           ///< the world's DebrisBudget leaves it alone
	double asleepTime = 0.0;                       ///< of a piece that the world owns, s
	bool isScenery = false;                        ///< it has become static (DebrisBudget::settleTime)
	bool partsWait = false;                        ///< it is in several parts that the step's budget of pieces has kept together
	std::unique_ptr<NodeShape> previousShape;      ///< contact proxies of lost nodes point to its spheres until the next collision phase
	std::shared_ptr<SharedCrackState> crackFamily; ///< null: it was not drawn when it broke, or links were healed
	std::vector<CutTrace> newCuts;                 ///< cuts whose links are to break
	std::shared_ptr<std::vector<CutTrace>> cuts;   ///< cuts of the family in the template's cells; null: none
	mutable std::unique_ptr<CrackView> crackView;  ///< null: the template's mesh is drawn as it is
	bool wasDrawn = false;                         ///< the body it broke off from was drawn
	mutable unsigned crackVersion = 0;             ///< fractureVersion shown by crackView

	std::unique_ptr<SelfCollision> self;    ///< null: no self-collision
	std::unique_ptr<PoseFollower> follower; ///< null: follows no pose
	std::vector<Pin> pins;                  ///< ascending by node
	std::vector<ContactProxy*> proxyOfNode; ///< by node; null without contacts
	mutable int partingPhases = 0;          ///< above 0: it is being separated (parting.h), without tunneling guard
	unsigned placements = 0;                ///< count of placements
	unsigned numbering = 0;                 ///< count of renumberings of nodes
	unsigned versionShift = 0;              ///< of the versions that the game sees: a restored body has none that it had before
	/// A node (with Adaptivity::refinesOnContact) near another object in this substep, and the request for it.
	struct Near
	{
		enum class Request : unsigned char
		{
			Keep,      ///< do not merge
			Split,     ///< the other object is small enough to slip between big spheres
			SplitLater ///< a corner of its cube may touch; may wait until the body is calm
		};
		int node;
		Request request;
	};
	mutable std::vector<Near> nearNodes;
	std::vector<ContactProxy*> touched;    ///< the proxies in proxyOfNode that are not null
	bool wasTouched = false;               ///< at the end of the last pass something touched it
	NodeSurface surface;                   ///< surface parameters of the contact proxies
	mutable ContactSurface contactSurface; ///< read through surfaceNow()
	mutable std::vector<float> nodeAxes;   ///< rotations at the nodes (Body::nodeRotations), only with anisotropic friction
	mutable SkinBuffers skin;
	RestPositions rest;
	std::shared_ptr<const BodyTemplate> unscaled; ///< the template at scale 1; null: never scaled
	btScalar scale = btScalar( 1 );

	btVector3 worldOrigin() const
	{
		const Vec3d& o = body->nodes().origin;
		return btVector3( btScalar( o.x() ), btScalar( o.y() ), btScalar( o.z() ) );
	}
	btVector3 position( int node ) const
	{
		const NodeState& nodes = body->nodes();
		const Vec3d at = nodes.origin + nodes.x.get( node ).cast<double>();
		return btVector3( btScalar( at.x() ), btScalar( at.y() ), btScalar( at.z() ) );
	}
	btVector3 velocity( int node ) const
	{
		const Vec3Array& v = body->nodes().v;
		return btVector3( v.x[node], v.y[node], v.z[node] );
	}
	/// Returns the contact surface of the current lattice.
	const ContactSurface& surfaceNow() const
	{
		contactSurface.follow( *body, numbering, fractureVersion );
		return contactSurface;
	}
	/// Returns true if contacts with all objects use patches of the drawn surface. The block solver solves them, since Bullet's has no
	/// contacts that are shared by several nodes; a body that steps explicitly takes part with its masses alone.
	bool isMetAsDrawn() const;
	/// The same for contacts with one object: all bodies show rigid ones that move or are small their drawn surface, which would fall into
	/// the gaps between nodes' spheres, and unbroken implicit bodies show it to each other, since their spheres would interlock.
	bool isMetAsDrawnBy( const btCollisionObject& other ) const;
	bool isUnbroken() const { return !family && fractureVersion == 0; }
	/// True for a body without levels that has never broken.
	bool isWhole() const { return !body->levels() && isUnbroken(); }
	/// How far the patches lie in front of the nodes' spheres at most, m.
	double overhang() const { return double( body->lattice().overhang ); }
	/// Whether a force field of its world is being called, which may not change the body. `checkTime` returns a refusal then.
	bool isInField() const;
	Status checkTime( const char* call ) const;
	bool hasNode( int node ) const { return node >= 0 && node < body->nodeCount(); }
	/// Wakes the bodies in contact with this one before it moves in a way that contacts do not predict.
	void wakeTouching( const SoftBody& owner ) const;
	double farthestDrive() const; ///< greatest distance that a node is driven from its position, m
	Pin* findPin( int node );
	/// Moves the object's transform and the spheres to the nodes and records their velocities; the bounds in Bullet must then be updated.
	void placeSpheres( btCollisionObject& object, const MotionSums& motion, TaskRunner* runner = nullptr );
	void placeNodes(); ///< for a search against the nodes of a body in its rigid state
	void placeShape( btCollisionObject& object );
	/// Call after nodes received velocities: a body in its rigid state takes their motion, and a held one deforms.
	void followVelocities();
	/// Moves the object's transform to that of the rigid state.
	void placeRigid( SoftBody& owner );
	/// Between steps, and not while contacts are searched. In a world, contacts with the previous shape must be removed afterwards.
	void becomeRigid( SoftBody& owner );
	void becomeDeformable( SoftBody& owner );
	/// After the core's state was read: gives the object the rigid proxy and the shape of its rigid state, or those of a deformable body.
	void followRigidState( SoftBody& owner );
	/// Returns the node transforms that the skin follows. Valid until the next call.
	SkinPose skinPose() const;
	/// Where between the last two steps the body is drawn; 1: as it is.
	double drawnFraction() const;
	bool isSkinStale() const { return skin.isStale || skin.fraction != drawnFraction(); }
	/// Returns the maps of the nodes as they are drawn, computed if necessary. Valid until the next call.
	const AlignedArray<float>& drawnMaps( TaskRunner* runner ) const;
	/// Call at the start of a game step, with interpolation: keeps the present drawing. `moves`: the body takes part in the step.
	void keepDrawn( bool moves );
	/// Call before and after a change of levels: saves the surface if it is drawn, then starts to fade out its jump.
	void keepSurface();
	void fadeFromKeptSurface();
	/// Performs a change of levels and updates everything that refers to nodes: pins, spheres, contact proxies, skin. `fades`: the jump of
	/// the surface is faded out.
	void changeNodes( SoftBody& owner, const std::function<void()>& change, bool fades = true );
	const SkinBinding& binding() const;
	/// The same; draws new cracks of all bodies of the family.
	const SkinBinding& currentBinding() const;
	const CrackView* shownCracks() const; ///< null: the template's mesh is drawn
	SkinTriangles shownTriangles() const;
	/// Computes the current skin into a buffer that is not in use.
	void drawSkin( TaskRunner* runner ) const;
	bool rotateSkin( TaskRunner* runner ) const; ///< the same for nodes that have moved rigidly; returns false if they have not
	void skinInFull( TaskRunner* runner ) const;
	/// Fills positions, relative to the nodes' origin, m, and normals of the surface that `surface` shows, and its triangles. False if it
	/// shows none.
	bool placeDrawn( std::vector<float>& positions, std::vector<float>& normals, SkinTriangles& triangles ) const;
	bool hasNewCracks() const;
	void drawCracks( TaskRunner* runner = nullptr ) const;
	void drawFamilyCracks() const;
	bool isDrawn() const { return wasDrawn || skin.isRead(); }
	/// Adds the new cuts to those of the family. Call before adopt().
	void noteCuts();
	/// Adds traces of links that are to break, by the body's cells. `shift`: from their points to the template's rest shape, m.
	void noteTraces( std::vector<CutTrace> traces, const Vec3& shift );
	void makeSharedCrackState();
	void noteCracks( const BreakReport& report );

	/// The remainder of a broken body, and its spheres: the present ones or `shape`.
	struct Remains
	{
		std::vector<std::uint32_t> nodeNow; ///< by old node index: the new index; kNoNode for nodes of other pieces
		bool keepsShape = false;
		std::unique_ptr<NodeShape> shape; ///< null if the present shape is kept
	};
	/// Thread-safe for different bodies and concurrently with makeFragment.
	Remains remainsOf( const BodyPiece& piece );
	/// Changes the body into its remainder.
	void adopt( SoftBody& owner, BodyPiece& piece, Remains remains );
	static std::unique_ptr<SoftBody> makeFragment( const SoftBody& parent, BodyPiece& piece );

	// Saving (world/io/impl_archive.cpp). Writes or reads the data from which the body is made: the core and its spheres. Reading needs a
	// new body of this template.
	void archiveMake( Archive& archive );
	/// Writes or reads all data that changes from step to step, except references to other objects.
	void archiveState( Archive& archive );
	/// Makes this the implementation of a body instead of its present one, if any, whose buffers for drawing it takes over.
	static void install( SoftBody& owner, std::unique_ptr<Impl> impl );
	static std::unique_ptr<SoftBody> blank() { return std::unique_ptr<SoftBody>( new SoftBody ); }
	/// Completes a body whose core exists.
	void finish( SoftBody& owner );
};

/// Converts to the core's single precision.
inline Vec3 toVec3( const btVector3& a )
{
	return { float( a.x() ), float( a.y() ), float( a.z() ) };
}

inline Eigen::Matrix3d toMatrix3d( const btMatrix3x3& m )
{
	Eigen::Matrix3d to;
	for ( int row = 0; row < 3; ++row )
	{
		to.row( row ) << double( m[row].x() ), double( m[row].y() ), double( m[row].z() );
	}
	return to;
}
inline Vec3d toVec3d( const btVector3& a )
{
	return { double( a.x() ), double( a.y() ), double( a.z() ) };
}

inline btVector3 toBt( const Vec3d& a )
{
	return btVector3( btScalar( a.x() ), btScalar( a.y() ), btScalar( a.z() ) );
}

inline btTransform toBt( const Eigen::Quaterniond& q, const Vec3d& at )
{
	return btTransform( btQuaternion( btScalar( q.x() ), btScalar( q.y() ), btScalar( q.z() ), btScalar( q.w() ) ), toBt( at ) );
}

inline bool isFinite( const btVector3& a )
{
	return std::isfinite( a.x() ) && std::isfinite( a.y() ) && std::isfinite( a.z() );
}

inline bool isFinite( const btTransform& t )
{
	return isFinite( t.getOrigin() ) && isFinite( t.getBasis()[0] ) && isFinite( t.getBasis()[1] ) && isFinite( t.getBasis()[2] );
}

/// Marks soft bodies without using the user's pointers.
extern const char kSoftBodyMark;

/// Returns the object as a soft body, or null. Contact proxies yield null; SoftBody::upcast accepts them.
SoftBody* asSoftBody( btCollisionObject* object );

} // namespace pliant
