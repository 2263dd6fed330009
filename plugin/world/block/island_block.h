#pragma once

// The linear system of one island in a substep. Its unknowns are the velocities of implicit bodies' nodes, of the touched nodes of explicit
// ones, and of the rigid bodies that they touch, coupled by unilateral contacts with Coulomb friction. docs/design/implicit.md derives the
// formulas and the constants.

#include "body/implicit/implicit_motion.h"
#include "lattice/lattice.h"
#include "matching/implicit/conjugate_gradients.h"
#include "world/linear/active_contact.h"
#include "world/linear/coarse_system.h"
#include "world/linear/contact_sweeps.h"
#include "world/touch/shared_nodes.h"

#include <memory>
#include <vector>

class btManifoldPoint;
class btCollisionObject;

namespace pliant {

class JointGroup;
class SoftBody;
class TaskRunner;
class TouchedNodes;
class UnionFind;

/// One side of a contact: a node with the neighbours that share the contact, a rigid body, or an object of prescribed velocity.
struct ContactSide
{
	int soft = -1; ///< index in IslandBlock::soft, or -1
	int node = -1;
	SharedNodes shared;                                 ///< of a node side; the first is `node` itself
	int block[SharedNodes::kMost] = { -1, -1, -1, -1 }; ///< index of each shared node in m_nodeBlocks
	int rigid = -1;                                     ///< index in IslandBlock::rigid, or -1
	Vec3d arm = Vec3d::Zero();                          ///< from the rigid body's centre of mass, m
	Vec3d prescribedVelocity = Vec3d::Zero();           ///< m/s; of objects outside the block and of conveyor surfaces
};

struct BlockContact
{
	ContactSide side[2]; ///< the normal points from the second side to the first
	Vec3d normal = Vec3d::Zero();
	Vec3d velocityBefore = Vec3d::Zero(); ///< relative velocity at the start of the substep, m/s
	double target = 0.0;                  ///< b: smallest required separation velocity, m/s
	double targetWithoutBounce = 0.0;     ///< b without restitution, m/s
	double friction = 0.0;                ///< mu
	double restitution = 0.0;             ///< of a body that bounces as rigid, until it separates
	bool isDrawn = false;                 ///< touches a drawn surface, whose points are shared by several nodes
	int frictionScale = -1;               ///< index in frictionScales; -1: isotropic friction
	btManifoldPoint* point = nullptr;     ///< null: an attachment

	// Of an attachment only, which pulls as well as presses and holds across the normal as along it (block_attachments.cpp).
	int attachment = -1;                 ///< its id
	bool hasExplicitSide = false;        ///< a body that steps explicitly
	double compliance = 0.0;             ///< m/N
	double timeStep = 0.0;               ///< h, s
	Vec3d tangentTarget = Vec3d::Zero(); ///< b across the normal, m/s
	bool isAttachment() const { return attachment >= 0; }

	// Impulses, N s: on entry those of the last substep, on return those of this one.
	double normalImpulse = 0.0;
	Vec3d tangentImpulse = Vec3d::Zero();
	double carried = 0.0; ///< normal impulse that the next substep starts from

	// The linearised law: jn = normalMultiplier + k ( b - u.n ) while active; jt = scaledMultiplier - kt ut, at most mu frictionLoad.
	double stiffness = 0.0;                  ///< k, kg
	double normalMultiplier = 0.0;           ///< ln
	double frictionLoad = 0.0;               ///< normal impulse that limits friction, N s
	double tangentStiffness = 0.0;           ///< kt, kg
	Vec3d scaledMultiplier = Vec3d::Zero();  ///< s lt
	Vec3d tangentMultiplier = Vec3d::Zero(); ///< lt
	bool isActive = false;                   ///< transmits an impulse in the linearised law
	bool bounces = false;                    ///< approaches fast enough for restitution

