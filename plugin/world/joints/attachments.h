#pragma once

// The attachments of a world. Each end is a point of a soft body, moved by up to four of its nodes, or of a rigid body. The block
// of the island solves them as bilateral contacts (block_attachments.cpp); explicit bodies take part with their masses.

#include "lattice/lattice.h"
#include "pliant/attachment.h"
#include "world/touch/shared_nodes.h"

#include <vector>

class btCollisionObject;

namespace pliant {

/// A point of a soft body.
struct AttachedPoint
{
	SoftBody* body = nullptr;
	SharedNodes nodes;        ///< the piece that has the first node keeps the point
	Vec3d at = Vec3d::Zero(); ///< world, m; valid from noteChange to follow
};

struct Attachment
{
	int id = -1;
	AttachmentSettings settings;
	AttachedPoint first, second; ///< second.body null: the second end is rigid
	btCollisionObject* rigid = nullptr;
	int rigidIndex = -1;               ///< last known index in the world's list of objects
	Vec3d rigidPoint = Vec3d::Zero();  ///< in the rigid body's frame, m
	Vec3d lastForce = Vec3d::Zero();   ///< on the first body in the last substep, N
	Vec3d stepImpulse = Vec3d::Zero(); ///< in the game step so far, N s
	double stepTime = 0.0;             ///< of the substeps in stepImpulse, s
	Vec3d force = Vec3d::Zero();       ///< the mean over the last game step in which it was awake, N

	const btCollisionObject& secondObject() const;
};

class Attachments
{
public:
	/// Attaches a body at the world position `at`, m, carried by `node` and its neighbours, to a rigid body or another soft one. Returns
	/// the id.
	int add( SoftBody& body, int node, const Vec3d& at, btCollisionObject& rigid, const AttachmentSettings& settings );
	int add( SoftBody& body, int node, SoftBody& other, int otherNode, const Vec3d& at, const AttachmentSettings& settings );
	/// Returns false if there is no attachment with this id.
	bool remove( int id );
	/// Removes the attachments and events of an object that leaves the world.
	void removeAllOf( const btCollisionObject& object );
	bool isEmpty() const { return m_attachments.empty(); }
	bool contain( const SoftBody& body ) const;
	/// Returns null if there is no attachment with this id.
	Attachment* find( int id );
	const Attachment* find( int id ) const;
	std::vector<Attachment>& all() { return m_attachments; }
	const std::vector<Attachment>& all() const { return m_attachments; }

	/// Before a body's nodes are renumbered: stores the positions of its points.
	void noteChange( const SoftBody& body );
	/// After a change of levels: assigns points to the new nodes at unchanged positions, and those of removed nodes to the nearest node.
	/// `nodeNow`: by old node; kNoNode: removed. Thread-safe for different bodies.
	void follow( const SoftBody& body, const std::vector<std::uint32_t>& nodeNow );
	/// The same for the remaining body, after moveToPiece() for all pieces. Attachments to removed nodes (of pieces that were not created)
	/// are removed.
	void followRemains( const SoftBody& body, const std::vector<std::uint32_t>& nodeNow );
	/// Moves points on nodes of a separated piece to that piece. `nodeNow`: by node of the parent; kNoNode: not in the piece.
	void moveToPiece( const SoftBody& parent, SoftBody& piece, const std::vector<std::uint32_t>& nodeNow );

	/// At the end of a game step: computes the mean forces over its substeps and removes attachments above their breaking force.
	void endStep();
	std::vector<AttachmentEvent> events;
	/// The id of the next attachment.
	int& nextId() { return m_nextId; }

private:
	/// Calls visit( attachment, point ) for each point of a body.
	template <class F>
	void forPointsOf( const SoftBody& body, F&& visit );

	std::vector<Attachment> m_attachments; ///< ascending by id
	int m_nextId = 0;
};

/// Returns the position of a point, world, m.
Vec3d positionOf( const AttachedPoint& point );
/// Returns the node of a body whose centre is nearest to a position, world, m.
int nearestNode( const SoftBody& body, const Vec3d& at );

} // namespace pliant
