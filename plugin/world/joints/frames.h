#pragma once

// Frames: rigid bodies that move with patches of soft bodies, for Bullet's joints. A frame's rigid body has the mobility of its patch and
// no mass in addition.
//
//   V = B^T v,   B = m ( 1 / M + I^-1 r x ) the distribution of an impulse at the frame over the patch's nodes
//   W = B^T A^-1 B the mobility: the velocity that unit impulses and angular impulses on the frame give it within the substep, with A the
//   masses of an explicit body, and the matrix of an implicit one, whose elasticity lets the whole body follow
//
// The joints of frames are solved before Bullet's solver, with W and the masses of the rigid bodies on the joints. A rigid body of Bullet's
// has a mobility D without coupling; D = s diag( W ), s the least factor for which D - W is positive, so that no joint overshoots. It gets
// the velocity V - D P, P the solved impulse, and Bullet's solver finds P again and what contacts of the other bodies change in it. The
// smoothed force of the joints acts on the patch in the next substep, like gravity. docs/design/attachments.md.

#include "body/implicit/implicit_motion.h"
#include "lattice/lattice.h"
#include "world/joints/joint_mobility.h"

#include <Eigen/Geometry>

#include <functional>
#include <memory>
#include <vector>

class btCollisionObject;
class btCollisionShape;
struct btContactSolverInfo;
class btDiscreteDynamicsWorld;
class btRigidBody;

namespace pliant {

class SoftBody;
class TaskRunner;

struct Frame
{
	struct Node
	{
		int node = -1;
		Vec3d rest = Vec3d::Zero(); ///< in the frame, m
	};
	Frame();
	Frame( Frame&& ) noexcept;
	Frame& operator=( Frame&& ) noexcept;
	~Frame();

	SoftBody* body = nullptr; ///< null: the patch no longer exists, and the rigid body is an ordinary one
	std::unique_ptr<btCollisionShape> shape;
	std::unique_ptr<btRigidBody> rigid;
	int rigidIndex = -1; ///< last known index in the world's list of objects
	bool isInWorld = true;
	double radius = 0.0;          ///< of the patch, m
	Vec3d middle = Vec3d::Zero(); ///< of the patch, in the frame, m
	std::vector<Node> patch;

	Vec3d at = Vec3d::Zero(); ///< the frame's origin, world, m: Bullet's is rounded
	Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
	Vec3d mean = Vec3d::Zero();                        ///< from the origin to the patch's centre of mass, world, m
	double mass = 0.0;                                 ///< of the patch, kg
	Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero(); ///< of the patch about its centre of mass, kg m^2
	Vector6 force = Vector6::Zero();                   ///< smoothed: of joints on the patch about the origin, N and N m
	std::vector<float> response;                       ///< A^-1 B, six vectors, of an implicit body
	Matrix6 mobility = Matrix6::Zero();                ///< W
	Vector6 impulse = Vector6::Zero();                 ///< of the joints in this pass as expected, N s and N m s
	Vector6 unseen = Vector6::Zero();                  ///< learnt: of what Bullet's solver finds beyond the rows of its joints, N and N m
	Vector6 given = Vector6::Zero();                   ///< the velocity that Bullet's solver got
	bool isSolved = false;                             ///< Bullet's solver has it in this pass

	/// Copies the data that a pass changes from another frame: all but the objects.
	void copyState( const Frame& from );

