#pragma once

// How rigid bodies on Bullet's joints give way, for solutions that are made before Bullet solves the joints. A body that hangs on a joint
// takes impulses with more than its mass; a solution that knows the mass alone is told so only by what the joint undoes, a substep later,
// and swings up where what is attached is heavier than the body.
//
// With J the rows of the joints that hold (v_A, w_A, v_B, w_B to the velocity along the row), M the masses of all bodies that are joined to
// each other, and b the velocities that the joints want:
//
//   W  = M^-1 - M^-1 J^T ( J M^-1 J^T + C )^-1 J M^-1          what an impulse gives to the bodies once the joints have answered
//   V0 = V + h M^-1 F + M^-1 J^T ( J M^-1 J^T + C )^-1 ( b - J ( V + h M^-1 F ) )

#include "lattice/lattice.h"

#include <LinearMath/btAlignedObjectArray.h>

#include <Eigen/Dense>

#include <vector>

class btRigidBody;
class btTypedConstraint;

namespace pliant {

/// Bodies that joints join to each other.
class JointGroup
{
public:
	using Joints = btAlignedObjectArray<btTypedConstraint*>;
	using Vector6 = Eigen::Matrix<double, 6, 1>;

	/// An impulse and angular impulse at a body's centre of mass that joints are about to carry, N s, N m s.
	struct Load
	{
		const btRigidBody* body;
		Vector6 impulse;
	};

	/// Whether a joint that is enabled holds the body, which can move along and about all axes.
	static bool isHeld( const btRigidBody& body, const Joints& joints );
	/// Collects what a body is joined to, over any number of joints, and the rows of the joints for a substep of h, s. A motor counts as
	/// holding where `loads` take less than half of its limit. Returns false for a group that is too large.
	bool collect( btRigidBody& body, const Joints& joints, const std::vector<Load>& loads, double h, double erp );
	/// Whether a body is in the group.
	bool contains( const btRigidBody& body ) const { return indexOf( &body ) >= 0; }
	/// W of some of the bodies: six rows and columns each, velocity of the mass centre before angular velocity.
	Eigen::MatrixXd mobilityOf( const std::vector<const btRigidBody*>& some ) const;
	/// Adds W P to the velocities of all bodies of the group: what impulses P give to them once the joints have answered. The joints'
	/// answers are kept for `tellJoints`.
	void strike( const std::vector<Load>& impulses );
	/// After Bullet's solver: adds the answers to the joints' impulses and feedback. A joint breaks whose own limit one of them exceeds.
	void tellJoints() const;
	/// V0 of a body: its velocity after the substep if nothing but forces and the joints that hold acts on the group, m/s, rad/s.
	Vector6 freeVelocityOf( const btRigidBody& body ) const;

private:
	struct Rows;
	int indexOf( const btRigidBody* body ) const;
	void addBodies( btRigidBody& body, const Joints& joints );
	void addRows( btTypedConstraint& joint, const std::vector<Load>& loads );
	void finish();

	double m_h = 0.0, m_erp = 0.0;
	std::vector<btRigidBody*> m_bodies;
	Eigen::MatrixXd m_rows;       ///< J
	Eigen::VectorXd m_wanted;     ///< b, m/s or rad/s
	Eigen::VectorXd m_softness;   ///< diagonal of C
	Eigen::MatrixXd m_inverse;    ///< M^-1
	Eigen::MatrixXd m_whole;      ///< W
	Eigen::VectorXd m_velocities; ///< V0
	Eigen::MatrixXd m_answer;     ///< to impulses on the bodies, by row of J: - ( J M^-1 J^T + C )^-1 J M^-1
	Eigen::VectorXd m_answers;    ///< to the impulses of `strike`, N s or N m s
	std::vector<btTypedConstraint*> m_jointOfRow;
};

} // namespace pliant