	Vec3d impulse() const { return normalImpulse * normal + tangentImpulse; }
	/// Returns true if an impulse can move either side.
	bool moves() const { return side[0].soft >= 0 || side[1].soft >= 0 || side[0].rigid >= 0 || side[1].rigid >= 0; }
};

struct SoftPart
{
	SoftBody* owner = nullptr;
	ImplicitMotion* motion = nullptr;
	TouchedNodes* touched = nullptr;           ///< null: all nodes take part
	ImplicitMotion* whole = nullptr;           ///< all nodes where only touched ones take part; null until it is needed
	const Vec3Array* velocityBefore = nullptr; ///< at the start of the substep: the initial guess
	int offset = 0;                            ///< of its velocities in the vector
	std::vector<Vec3d> angularVelocity;        ///< of each connected part, rad/s; computed on demand
	int firstConnected = 0;                    ///< index of its first connected part in m_connected
	double restitutionFraction = 1.0;          ///< of restitution, against heavy objects (implicit_choice.h)
	bool bouncesAsRigid = false;               ///< simulated far softer than it is: rebounds by restitution alone
};

/// A rigid body, or a link of a multibody (moved_object.h).
struct RigidPart
{
	btCollisionObject* object = nullptr;
	int offset = 0;
	double mass = 1.0;                                     ///< kg
	Eigen::Matrix3d inertia = Eigen::Matrix3d::Identity(); ///< kg m^2, world axes
	bool moves[3] = { true, true, true };                  ///< false: the axis is locked
	bool turns[3] = { true, true, true };
	Vector6 freeVelocity = Vector6::Zero(); ///< without contacts: V + h F / M + e
	Vector6 velocityBefore = Vector6::Zero();
	Vector6 velocity = Vector6::Zero();         ///< the solution
	Vector6 expectedVelocity = Vector6::Zero(); ///< result of Bullet's solver if joints and rigid contacts do nothing
	Vec3d centre = Vec3d::Zero();               ///< centre of mass, world, m
	int coarse = -1;                            ///< body index in the coarse system
	bool isAttached = false;                    ///< on joints, with an attachment
	bool isHit = false;                         ///< linked in this substep alone, without e
	int linked = -1, link = 0;                  ///< of a link: index in IslandBlock::linked, and its number there

	bool hasLockedAxis() const { return !( moves[0] && moves[1] && moves[2] && turns[0] && turns[1] && turns[2] ); }
};

/// Links of a multibody that take part in a block, or rigid bodies that joints join. An impulse on one moves all of them.
struct LinkedParts
{
	std::vector<int> parts;             ///< indices of rigid parts
	Eigen::MatrixXd mass;               ///< six rows and columns for each, as a rigid part's mass and inertia: kg, kg m, kg m^2
	std::shared_ptr<JointGroup> joints; ///< of rigid bodies on Bullet's joints; null for links of a multibody
};

/// The work of a solution.
struct BlockCount
{
	int passes = 0, products = 0;
};

class IslandBlock : private LinearSystem
{
public:
	std::vector<SoftPart> soft;
	std::vector<RigidPart> rigid;
	std::vector<LinkedParts> linked;
	std::vector<BlockContact> contacts;
	/// S of anisotropic friction: jt = S ( scaledMultiplier - kt ut ), symmetric, with the normal in its null space.
	std::vector<Eigen::Matrix3d> frictionScales;
	double bounceThreshold = 0.0; ///< approach velocity from which on a body rebounds, m/s

