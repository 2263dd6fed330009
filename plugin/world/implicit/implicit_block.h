#pragma once

// The linear system of one island in an implicit substep: the speeds of soft bodies' nodes and of the rigid bodies they touch, and the
// contacts between them, unilateral and with Coulomb friction. docs/design/implicit.md has the formulas and where the numbers come from.

#include "body/implicit_motion.h"
#include "lattice/lattice.h"
#include "matching/implicit/conjugate_gradients.h"
#include "world/linear/coarse_system.h"
#include "world/touch/shared_nodes.h"

#include <vector>

class btManifoldPoint;
class btRigidBody;

namespace pliant {

class SoftBody;
class TaskRunner;

/// One side of a contact: a node and those beside it that share it, a rigid body, or something whose speed is given.
struct ContactSide
{
	int soft = -1; ///< part, or -1
	int node = -1;
	SharedNodes shared;                                 ///< of a node; the first is the node itself
	int block[SharedNodes::kMost] = { -1, -1, -1, -1 }; ///< each among the block's nodes with contacts
	int rigid = -1;                                     ///< part, or -1
	Vec3d arm = Vec3d::Zero();                          ///< from the rigid body's mass centre, m
	Vec3d given = Vec3d::Zero();                        ///< m/s: of what neither is, and of a surface that runs along itself
};

struct BlockContact
{
	ContactSide side[2]; ///< the normal points from the second to the first
	Vec3d normal = Vec3d::Zero();
	Vec3d before = Vec3d::Zero(); ///< relative speed at the substep's start, m/s
	double target = 0.0;          ///< b: speed of parting that is asked for at least, m/s
	double parting = 0.0;         ///< the same, if it did not bounce
	double friction = 0.0;        ///< mu
	bool isDrawn = false;         ///< with a body's drawn surface, whose points several nodes share
	int directed = -1;            ///< among the block's directions; -1: friction is the same in all
	btManifoldPoint* point = nullptr;

	// Impulses, N s: at first those of the last substep, at the end those of this one.
	double normalImpulse = 0.0;
	Vec3d tangentImpulse = Vec3d::Zero();
	double carried = 0.0; ///< of the normal one, into the next substep

	// The linearised law: jn = pushed + k ( b - u.n ) while it presses; jt = held - kt ut, of `limited` times mu at most.
	double stiffness = 0.0;        ///< k, kg
	double pushed = 0.0;           ///< ln
	double limited = 0.0;          ///< what it presses with as far as is known, N s
	double tangentStiffness = 0.0; ///< kt, kg
	Vec3d held = Vec3d::Zero();
	Vec3d heldBefore = Vec3d::Zero(); ///< lt
	bool presses = false;
	bool bounces = false; ///< off something that it meets fast enough

	Vec3d impulse() const { return normalImpulse * normal + tangentImpulse; }
	/// Whether an impulse could change anything.
	bool moves() const { return side[0].soft >= 0 || side[1].soft >= 0 || side[0].rigid >= 0 || side[1].rigid >= 0; }
};

struct SoftPart
{
	SoftBody* owner = nullptr;
	ImplicitMotion* motion = nullptr;
	const Vec3Array* before = nullptr; ///< speeds at the substep's start: where the iteration begins
	int offset = 0;                    ///< of its speeds in the vector
	std::vector<Vec3d> turn;           ///< angular velocity of each of its parts, rad/s; empty: nobody has asked
	int firstConnected = 0;            ///< of its parts that nothing links, in the block's list of such; one where the body is in one
};

struct RigidPart
{
	btRigidBody* body = nullptr;
	int offset = 0;
	double mass = 1.0;                                     ///< kg
	Eigen::Matrix3d inertia = Eigen::Matrix3d::Identity(); ///< kg m^2, world axes
	bool moves[3] = { true, true, true };                  ///< false: the game has locked that axis
	bool turns[3] = { true, true, true };
	Vector6 free = Vector6::Zero(); ///< speeds without contacts: V + h F / M + e
	Vector6 before = Vector6::Zero();
	Vector6 speed = Vector6::Zero(); ///< the answer
	Vector6 given = Vector6::Zero(); ///< what Bullet's solver should make of it without joints and rigid contacts
	Vec3d centre = Vec3d::Zero();    ///< of mass, world, m
	int coarse = -1;                 ///< body of the coarse system
};

/// A contact that presses, as the iteration walks it: u.n is answered by `along` more than u, and u by `across`.
struct Pressing
{
	struct Side
	{
		int count = 0;                                            ///< of nodes; 1 for a rigid body, 0 where its speed is given
		int stride = 0;                                           ///< between a node's components; 0: six numbers of a rigid body
		int place[SharedNodes::kMost];                            ///< of each node's first number in the vector
		double rub[SharedNodes::kMost], more[SharedNodes::kMost]; ///< SharedNodes::rub, and by how much press is more
		double arm[3];
	};
	Side side[2];
	double normal[3];
	double along = 0.0, across = 0.0; ///< k - kt and kt, kg; k and kt where directed
	int directed = -1;
};

/// What a solution took.
struct BlockCount
{
	int passes = 0, products = 0;
};

class ImplicitBlock : private LinearSystem
{
public:
	std::vector<SoftPart> soft;
	std::vector<RigidPart> rigid;
	std::vector<BlockContact> contacts;
	/// Friction by direction, S: jt = S ( held - kt ut ), symmetric, without the normal.
	std::vector<Eigen::Matrix3d> directions;

