#pragma once

// Solves the contacts of a block without elastic bodies. Such a block has masses alone: an impulse changes the velocities of its own nodes
// and rigid bodies, and nothing else. So contacts are solved one after the other, each exactly for the present impulses of the others, in
// sweeps over all of them (block Gauss-Seidel; Jean 1999), without the linearisation and the preconditioner of passes.
// docs/design/implicit.md, Sweeps.

#include "world/linear/active_contact.h"

#include <vector>

namespace pliant {

class ContactSweeps
{
public:
	/// What an impulse does to a rigid body.
	struct Rigid
	{
		Vec3d inverseMass = Vec3d::Zero();                        ///< by axis, 1/kg; 0: locked
		Eigen::Matrix3d inverseInertia = Eigen::Matrix3d::Zero(); ///< 1/(kg m^2), world axes
	};
	/// The law of contact_law.cpp:  jn = max( 0, ln + k ( b - u.n ) ),  jt = s ( lt - ks ut ),  ks = min( k, mu jn / u_eps ).
	struct Contact
	{
		ActiveContact::Side side[2];
		int rigid[2] = { -1, -1 };                      ///< index in `rigid`
		double inverseMass[2][SharedNodes::kMost] = {}; ///< of each node, 1/kg
		Vec3d normal = Vec3d::Zero();
		Vec3d prescribed = Vec3d::Zero();                                       ///< relative velocity of prescribed sides, m/s
		double stiffness = 0.0, multiplier = 0.0, target = 0.0, friction = 0.0; ///< k, kg; ln, N s; b, m/s; mu
		Vec3d tangentMultiplier = Vec3d::Zero();                                ///< lt, N s
		/// N s: on entry where to start from, on return the solution.
		double normalImpulse = 0.0;
		Vec3d tangentImpulse = Vec3d::Zero();
		/// Relative velocity by a unit impulse along the normal, and at most by one across it, 1/kg.
		double alongResponse = 0.0, acrossResponse = 0.0;
	};
	struct Result
	{
		int sweeps = 0;
		bool isAccurate = false; ///< false: kMostSweeps were not enough
	};

	std::vector<Rigid> rigid;
	std::vector<Contact> contacts;
	/// Velocities, by the indices of the contacts' sides, m/s: on entry those without contacts, on return the solution.
	std::vector<double> v;

	/// Sweeps until the energy of the changes still to be expected is below that of an error of `fraction` in every impulse, which counts
	/// as `least` at least and as `most` at most, J.
	Result solve( double fraction, double least, double most );

private:
	void measureResponse( Contact& contact ) const;
	void push( const Contact& contact, int side, const Vec3d& impulse );
	void apply( const Contact& contact, const Vec3d& impulse );
	Vec3d velocity( const Contact& contact ) const;
	double press( Contact& contact, const Vec3d& u, double relaxation );
	double rub( Contact& contact, const Vec3d& u, double pushed, double relaxation );
	double sweep( double relaxation );
	double storedEnergy() const;
};

} // namespace pliant
