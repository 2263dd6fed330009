#pragma once

// Rows of ContactSolver: what presses and rubs at contacts of nodes. Two rows that share no body may be solved in either order, to the same
// bits. So rows between nodes, and of a node and what stands, are laid four side by side, no two of four with a body in common and none
// before one that Bullet solves earlier on a body of its; those four are solved at once.

#include <BulletCollision/NarrowPhaseCollision/btManifoldPoint.h>
#include <BulletDynamics/ConstraintSolver/btSolverBody.h>

#include <cstddef>
#include <type_traits>
#include <vector>

namespace pliant {

inline constexpr int kRowLanes = 4;

using Lanes = btScalar __attribute__( ( vector_size( kRowLanes * sizeof( btScalar ) ) ) );
using LaneMask = std::conditional_t<sizeof( btScalar ) == 4, int, long long> __attribute__( (
	vector_size( kRowLanes * sizeof( btScalar ) ) ) );

/// A stand-in for a node, while the solver is at work: it moves alike along all axes, has no spin and no force on it.
struct Point
{
	btVector3 speed; ///< that it came with, m/s
	btVector3 push;  ///< out of what it is in, m/s
	btRigidBody* body;
	btScalar inverse; ///< 1 / kg
	int step;         ///< the last that moves it
};

/// What a row asks for and may take, of whichever kind.
struct Ask
{
	btVector3 normal;  ///< of the first; against it on the second
	btScalar perSpeed; ///< Bullet's m_jacDiagABInv
	btScalar rhs, cfm, impulse;
	btScalar friction; ///< share of what presses
};

/// Four rows between points, or (b is nobody) of a point and what stands.
struct FourRows
{
	Lanes normal[3];
	Lanes perSpeed, inverseA, inverseB, rhs, cfm, impulse, friction;
	double perImpulse[kRowLanes]; ///< 1 / perSpeed, in double, as Bullet has it
	int a[kRowLanes], b[kRowLanes];

	void set( int lane, const Ask& ask, int pointA, btScalar inverseOfA, int pointB, btScalar inverseOfB );
};

/// A row of a point and a body that turns. `normal` and what is made of it act on that body.
struct RollingRow
{
	btVector3 normal, cross, angular; ///< n, r x n, I^-1 ( r x n )
	btScalar perSpeed, rhs, cfm, impulse, friction;
	btScalar inverse; ///< of the point
	int point, body;
	bool isBodyFirst; ///< of the two, to Bullet
	double perImpulse;
};

/// Where a contact's rows are.
enum class RowKind : unsigned char
{
	Alone,   ///< a point and what stands
	Pair,    ///< two points
	Turning, ///< a point and what turns
	Bullets  ///< no point: Bullet's own
};

struct RowPosition
{
	RowKind kind;
	int at; ///< times kRowLanes and the lane where there are four; Bullet's number
};

struct ContactRows
{
	/// What is solved one after the other: fours, turning rows or Bullet's from `first` to before `last`.
	struct Run
	{
		RowKind kind;
		int first, last;
	};
	std::vector<Run> runs;
	/// Rows that press; those that rub have the same numbers, times `directions`.
	std::vector<FourRows> press[2], rub[2];
	std::vector<RollingRow> turnPress, turnRub;
	int directions = 1;

	std::vector<Point> points;     ///< the first is nobody
	std::vector<btVector3> change; ///< of the points' speeds, m/s

	/// All points of contact that have rows, but for Bullet's own.
	struct Contact
	{
		btManifoldPoint* point;
		RowPosition place;
	};
	std::vector<Contact> contacts;
	/// Those that are to be pushed out, in Bullet's order, his own among them.
	struct Deep
	{
		RowPosition place;
		btScalar rhs, impulse;
	};
	std::vector<Deep> deep;

	void clear( int directionCount );
	int addPoint( btRigidBody& body );
	/// A place after all that moves these points; of `b` there is none in a row alone.
	RowPosition place( RowKind kind, int a, int b );
	/// The next step.
	void addStep( RowKind kind, int at );

	// A run's rows, none of Bullet's. `worst` becomes what they were off by, squared, where that is more.
	void pressRun( const Run& run, btSolverBody* bodies, Lanes& worst );
	void rubRun( const Run& run, btSolverBody* bodies, Lanes& worst );
	/// Returns what the row was off by, m/s.
	btScalar pushOut( Deep& out, btSolverBody* bodies );
	/// Impulses to the points of contact.
	void giveBackImpulses() const;
	/// Speeds, and with `isSplit` places, to the bodies.
	void restoreVelocities( bool isSplit, btScalar timeStep ) const;

private:
	struct Open
	{
		std::vector<int> step, filled; ///< of each four
		std::size_t first = 0;         ///< none before it has room
	};
	Open m_open[2];
	int m_stepCount = 0;
};

} // namespace pliant
