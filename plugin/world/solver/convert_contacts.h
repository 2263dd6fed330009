#pragma once

// Conversion of manifolds to ContactSolver's rows, one contact at a time.

#include "pliant/contact_solver.h"
#include "world/solver/contact_rows.h"

namespace pliant {

struct ContactSolver::Conversion
{
	/// One of the two objects: a node, a rotating body or a static object.
	struct Side
	{
		btCollisionObject* object;
		int point;                        ///< 0: none
		int solverBody;                   ///< Bullet's index of an object other than a node
		btSolverBody* body;               ///< of a rotating body, else null
		const btVector3* angularVelocity; ///< rad/s; of a node with its body's rotation (FrictionTorqueCorrection), else null
	};

	/// The direction in which a row acts. `axis` is the direction on the row's first: on a node, or on the rotating body.
	struct Lever
	{
		btVector3 axis, cross, angular; ///< n, r x n, I^-1 ( r x n )
		btScalar inverse;               ///< of both along the axis, 1 / kg
	};

	ContactSolver& solver;
	ContactRows& rows;
	const btContactSolverInfo& info;

	// State of the present contact.
	btManifoldPoint* point = nullptr;
	Side a{}, b{};
	RowPosition position{};
	btVector3 arm = btVector3( 0, 0, 0 ); ///< lever arm of the rotating body, m

	bool convert( btPersistentManifold& manifold );
	void revert();

private:
	bool findSide( btCollisionObject& object, Side& side );
	bool isHeld( const Side& side ) const;
	void convertBulletContact( btPersistentManifold& manifold );
	void convertPoint();
	int firstPoint() const { return a.point > 0 ? a.point : b.point; } ///< nodes of the present contact
	int secondPoint() const { return a.point > 0 ? b.point : 0; }      ///< or the placeholder
	const Side* rotatingSide() const { return a.body ? &a : b.body ? &b : nullptr; }
	const NodePoint& pointOf( const Side& side ) const { return rows.points[std::size_t( side.point )]; }
	btVector3 velocityOf( const Side& side ) const;
	/// From the object's origin to the contact point, m.
	btVector3 armOf( const Side& side ) const
	{
		return ( &side == &a ? point->getPositionWorldOnA() : point->getPositionWorldOnB() ) - side.object->getWorldTransform().getOrigin();
	}
	/// A node's velocity along a row.
	btScalar along( const Side& side, const btVector3& axis ) const
	{
		const btScalar moves = axis.dot( pointOf( side ).velocity );
		return side.angularVelocity ? moves + armOf( side ).cross( axis ).dot( *side.angularVelocity ) : moves;
	}
	void findLever( const btVector3& normal, Lever& lever ) const;
	btScalar approach( const Lever& lever, bool withTorque ) const;
	btScalar bounce() const;
	void warmStart( const Lever& lever, btScalar impulse );
	void chooseDirections();
	void addFrictionRow( const btVector3& direction, int which, btScalar wanted, btScalar cfm );
	void write( const Lever& lever, RowData data, int which );
};

} // namespace pliant