	/// Computes the velocities of nodes and rigid parts and the contact impulses at the end of the substep.
	BlockCount solve( TaskRunner* runner );
	void beginResponses( TaskRunner* runner ); ///< of one soft body without contacts
	/// Solves A v = p for impulses on the nodes, N s, to a fraction of the energy, from `velocity`; both component after component.
	void respond( const float* impulse, float* velocity, double fraction );
	/// Whether the last solution ended where its impulses were still far from the law (kMostHardPasses).
	bool isUnsettled() const { return m_isUnsettled; }
	void clear();
	/// Returns the relative velocity at a contact without contact impulses and elastic forces, m/s.
	Vec3d freeVelocity( const BlockContact& contact ) const;
	/// Returns the speed, m/s, at which a rolling surface recedes from the contact: nodes move along chords, by which a sphere of radius R
	/// comes ( h w )^2 R / 2 nearer to the ground in a step of h. Without it a rolling body sinks and is lifted again, and loses energy.
	double rollingLag( const BlockContact& contact, double h );
	/// Returns how deep a contact that is `gap`, m, apart may end the substep, m.
	double landingDepth( const BlockContact& contact, double gap ) const;
	/// Returns a link's momentum and angular momentum by its multibody's motion; `velocity( part )` gives that of a part.
	template <class Velocity>
	Vector6 linkMomentum( const RigidPart& part, Velocity&& velocity ) const
	{
		const LinkedParts& whole = linked[std::size_t( part.linked )];
		Vector6 sum = Vector6::Zero();
		for ( std::size_t k = 0; k < whole.parts.size(); ++k )
		{
			sum += whole.mass.block<6, 6>( 6 * part.link, 6 * Eigen::Index( k ) ) * velocity( rigid[std::size_t( whole.parts[k] )] );
		}
		return sum;
	}
	/// Calls visit( a, b, coarse body of a, coarse body of b ) for each pair of links, themselves included, the higher coarse body first.
	template <class Visit>
	void forLinkPairs( const LinkedParts& whole, Visit&& visit ) const
	{
		for ( int a = 0; a < int( whole.parts.size() ); ++a )
		{
			for ( int b = 0; b <= a; ++b ) // parts, and so coarse bodies, ascend
			{
				visit( a, b, rigid[std::size_t( whole.parts[std::size_t( a )] )].coarse,
					rigid[std::size_t( whole.parts[std::size_t( b )] )].coarse );
			}
		}
	}
	/// Returns the relative velocity at a contact at the start of the substep, m/s.
	Vec3d velocityBefore( const BlockContact& contact ) const;

private:
	struct NodeBlock
	{
		int part = -1, node = -1;
		int index = -1; ///< of its first component in the vector
		int cluster = -1, slot = -1;
	};
	/// A connected part of a soft body.
	struct ConnectedPart
	{
		int soft = -1, part = 0;
		int coarse = -1; ///< body index in the coarse system, the first of its segments; -1: its nodes are preconditioned alone
		const Segments* segments = nullptr; ///< null: its affine motions stand for it
		bool touches = false;               ///< one of its nodes has a contact
		bool isPressed = false;             ///< one of its contacts has an impulse; of restoreMomentum
	};
	/// Nodes coupled by contacts: a dense block of the preconditioner.
	struct Cluster
	{
		static constexpr int kMost = 2 * SharedNodes::kMost; ///< nodes of a contact between two soft bodies; withSize() lists every size
		int blocks[kMost] = {};
		int count = 0;
		int scratch = 0;                           ///< offset of its matrix in m_clusterStorage
		int inverse = 0;                           ///< offset of its inverse in m_clusterInverse, column-major
		int index[kMost] = {}, stride[kMost] = {}; ///< of each node's first component in the vector, and between components
	};

	/// A contact along the line search from m_v to m_next: u.n at m_v and its change, jt.du at m_v and its change (0 where inactive), and
	/// the normal law. The line search reads it some twenty times; a BlockContact takes half a kilobyte.
	struct LineContact
	{
		double normalStart, normalChange;
		double slideStart, slideChange;
		double normalMultiplier, stiffness, target;
		bool pulls; ///< an attachment
	};

	/// The summed error of the friction on one part against the law, the summed friction limits of its contacts, and the momentum with
	/// which its nodes go on through contacts without an impulse, N s.
	struct PartError
	{
		Vec3d tangent = Vec3d::Zero();
		double limit = 0.0, left = 0.0;
	};
	/// Whether the impulses satisfy the nonlinear law: `all` for the sums over all contacts, `each` for the friction on each part.
	struct Match
	{
		bool all = false, each = false;
	};

	/// A contact of a node with an object of prescribed velocity.
	struct PrescribedContact
	{
		int node = -1; ///< index in m_nodeBlocks
		std::size_t contact = 0;
		int side = 0; ///< of the node
	};

	int size() const override { return m_size; }
	void apply( const float* v, float* to ) override;
	void precondition( const float* r, float* z ) override;
	void moved( float by ) override;