	/// Speeds of nodes and rigid parts and impulses of contacts, as they are at the end of the substep.
	BlockCount solve( TaskRunner* runner );
	void clear();
	/// Relative speed at a contact without any contact's impulse, elasticity left out, m/s.
	Vec3d freeSpeed( const BlockContact& contact ) const;
	/// How a node's part turns as a whole, rad/s.
	const Vec3d& turnOf( const ContactSide& side );
	/// And at the substep's start.
	Vec3d velocityBefore( const BlockContact& contact ) const;

private:
	struct NodeBlock
	{
		int part = -1, node = -1;
		int place = -1; ///< of its first number in the vector
		int cluster = -1, slot = -1;
	};
	/// A soft body, or one of the parts it is in: what moves as a whole.
	struct Connected
	{
		int soft = -1, part = 0;
		int coarse = -1;      ///< body of the coarse system; -1: its nodes stand by themselves
		bool touches = false; ///< some contact is one of its nodes
	};
	/// Nodes that contacts hold together: a dense piece of the preconditioner.
	struct Cluster
	{
		static constexpr int kMost = 2 * SharedNodes::kMost; ///< a contact's of two soft bodies; implicit_clusters.cpp names each size
		int blocks[kMost] = {};
		int count = 0;
		int scratch = 0;                           ///< of its matrix in m_clusterStorage
		int inverse = 0;                           ///< of its inverse in m_clusterInverse, column by column
		int place[kMost] = {}, stride[kMost] = {}; ///< of each block's first number in the vector, and between its numbers
	};

	/// A contact on the way from m_v to somewhere, as shares of the way: u.n and its change, jt.u of the way at m_v and its change, 0 where
	/// it does not press. And its law, which is asked for some twenty times over: contacts themselves are half a kilobyte each.
	struct Way
	{
		double start, way;
		double slideStart, slide;
		double pushed, stiffness, target;
	};

	/// How far the impulses of one part are from those of the law, summed, and the limits of what rubs it, N s.
	struct PartError
	{
		Vec3d rub = Vec3d::Zero();
		double limit = 0.0;
	};
	/// Whether impulses are those of the law at some speeds, as it was not linearised: those of all parts together, and what each is rubbed
	/// by.
	struct Match
	{
		bool all = false, each = false;
	};

	/// A contact of a node with something whose speed is given.
	struct Between
	{
		int node = -1; ///< among the block's nodes with contacts
		std::size_t contact = 0;
		int side = 0; ///< the node's
	};

	int size() const override { return m_size; }
	void apply( const float* v, float* to ) override;
	void precondition( const float* r, float* z ) override;
	void moved( float by ) override;

	void layOut();
	void listConnected();
	/// Of a side that is a node.
	const Connected& connectedOf( const ContactSide& side ) const
	{
		const SoftPart& part = soft[std::size_t( side.soft )];
		return m_connected[std::size_t( part.firstConnected + part.motion->parts().partOf( side.node ) )];
	}
	int nameNode( int part, int node );
	void startFrom( const SoftPart& part );
	void nameNodeBlocks();
	void applyMasses( const float* v, float* to );
	void listPressing();
	Vec3d speedOf( const ContactSide& side, const Vec3d& normal, const float* v ) const;
	Vec3d relativeSpeed( const BlockContact& contact, const float* v ) const;
	void addImpulse( const ContactSide& side, const Vec3d& normal, const Vec3d& impulse, float* to ) const;
	void addPair( const BlockContact& contact, const Vec3d& impulse, float* to ) const;
	/// S v, or v where friction is the same in all directions. v: without the normal.
	Vec3d directed( const BlockContact& contact, const Vec3d& v ) const
	{
		return contact.directed < 0 ? v : Vec3d( directions[std::size_t( contact.directed )] * v );
	}
	Eigen::Matrix3d resistance( const BlockContact& contact ) const;
	void fillFree();
	/// From m_v on, until impulses are those of the law.
	void solveLaw( BlockCount& count );
	/// Whether impulses at m_next are good enough to end with after so many passes.
	bool mayEnd( int passes );
	/// At m_next: b - A v with contacts as linearised, out of that without them.
	void beginIteration();
	double energyLeft() const;
	/// Improves m_next until `share` of what is off is left, or little enough, and reads its impulses.
	void iterate( double fraction, BlockCount& count );
	void fillPreconditioner();
	void layOutCoarse();
	void nameClusters( const BlockContact& contact );
	Eigen::Map<Eigen::MatrixXd> matrixOf( const Cluster& cluster )
	{
		return { m_clusterStorage.data() + cluster.scratch, 3 * cluster.count, 3 * cluster.count };
	}
	void beginClusters();
	void addToClusters( const BlockContact& contact, const Eigen::Matrix3d& resists );
	void invertClusters();
	/// Floats of a column of an inverse: whole fours.
	static constexpr int columnOf( int count ) { return ( 3 * count + 3 ) / 4 * 4; }
	template <int count>
	void preconditionCluster( const Cluster& cluster, const float* r, float* z ) const;
	void preconditionClusters( const float* r, float* z ) const;
	void addToPreconditioner( const BlockContact& contact );
	void lockAxes( const RigidPart& part, int body );
	void readAnswer();

