#pragma once

// What stands behind a SoftBody: the core's body, the collision shape, pins, forces and the skin's buffers.

#include "body/body.h"
#include "body/breaking.h"
#include "pliant/soft_body.h"
#include "surface/crack_mesh/shared_crack_state.h"
#include "surface/skin/rigid_skin.h"
#include "surface/skin/skin_fade.h"
#include "surface/skin/skinning.h"
#include "world/constants.h"
#include "world/detect/node_contacts.h"
#include "world/implicit/implicit_choice.h"
#include "world/shape/contact_proxy.h"
#include "world/shape/node_shape.h"
#include "world/shape/penetration_allowance.h"
#include "world/touch/contact_surface.h"

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

namespace pliant {

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
	btRigidBody* body = nullptr;            ///< FollowsBody; in the soft body's world, as long as that is in one
	int bodyIndex = -1;                     ///< where it was last in the world's list of objects
	int bodyProxy = -1;                     ///< the number of its broadphase proxy when it was pinned to
	btVector3 point = btVector3( 0, 0, 0 ); ///< FollowsBody: in the body's frame; Driven: target in the world
	bool hasTarget = false;                 ///< Driven: the target has not been reached yet
};

struct SkinBuffers
{
	/// One is shown, one was shown before that; and of a body that moves as one, one is what was skinned last in full.
	static constexpr int kCount = 3;
	std::vector<float> positions[kCount], normals[kCount];
	btVector3 origin[kCount] = { btVector3( 0, 0, 0 ), btVector3( 0, 0, 0 ), btVector3( 0, 0, 0 ) };
	std::vector<float> rotations, gradients, flow;
	std::vector<float> gradientsScratch; ///< of a change of levels
	AlignedArray<float> maps;            ///< SkinScratch::nodeMap of what is shown
	SkinFade fade;                       ///< of bodies with levels
	RigidSkin rigid;
	double tolerance = kSurfaceTolerance; ///< in cells
	int current = 0;
	int full = 0; ///< skinned last in full
	unsigned frame = 0;
	unsigned askedIn = 0; ///< the world's step after which the surface was last asked for; 0: never
	bool isStale = true;
	bool areTurnsKnown = false; ///< rotations and flow are those of the nodes as they are
	bool isPoseKnown = false;   ///< gradients too
	bool isMapKnown = false;    ///< and `maps`

	void nodesMoved()
	{
		isStale = true;
		areTurnsKnown = isPoseKnown = isMapKnown = false;
	}
	/// What is kept for bodies that move as one is another's: nodes have other numbers, or what is drawn is another surface.
	void nodesChanged()
	{
		nodesMoved();
		rigid.forget();
	}
};

/// Another body that this one came apart from: as deep as their spheres overlapped then they may go on doing, and no deeper.
struct FreshPair
{
	unsigned other; ///< its serial
	double slack;   ///< m, only ever smaller; infinity until it has been measured

	friend bool operator<( const FreshPair& a, const FreshPair& b ) { return a.other < b.other; }
};

/// Where the nodes were when the body was last seen to move from there (activation.cpp).
struct RestPosition
{
	std::vector<Vec3> place; ///< relative to `origin`, m; empty: nowhere
	Vec3d origin = Vec3d::Zero();
	unsigned numbering = 0; ///< SoftBody::Impl::numbering of them
};

/// SmallPieces::Fade. A piece that has faded has left the world once; it may be added again by who owns it.
struct Fading
{
	float time = 0.0f; ///< s, of the whole; 0: it does not fade
	double left = 0.0; ///< s
	bool isOver = false;
};