	/// Returns the angular velocity of the connected part that a node belongs to, rad/s.
	const Vec3d& angularVelocityOf( const ContactSide& side );
	void layOut();
	/// Numbers the nodes of contacts as the system has them from here on.
	void compact();
	/// Returns the system of all nodes of a body; its rigid motions alone may be used.
	static ImplicitMotion& wholeOf( SoftPart& part );
	void listConnected();
	/// For a side that is a node.
	const ConnectedPart& connectedOf( const ContactSide& side ) const
	{
		const SoftPart& part = soft[std::size_t( side.soft )];
		return m_connected[std::size_t( part.firstConnected + part.motion->parts().partOf( side.node ) )];
	}
	int registerNode( int part, int node );
	void startFrom( const SoftPart& part );
	void startFromBefore( const SoftPart& part, int node ); ///< a node from its velocity at the start of the substep
	bool isIdle() const;                                    ///< nothing to solve: free flight of bodies that step explicitly
	void registerNodeBlocks();
	void applyMasses( const float* v, float* to );
	void listActive();
	ActiveContact::Side flatSide( const ContactSide& side ) const;
	Vec3d velocityOf( const ContactSide& side, const Vec3d& normal, const float* v ) const;
	/// Difference of the two sides' velocities in `v`, without prescribed ones: of a change.
	Vec3d changeAt( const BlockContact& contact, const float* v ) const;
	Vec3d relativeVelocity( const BlockContact& contact, const float* v ) const;
	void addImpulse( const ContactSide& side, const Vec3d& normal, const Vec3d& impulse, float* to ) const;
	void addPair( const BlockContact& contact, const Vec3d& impulse, float* to ) const;
	/// Returns S v, or v where friction is isotropic; v is tangential.
	Vec3d applyFrictionScale( const BlockContact& contact, const Vec3d& v ) const
	{
		return contact.frictionScale < 0 ? v : Vec3d( frictionScales[std::size_t( contact.frictionScale )] * v );
	}
	/// Returns the derivative of a contact's impulse by its velocity, kg.
	Eigen::Matrix3d resistance( const BlockContact& contact ) const;
	void fillFree();
	/// Iterates from m_v until the impulses satisfy the law.
	void solveLaw( BlockCount& count );
	/// Whether sweeps over the contacts can solve the block: no elastic body, joint or attachment, isotropic friction.
	bool canSweep() const;
	bool sweepContacts( BlockCount& count ); ///< from the last impulses; sets m_v and the impulses, and returns true if these are accurate
	void listSwept();
	ContactSweeps::Side sweptSide( const ContactSide& side );
	void readSwept();
	/// Returns true if the impulses at m_next are accurate enough to stop after `passes` passes.
	bool mayStop( int passes );
	/// Starts the iteration at m_next: adds the linearised contacts to the residual without contacts, b - A v.
	void beginIteration();
	double energyLeft() const;
	/// Iterates m_next until `fraction` of the residual or energyLeft() remains, then reads the contact impulses.
	void iterate( double fraction, BlockCount& count );
	void fillPreconditioner();
	void layOutPreconditioner();
	int coarseOf( const ContactSide& side ) const;
	void layOutCoarse();
	void assignClusters( const BlockContact& contact );
	Eigen::Map<Eigen::MatrixXd> matrixOf( const Cluster& cluster )
	{
		return { m_clusterStorage.data() + cluster.scratch, 3 * cluster.count, 3 * cluster.count };
	}
	void beginClusters();
	void addToClusters( const BlockContact& contact, const Eigen::Matrix3d& contactResistance );
	void invertClusters();
	/// Floats in a column of an inverse, padded to a multiple of four.
	static constexpr int columnOf( int count ) { return ( 3 * count + 3 ) / 4 * 4; }
	template <int count>
	void preconditionCluster( const Cluster& cluster, const float* r, float* z ) const;
	void preconditionClusters( const float* r, float* z ) const;
	void addToPreconditioner( const BlockContact& contact );
	void lockAxes( const RigidPart& part, int body );
	void readSolution();

	// In block_conflicts.cpp.
	/// Makes the targets of each node's contacts with objects of prescribed velocity compatible.
	void reconcileTargets();
	/// Sets BlockContact::carried of each contact.
	void carryImpulses();
	void reconcileTargets( std::size_t first, std::size_t end ); ///< for one node: [first, end) of m_prescribed

	// The law, in contact_law.cpp.
	Vec3d unscaledTangentImpulse( const BlockContact& contact ) const;
	void chooseStiffness();
	double stiffnessForPieces( const BlockContact& contact ) const;
	/// `passes`: the number of passes made so far.
	void linearise( const float* v, int passes );
	bool isUnphysical() const; ///< contacts pull, or friction exceeds its limits by far
	bool leavesApproach();     ///< contacts without an impulse leave nodes a momentum that counts beside the others' impulses
	Match matchAt( const float* v );
	void readImpulses( const float* v );
	/// Returns the fraction of the segment from m_v to m_next at which the energy is lowest.
	double stepTowards();
	double lowestFraction( double slope, double curvature ) const;

