#pragma once

// The mobility of rigid bodies on Bullet's joints, for solutions that are computed before Bullet solves the joints. A body on a joint
// resists impulses with more than its mass. A solution that uses the mass alone sees the joint's impulse one substep later, and what is
// attached to the body swings up if it is heavier than the body.
//
// With J the rows of the joints that hold (v_A, w_A, v_B, w_B to the velocity along the row), M the masses of all bodies that joints
// connect, C the joints' softness (cfm), and b the joints' target velocities:
//
//   W  = M^-1 - M^-1 J^T ( J M^-1 J^T + C )^-1 J M^-1          velocities of the bodies by an impulse and the joints' impulses that follow
//   V0 = V + h M^-1 F + M^-1 J^T ( J M^-1 J^T + C )^-1 ( b - J ( V + h M^-1 F ) )

#include "lattice/lattice.h"

#include <LinearMath/btAlignedObjectArray.h>

#include <Eigen/Dense>

#include <vector>

struct btContactSolverInfo;
class btRigidBody;
class btTypedConstraint;

namespace pliant {

/// Rigid bodies that joints connect, directly or through other bodies.
class JointGroup
{
public:
	using Joints = btAlignedObjectArray<btTypedConstraint*>;
	using Vector6 = Eigen::Matrix<double, 6, 1>;

	/// An impulse and angular impulse at a body's centre of mass, N s, N m s.
	struct Load
	{
		const btRigidBody* body;
		Vector6 impulse;
	};

	/// Bodies with a mobility other than that of their masses: the frames of a soft body.
	struct Compliant
	{
		std::vector<const btRigidBody*> bodies;
		Eigen::MatrixXd mobility;   ///< six rows and columns for each body
		Eigen::VectorXd velocities; ///< six for each body, in the present substep, m/s, rad/s
	};

	/// Whether an enabled joint holds the body, and none of its axes is locked.
	static bool isHeld( const btRigidBody& body, const Joints& joints );
	/// Collects the bodies that joints connect with a body, and the rows of these joints for a substep of h, s. `loads`: the impulses that
	/// the joints will carry; a motor counts as holding if they are less than half of its limit. Returns false for a group that is too
	/// large.
	bool collect( btRigidBody& body, const Joints& joints, const std::vector<Load>& loads, double h, double erp );
	/// The same with the mobility and velocities of some bodies given, and with all rows of the joints: solves for the impulses of this
	/// substep within the rows' limits. Bodies whose flag in `touches`, by their index in the world, is set go on at their velocity, since
	/// what they touch counts too. `compliant` and `touches` must live as long as the group.
	bool collectCompliant( btRigidBody& body, const Joints& joints, const std::vector<Compliant>& compliant,
		const std::vector<unsigned char>& touches, const btContactSolverInfo& info );
	/// After `collectCompliant`: impulse and angular impulse of the joints on a body, N s, N m s.
	Vector6 jointImpulseOn( const btRigidBody& body ) const;
	/// Whether a body is in the group.
	bool contains( const btRigidBody& body ) const { return indexOf( &body ) >= 0; }
	/// Returns W of some of the bodies: six rows and columns for each, velocity of the mass centre before angular velocity.
	Eigen::MatrixXd mobilityOf( const std::vector<const btRigidBody*>& some ) const;
	/// Adds W P to the velocities of all bodies of the group for impulses P, and keeps the joints' impulses for `reportImpulses`.
	void applyImpulses( const std::vector<Load>& impulses );
	/// After Bullet's solver: adds the kept impulses to the joints' own and to their feedback. A joint breaks if one of them alone exceeds
	/// its limit.
	void reportImpulses() const;
	/// Returns V0 of a body: its velocity after the substep by forces and the joints that hold alone, m/s, rad/s.
	Vector6 freeVelocityOf( const btRigidBody& body ) const;

private:
	struct Rows;
	int indexOf( const btRigidBody* body ) const;
	void addBodies( btRigidBody& body, const Joints& joints );
	void addCoupledFrames( const btRigidBody& body );
	bool gather( btRigidBody& body, const Joints& joints, const std::vector<Load>& loads );
	void addRows( btTypedConstraint& joint, const std::vector<Load>& loads );
	void setMasses();
	void finish();
	void solveWithinLimits();

	double m_h = 0.0, m_erp = 0.0;
	int m_iterations = 1;                                ///< of Bullet's solver, which some joints divide by
	double m_damping = 1.0;                              ///< btContactSolverInfo::m_damping
	const std::vector<Compliant>* m_compliant = nullptr; ///< null: all bodies have the mobility of their masses
	const std::vector<unsigned char>* m_touches = nullptr;
	std::vector<btRigidBody*> m_bodies;
	Eigen::MatrixXd m_rows;          ///< J
	Eigen::VectorXd m_targets;       ///< b, m/s or rad/s
	Eigen::VectorXd m_softness;      ///< diagonal of C
	Eigen::VectorXd m_low, m_high;   ///< limits of the rows' impulses, N s or N m s
	Eigen::MatrixXd m_inverse;       ///< M^-1
	Eigen::MatrixXd m_mobility;      ///< W
	Eigen::VectorXd m_velocities;    ///< V0
	Eigen::MatrixXd m_jointResponse; ///< - ( J M^-1 J^T + C )^-1 J M^-1: the joints' impulses by impulses on the bodies
	Eigen::VectorXd m_jointImpulses; ///< by row, of the last `applyImpulses`, N s or N m s
	std::vector<btTypedConstraint*> m_jointOfRow;
};

} // namespace pliant
