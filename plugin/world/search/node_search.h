#pragma once

// Finds the nodes of a soft body that touch another object in this step, ordered by node, then part of the other object, then distance.

#include "world/shape/node_marks.h"
#include "world/shape/node_shape.h"
#include "world/touch/node_touch.h"
#include "world/touch/obstacle_motion.h"

#include <BulletCollision/BroadphaseCollision/btDbvt.h>

#include <cstdint>
#include <vector>

class btConcaveShape;
class btTransform;
struct btCollisionObjectWrapper;

namespace pliant {

class ContactSurface;
class SoftBody;

struct NodeHit
{
	std::uint64_t key = 0; ///< ( node ) << 32 | index of the other object's simple shape, counted through its compounds, or its node
	Touch touch;
	int part = -1; ///< Bullet's identifiers of the part that was hit
	int index = -1;

	int node() const { return int( key >> 32 ); }
	int other() const { return int( key & 0xffffffffu ); }
};

/// Keeps its scratch between calls: after warm-up a search allocates nothing.
class NodeSearch
{
public:
	/// Contact of soft bodies with Bullet's characters.
	struct Characters
	{
		Vec3d up = Vec3d::Zero(); ///< against gravity, of unit length; zero without gravity
		double allowance = 0.0;   ///< m, their penetration of the ground: their sweeps stop there
		double gameStep = 0.0;    ///< s, in which characters push objects out
	};
	/// A node that pressed the other object in the last substep.
	struct Pressed
	{
		int node = 0;
		double reach = 0.0; ///< how far from the object it still counts as touching, m
	};
	/// For the next search against a rigid object: ascending by node. Cleared by the search.
	std::vector<Pressed>& pressed() { return m_pressed; }
	void setCharacters( const Characters& characters ) { m_characters = characters; }
	std::vector<NodeHit>& againstRigid( const SoftBody& soft, const btCollisionObjectWrapper& other, double step );
	/// Normals point from `b` to `a`.
	std::vector<NodeHit>& againstSoft( const SoftBody& a, const SoftBody& b, double step );

private:
	/// The body's spheres with their motion relative to the obstacle.
	class Spheres
	{
	public:
		explicit Spheres( const NodeSearch& search );
		MovingSphere of( int node ) const;
		Ahead ahead( int node ) const;

	private:
		const NodeState& m_nodes;
		const NodeShape& m_shape;
		const ObstacleMotion& m_motion;
		double m_step;
		bool m_isStill;
		const Vec3Array& m_velocityBefore;
		const ObstacleMotion& m_unforcedMotion;
		const std::vector<Pressed>& m_pressed;
	};

	void visit( const Obstacle& part );
	void plane( const Obstacle& obstacle );
	void solid( const Obstacle& obstacle );
	void mesh( const Obstacle& obstacle );
	void triangle( const Obstacle& mesh, const Vec3d ( &corners )[3] );
	template <class Nearest, class Find>
	bool touches( int node, const MovingSphere& sphere, const Nearest& nearest, const Find& find, Touch& touch ) const;
	template <class Find>
	void touchMarked( const Obstacle& obstacle, btScalar size, const Find& find );
	void noteNearby( int node, btScalar size ) const;
	btVector3 cornerReach() const;
	double overhang() const; ///< how far a touch may lie outside of the spheres, m
	double solidOverhang() const;
	template <class Find>
	void foresee( int node, const Find& find ) const;
	template <class Find>
	void foreseeIn( const btVector3& low, const btVector3& high, const Find& find );
	void applyAllowances( const SoftBody& first, const SoftBody* second );
	void dropFlatNeighbours();
	void adjustForCharacter();
	void sortHits();

	Characters m_characters;
	std::vector<Pressed> m_pressed;
	double m_pressedReach = 0.0; ///< the largest of them; 0 between searches
	const SoftBody* m_soft = nullptr;
	const ContactSurface* m_surface = nullptr; ///< null: the body is met in its nodes' own spheres
	double m_step = 0.0;
	bool m_refinesOnContact = false; ///< the body refines on contact
	bool m_looksAhead = false;       ///< the body steps implicitly, and its velocities at the substep's start are known
	ObstacleMotion m_motion;
	ObstacleMotion m_unforcedMotion; ///< without the step's forces: a body at rest does not fall
	PatchObstacle m_patchObstacle;
	std::uint32_t m_leaf = 0;
	std::vector<NodeHit> m_hits;
	NodeMarks m_marks;
	SphereRows::Pairs m_pairs;
};

} // namespace pliant