	// In implicit_conflicts.cpp.
	/// Contacts of one node with things whose speeds are given ask for nothing that they cannot all have.
	void agreeOnTargets();
	/// At the end: what of each impulse the next substep begins with.
	void carryImpulses();
	void agreeOnTargets( std::size_t first, std::size_t end ); ///< of one node: [first, end) of m_between

	// The law, in contact_law.cpp.
	Vec3d undirected( const BlockContact& contact ) const;
	void chooseStiffness();
	/// `passes`: those made so far.
	void linearise( const float* v, int passes );
	/// Whether the impulses found are none that contacts could have: pulling, or rubbing far beyond their limits.
	bool isWild() const;
	Match matchAt( const float* v );
	void readImpulses( const float* v );
	/// The lowest point on the way from m_v to m_next, as a share of the way.
	double stepTowards();
	double lowestFraction( double slope, double curvature ) const;

	// In implicit_restitution.cpp.
	/// Of the contacts' impulses, and how much they move, J.
	struct Work
	{
		double sum = 0.0, moved = 0.0;
	};
	/// Impulses of a contact, N s.
	struct Bounce
	{
		double normal;
		Vec3d tangent;
	};
	Work workOfContacts() const;
	void keepEnergy( BlockCount& count );
	void bounceLess( BlockCount& count );

	// In implicit_momentum.cpp.
	void keepMomentum();
	/// Something that moves as a whole and touches nothing fixed: a connected part of a soft body, or a rigid body.
	struct Mover
	{
		ImplicitMotion* motion = nullptr; ///< null: rigid
		int part = 0;
		RigidPart* rigid = nullptr;
		Vec3d centre = Vec3d::Zero();      ///< world, m
		Matrix6 mass = Matrix6::Zero();    ///< of rigid motions about it
		Vector6 missing = Vector6::Zero(); ///< N s, N m s
	};
	Mover moverAt( std::uint32_t k );
	void keepMomentumOf( const std::uint32_t* begin, const std::uint32_t* end );

	int m_size = 0;
	TaskRunner* m_runner = nullptr;
	ConjugateGradients m_gradients;
	AlignedArray<float> m_v, m_next, m_rightSide, m_scratch;
	AlignedArray<float> m_free, m_freeNext; ///< b - A v at m_v and at m_next, without contacts
	AlignedArray<float> m_bounced;          ///< speeds with all that bounces; scratch of bounceLess
	std::vector<Bounce> m_bounces;          ///< by contact, with all that bounces; the same
	AlignedArray<float> m_massed;           ///< what the last product was without contacts
	AlignedArray<float> m_inverseDiagonal;  ///< 1 / A_ii of the soft parts' nodes, at the place of their first component
	std::vector<Pressing> m_pressing;       ///< as last linearised
	std::vector<Way> m_ways;                ///< by contact; scratch of stepTowards
	std::vector<PartError> m_partErrors;    ///< soft parts', then rigid ones'; scratch of matchAt
	std::vector<Between> m_between;         ///< by node; scratch of agreeOnTargets
	std::vector<NodeBlock> m_nodeBlocks;    ///< of the nodes that contacts name
	std::vector<Cluster> m_clusters;
	std::vector<double> m_clusterStorage;
	AlignedArray<float> m_clusterInverse;
	std::vector<Connected> m_connected;                      ///< of all soft parts, in their order
	std::vector<std::uint32_t> m_groupStart, m_groupMembers; ///< scratch of keepMomentum
	std::vector<Mover> m_movers;                             ///< the same of keepMomentumOf
	std::vector<int> m_blockOf; ///< by place of the node's first component; -1: no contact names it, and so beyond the vector's end
	CoarseSystem m_coarse;
	std::vector<int> m_coarseSizes;
	std::vector<CoarseSystem::Pair> m_coarsePairs;
	Eigen::VectorXd m_coarseSums, m_coarseMotion;
	double m_softMass = 0.0;
};

} // namespace pliant