/// SoftBody::setSelfCollision.
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
	/// The object's transform stands at the mass centre, rounded to Bullet's precision; the shape's spheres are relative to it. This is
	/// where that is in the nodes' own coordinates.
	Vec3 shapeShift = Vec3::Zero();
	double mass = 0.0;                ///< kg, of all nodes
	double meanSquareSpeed = 0.0;     ///< m^2/s^2, weighted by mass, after the last substep
	double slowFor = 0.0;             ///< s, that it has been slower than kAllowanceCalm
	bool isBroken = false;            ///< the last substep met a number that is not finite
	SoftBodySystem* system = nullptr; ///< of the world the body is in

	StiffnessPlan plan;
	ElasticityState elasticity;     ///< of Elasticity::Automatic
	bool isImplicit = false;        ///< in this substep
	double lastSubstep = 0.0;       ///< s; 0: there was none
	int block = -1, blockPart = -1; ///< in this substep's implicit solution; -1: in none
	int frictionTorque = -1;        ///< its place among FrictionTorqueCorrection's turns; -1: none
	bool isGuarded = false;         ///< it was fast, and is near what it must not pass: it is held back though it is slow now
	bool isHealthy = true;
	int stateBefore = ACTIVE_TAG; ///< of activation, before quarantine took the body out of the simulation
	bool hasOwnGravity = false;
	btVector3 gravity = btVector3( 0, 0, 0 );
	btVector3 centralForce = btVector3( 0, 0, 0 );
	bool hasNodeForces = false;

	std::vector<Vec3d> heldBefore; ///< nodes of a static or kinematic body at the last game step, world, m; empty of others

	unsigned serial = 0;       ///< in the world it is in, never used twice
	bool isWorldOwned = false; ///< a fragment that nobody has released
	unsigned fractureVersion = 0;
	std::shared_ptr<int> family;          ///< bodies made of the one body it all came from; null: it never came apart
	mutable std::vector<FreshPair> fresh; ///< ascending
	mutable PenetrationAllowance born;    ///< noted while contacts are found
	Fading fading;
	std::unique_ptr<NodeShape> shapeBefore;        ///< stand-ins of nodes that came off point to its spheres until the next collision phase
	std::shared_ptr<SharedCrackState> crackFamily; ///< null: nobody had looked when it broke, or links were healed
	std::vector<CutTrace> newCuts;                 ///< their links are to break
	std::shared_ptr<std::vector<CutTrace>> cuts;   ///< of the family, as the template's cells; null: nobody has cut it
	mutable std::unique_ptr<CrackView> crackView;  ///< null: the template's mesh is drawn as it is
	bool wasLookedAt = false;                      ///< what it came off
	mutable unsigned crackVersion = 0;             ///< fractureVersion that the view shows
	mutable unsigned crackVersionBefore = 0;       ///< and that its change is from

	std::unique_ptr<SelfCollision> self; ///< null: its nodes do not meet each other
	std::vector<Pin> pins;               ///< ascending by node
	std::vector<ContactProxy*> nodeBody; ///< by node; null while untouched
	mutable int parting = 0; ///< above 0: it goes apart from what it was put into (parting.h), whose nearest faces may hold it back
	unsigned placed = 0;     ///< one more whenever it is put somewhere
	unsigned numbering = 0;  ///< one more whenever nodes get other numbers
	/// Nodes (with Adaptivity::refinesOnContact) that something has come near in this substep.
	struct Near
	{
		enum class Wish : unsigned char
		{
			Stay,  ///< as it is, not to be merged
			Split, ///< for what is smaller might slip between big spheres
			Widen  ///< into its parts, for a corner of its cube may touch: it can wait
		};
		int node;
		Wish wish;
	};
	mutable std::vector<Near> nearby;
	std::vector<ContactProxy*> touched;    ///< those that are not null
	NodeSurface surface;                   ///< of stand-ins
	mutable ContactSurface contactSurface; ///< ask surfaceNow()
	mutable std::vector<float> nodeAxes;   ///< rotations at the nodes (Body::nodeRotations), of bodies with friction by direction only
	mutable SkinBuffers skin;
	RestPosition rest;

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
	/// Of the lattice as it is now.
	const ContactSurface& surfaceNow() const
	{
		contactSurface.follow( *body, numbering + fractureVersion );
		return contactSurface;
	}
	/// What touches it meets patches of its drawn surface: of a body that steps implicitly. Bullet's solver, which serves explicit ones,
	/// knows bodies, not nodes that share a contact.
	bool isMetAsDrawn() const { return isImplicit && !body->lattice().patch.empty() && surfaceNow().hasPatches(); }
	bool hasNode( int node ) const { return node >= 0 && node < body->nodeCount(); }
	/// What rests on the body or holds it up wakes: the body is about to move in a way that contacts do not see coming.
	void wakeTouching( const SoftBody& owner ) const;
	double farthestDrive() const; ///< from where a node is, m
	Pin* findPin( int node );
	/// The object's transform and the spheres go where the nodes are, and how fast those are is noted; what Bullet is asked of them is to
	/// be freshened.
	void placeSpheres( btCollisionObject& object, const MotionSums& motion, TaskRunner* runner = nullptr );
	void placeShape( btCollisionObject& object );
	/// How the nodes carry the skin now. Valid until the next call.
	SkinPose skinPose() const;
	/// Before a change of levels: how the surface is carried, if anybody looks at it. After: what the change moved it by.
	void keepSurface();
	void fadeFromKeptSurface();
	/// Makes a change of levels and has all that names the body's nodes follow it: pins, spheres, stand-ins, skin. `fades`: what the
	/// surface jumps by is faded out.
	void changeNodes( SoftBody& owner, const std::function<void()>& change, bool fades = true );
	const SkinBinding& binding() const;
	const CrackView* shownCracks() const; ///< null: the template's mesh is shown
	SkinTriangles shownTriangles() const;
	/// The skin of the nodes as they are, into a buffer that nobody reads.
	void drawSkin( TaskRunner* runner ) const;
	bool turnSkin( TaskRunner* runner ) const; ///< the same where they have moved as one. False: they have not
	void skinInFull( TaskRunner* runner ) const;
	bool hasNewCracks() const;
	void showOwnCracks() const;
	void drawCracks( TaskRunner* runner = nullptr ) const;
	void drawKin() const;
	bool isLookedAt() const { return wasLookedAt || skin.frame > 0; }
	/// Links broke that the body's lattice had so far. Before it takes the shape of what is left of it.
	void noteCuts();
	void makeSharedCrackState();
	void noteCracks( const BreakReport& report );

	/// What is left of the body, and its spheres: those there were, or `shape`.
	struct Remains
	{
		std::vector<std::uint32_t> nodeNow; ///< by node before: its number; kNoNode for those of other pieces
		bool keepsShape = false;
		std::unique_ptr<NodeShape> shape; ///< null where that is kept
	};
	/// Safe to use on several bodies at once, and beside makeFragment.
	Remains remainsOf( const BodyPiece& piece );
	/// The body takes the shape of what is left of it.
	void adopt( SoftBody& owner, BodyPiece& piece, Remains remains );
	static std::unique_ptr<SoftBody> makeFragment( const SoftBody& parent, BodyPiece& piece );
	/// Everything a body needs once its core is there.
	void finish( SoftBody& owner );
};

/// A node's place and velocity as the core keeps them.
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

inline bool isFinite( const btVector3& a )
{
	return std::isfinite( a.x() ) && std::isfinite( a.y() ) && std::isfinite( a.z() );
}

inline bool isFinite( const btTransform& t )
{
	return isFinite( t.getOrigin() ) && isFinite( t.getBasis()[0] ) && isFinite( t.getBasis()[1] ) && isFinite( t.getBasis()[2] );
}

/// Marks objects as ours without touching the user's pointers.
extern const char kSoftBodyMark;

/// The object as the soft body it is, or null. Node stand-ins do not count here; SoftBody::upcast takes them too.
SoftBody* asSoftBody( btCollisionObject* object );

} // namespace pliant