	// In block_restitution.cpp.
	/// Work of the contact impulses and the sum of its absolute parts, J.
	struct Work
	{
		double sum = 0.0, moved = 0.0;
	};
	/// Impulses of a contact, N s.
	struct ContactImpulse
	{
		double normal;
		Vec3d tangent;
	};
	Work workOfContacts() const;
	void limitEnergy( BlockCount& count );
	void reduceBounce( BlockCount& count );
	/// Whether all impulses are bounces of bodies that move freely and whose vibrations the step does not resolve.
	bool mayCompleteBounce() const;
	/// Adds to `velocity` the rigid motions of soft parts and rigid bodies with the momentum `momentum`.
	void addRigidMotions( const float* momentum, float* velocity ) const;
	void completeBounce();
	/// Sets m_bounced to the velocities of the rigid motions that are contained in m_v.
	void respondRigidly();
	void fillRigidMotions();
	/// Whether nothing but contacts moves the bodies of the block.
	bool movesFreely() const;
	bool listPressing( int index );
	void bounceAsRigid();
	void bounceAsRigid( const SoftPart& part, int index );
	void rubAsRigid( const SoftPart& part, double friction );
	void addMotion( const SoftPart& part, double factor );

	// In block_momentum.cpp.
	void restoreMomentum();
	/// A connected part of a soft body or a rigid body in a group that touches nothing fixed.
	struct MovingBody
	{
		ImplicitMotion* motion = nullptr; ///< null: a rigid body
		int part = 0;
		RigidPart* rigid = nullptr;
		Vec3d centre = Vec3d::Zero();              ///< world, m
		Matrix6 mass = Matrix6::Zero();            ///< of rigid motions about the centre
		Vector6 missingMomentum = Vector6::Zero(); ///< N s, N m s
	};
	MovingBody movingBodyAt( std::uint32_t k );
	void listGroups( UnionFind& groups, std::uint32_t count );
	void restoreMomentumOf( const std::uint32_t* begin, const std::uint32_t* end );

	int m_size = 0;
	TaskRunner* m_runner = nullptr;
	ConjugateGradients m_gradients;
	ContactSweeps m_sweeps;
	AlignedArray<float> m_v, m_next, m_rightSide, m_scratch;
	AlignedArray<float> m_free, m_freeNext;        ///< b - A v at m_v and at m_next, without contacts
	AlignedArray<float> m_bounced;                 ///< velocities with full restitution, of rigid motions; scratch of block_restitution.cpp
	std::vector<std::size_t> m_pressing;           ///< contacts of one body that press; scratch of bounceAsRigid
	std::vector<ContactImpulse> m_bouncedImpulses; ///< by contact, with full restitution; scratch of reduceBounce
	AlignedArray<float> m_massProduct;             ///< the last product without contacts
	AlignedArray<float> m_inverseDiagonal;         ///< 1 / A_ii of the soft parts' nodes, at the index of their first component
	std::vector<ActiveContact> m_active;           ///< of the last linearisation
	std::vector<LineContact> m_lineContacts;       ///< by contact; scratch of stepTowards
	std::vector<PartError> m_partErrors;           ///< of the soft parts, then of the rigid ones; scratch of matchAt
	std::vector<PrescribedContact> m_prescribed;   ///< by node; scratch of reconcileTargets
	std::vector<NodeBlock> m_nodeBlocks;           ///< the nodes that contacts act on
	std::vector<Cluster> m_clusters;
	std::vector<double> m_clusterStorage;
	AlignedArray<float> m_clusterInverse;
	std::vector<ConnectedPart> m_connected;                  ///< of all soft parts in order
	std::vector<std::uint32_t> m_groupStart, m_groupMembers; ///< scratch of restoreMomentum
	std::vector<MovingBody> m_movingBodies;                  ///< scratch of restoreMomentumOf
	std::vector<int> m_blockOf; ///< by index of a node's first component: index in m_nodeBlocks; -1: no contact acts on it
	CoarseSystem m_coarse;
	bool m_isUnsettled = false, m_hasPreconditioner = false; ///< isUnsettled; laid out for the contacts
	std::vector<int> m_coarseSizes;
	std::vector<CoarseSystem::Pair> m_coarsePairs;
	Eigen::VectorXd m_coarseSums, m_coarseMotion;
	double m_softMass = 0.0;
};

} // namespace pliant
