#pragma once

// Solves the contacts of a block without elastic bodies. Such a block has masses alone: an impulse changes the velocities of its own nodes
// and rigid bodies, and nothing else. So contacts are solved one after the other, each exactly for the present impulses of the others, in
// sweeps over all of them (block Gauss-Seidel; Jean 1999), without the linearisation and the preconditioner of passes.
// docs/design/implicit.md, Sweeps.

#include "world/constants.h"
#include "world/touch/shared_nodes.h"

#include <Eigen/Core>

#include <vector>

namespace pliant {

class ContactSweeps
{
public:
	/// A vector in three components; the fourth is 0, so that two registers hold it.
	using Vec = Eigen::Vector4d;
	using Matrix = Eigen::Matrix<double, 4, 3>;

	/// Response of a rigid body to an impulse.
	struct Rigid
	{
		Vec3d inverseMass = Vec3d::Zero();                        ///< by axis, 1/kg; 0: locked
		Eigen::Matrix3d inverseInertia = Eigen::Matrix3d::Zero(); ///< 1/(kg m^2), world axes
		int at = 0;                                               ///< index of its velocity in `v`; its angular velocity follows
	};
	/// One of the two sides of a contact. Neither nodes nor a rigid body: its velocity is prescribed.
	struct Side
	{
		int count = 0;                       ///< of nodes
		int rigid = -1;                      ///< index in `arms`
		int at[SharedNodes::kMost] = {};     ///< index of each node's velocity in `v`
		double rub[SharedNodes::kMost] = {}; ///< SharedNodes::rub, and press - rub
		double excess[SharedNodes::kMost] = {};
		double inverseMass[SharedNodes::kMost] = {}; ///< 1/kg
	};
	/// The law of contact_law.cpp:  jn = max( 0, ln + k ( b - u.n ) ),  jt = s ( lt - ks ut ),  ks = min( k, mu jn / u_eps ).
	struct Contact
	{
		Side side[2];
		Vec normal = Vec::Zero();
		Vec prescribed = Vec::Zero();                                           ///< relative velocity of prescribed sides, m/s
		double stiffness = 0.0, multiplier = 0.0, target = 0.0, friction = 0.0; ///< k, kg; ln, N s; b, m/s; mu
		Vec tangentMultiplier = Vec::Zero();                                    ///< lt, N s
		/// N s: on entry where to start from, on return the solution.
		double normalImpulse = 0.0;
		Vec tangentImpulse = Vec::Zero();

	private:
		friend class ContactSweeps;
		/// Relative velocity by a unit impulse along the normal: its normal and tangential parts; and the largest by one across it, 1/kg.
		double m_alongResponse = 0.0, m_acrossResponse = 0.0;
		Vec m_slide = Vec::Zero();
		double m_pressFactor = 0.0; ///< 1 / ( 1 + k W )
	};
	struct Result
	{
		int sweeps = 0;
		bool isAccurate = false; ///< false: kMostSweeps were not enough
	};

	/// Starts a new block.
	void clear();
	/// Returns Side::rigid of a contact at `arm`, m from the body's centre of mass.
	int addArm( const Rigid& body, const Vec3d& arm );
	static Vec padded( const Vec3d& a ) { return Vec( a[0], a[1], a[2], 0.0 ); }

	std::vector<int> firstNode; ///< index in `v` of the first node of each soft part
	std::vector<Rigid> rigid;
	std::vector<Contact> contacts;
	/// Velocities, m/s: on entry those without contacts, on return the solution.
	std::vector<Vec> v;

	/// Sweeps until the energy of the changes still to be expected is below that of an error of `fraction` in every impulse, which counts
	/// as `least` at least and as `most` at most, J.
	Result solve( double fraction, double least, double most );

private:
	/// The arm r of a contact on a rigid body: V + W x r its velocity, and I^-1 ( r x j ) what an impulse j adds to W.
	struct Arm
	{
		int at = 0;
		Vec inverseMass = Vec::Zero();
		Matrix velocityOfTurn, turnOfImpulse;
	};

	Eigen::Matrix3d responseOf( const Arm& arm ) const;
	void measureResponse( Contact& contact ) const;
	void addVelocity( const Side& side, const Vec& normal, double sign, Vec& u ) const;
	void push( const Side& side, const Vec& normal, const Vec& impulse );
	void apply( const Contact& contact, const Vec& impulse );
	double sweep( double relaxation );
	double storedEnergy() const;

	std::vector<Arm> m_arms;
};

} // namespace pliant