	// The piece that gets the frame while its body breaks.
	SoftBody* claimant = nullptr;
	std::vector<Node> claimedPatch;
};

class Frames
{
public:
	/// Makes a frame of the nodes within `radius` of `at`, world, m. Returns null where they lie on a line.
	btRigidBody* add( btDiscreteDynamicsWorld& world, SoftBody& body, const Vec3d& at, double radius );
	/// Removes the frame and its joints from the world and deletes it. Returns false if it is no frame.
	bool remove( btDiscreteDynamicsWorld& world, const btRigidBody& rigid );
	void removeAll( btDiscreteDynamicsWorld& world );
	/// An object leaves the world: a soft body's frames become ordinary rigid bodies, a frame itself stays until it is removed.
	void forget( const btCollisionObject& object, const btDiscreteDynamicsWorld& world );
	bool isEmpty() const { return m_frames.empty(); }
	std::vector<Frame>& all() { return m_frames; }
	const std::vector<Frame>& all() const { return m_frames; }
	const Frame* find( const btRigidBody& rigid ) const;
	bool has( const SoftBody& body ) const; ///< frames of it
	/// The rigid bodies that joints connect with frames, until the next call.
	const std::vector<const btCollisionObject*>& partners( const btAlignedObjectArray<btTypedConstraint*>& joints );
	/// Makes the frame of a rigid body the one with this number, in a saved state; `body`: null if its patch no longer existed.
	void restore( std::size_t number, const btRigidBody& rigid, const Frame& state, SoftBody* body, const btDiscreteDynamicsWorld& world );
	/// Gives the rigid bodies their masses again when all are restored.
	void restoreMobilities();

	// One pass, for the frames of one body.
	void place( const SoftBody& body );      ///< where its patch is
	void press( SoftBody& body, bool isOn ); ///< adds the forces of the joints to the nodes', or takes them out again
	void begin( const btAlignedObjectArray<btTypedConstraint*>& joints ); ///< of a pass
	/// Velocities of an implicit body's nodes by impulses on them, as arrays of three components; `velocity` is the initial guess.
	using Response = std::function<void( const float* impulse, float* velocity )>;
	/// Before Bullet's solver: mobilities and velocities.
	void measureMobility( SoftBody& body, const Response& response, TaskRunner* runner );
	/// Solves the joints of the measured frames, each group with all bodies that joints connect, and applies the impulses to the patches.
	/// `touches`: by index in the world, whether a rigid body touches something.
	void solve( const btAlignedObjectArray<btTypedConstraint*>& joints, const std::vector<unsigned char>& touches,
		const btContactSolverInfo& info );
	void give(); ///< to Bullet's solver: the velocities of the measured frames
	/// Lets Bullet's solver take more iterations for the joints of measured frames, where the game has set none: a frame's rigid body is
	/// light, and what the joints lack in impulse moves the whole patch.
	void raiseIterations( const btAlignedObjectArray<btTypedConstraint*>& joints, const btContactSolverInfo& info );
	void restoreIterations( const btAlignedObjectArray<btTypedConstraint*>& joints );
	void after( SoftBody& body, double h );
	void hold( const SoftBody& body ); ///< the same for a body that is static, kinematic or in quarantine: its frames cannot be moved

	/// After a change of levels: chooses the patches again. Thread-safe for different bodies.
	void follow( const SoftBody& body, const btDiscreteDynamicsWorld& world );
	/// While a body breaks: notes the part of the patches that a piece has, by node of the parent (kNoNode: not in the piece); settle()
	/// gives each frame to the piece with most of it.
	void claim( const SoftBody& parent, SoftBody& piece, const std::vector<std::uint32_t>& nodeNow );
	void settle( const SoftBody& parent, const btDiscreteDynamicsWorld& world );

private:
	/// The measured frames of each soft body, without the force that acts on them, N.
	std::vector<JointGroup::Compliant> coupledPatches( double h ) const;
	template <class F>
	void forFramesOf( const SoftBody& body, F&& visit )
	{
		for ( Frame& frame : m_frames )
		{
			if ( frame.body == &body )
			{
				visit( frame );
			}
		}
	}

	std::vector<Frame> m_frames; ///< in the order in which they were made
	std::vector<const btCollisionObject*> m_partners;
	std::vector<btTypedConstraint*> m_raised; ///< joints with more iterations in this pass
};

} // namespace pliant
