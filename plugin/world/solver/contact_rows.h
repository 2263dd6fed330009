#pragma once

// Constraint rows of ContactSolver: normal and friction impulses at contacts of nodes. Two rows that share no body may be solved in either
// order, with identical bits. So rows between nodes, and rows of a node and a static object, are arranged in groups of four, no two of a
// group with a common body, and none before a row that Bullet solves earlier for one of its bodies; a group is solved at once.

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

/// A contact proxy during the solve: it moves equally along all axes, and has neither spin nor forces.
struct NodePoint
{
	btVector3 velocity;     ///< before the solve, m/s
	btVector3 pushVelocity; ///< push-out velocity, m/s
	btRigidBody* body;
	btScalar inverseMass; ///< 1 / kg
	int step;             ///< last step that moves it
};

/// Coefficients of a row of any kind.
struct RowData
{
	btVector3 normal;       ///< on the first; its negative acts on the second
	btScalar effectiveMass; ///< Bullet's m_jacDiagABInv
	btScalar rhs, cfm, impulse;
	btScalar friction; ///< limit as a fraction of the normal impulse
};

/// Four rows between nodes, or (b is unused) of nodes and static objects.
struct FourRows
{
	Lanes normal[3];
	Lanes effectiveMass, inverseA, inverseB, rhs, cfm, impulse, friction;
	double inverseEffectiveMass[kRowLanes]; ///< 1 / effectiveMass, in double precision as in Bullet
	int a[kRowLanes], b[kRowLanes];

	void set( int lane, const RowData& data, int pointA, btScalar inverseOfA, int pointB, btScalar inverseOfB );
};

/// A row of a node and a rotating body. `normal` and the vectors derived from it act on that body.
struct RotatingRow
{
	btVector3 normal, cross, angular; ///< n, r x n, I^-1 ( r x n )
	btScalar effectiveMass, rhs, cfm, impulse, friction;
	btScalar inverseMass; ///< of the node
	int point, body;
	bool isBodyFirst; ///< in Bullet's order of the two
	double inverseEffectiveMass;
};

/// Kinds of contact rows.
enum class RowKind : unsigned char
{
	Static,   ///< a node and a static object
	Pair,     ///< two nodes
	Rotating, ///< a node and a rotating body
	Bullet    ///< no node: Bullet's own row
};

struct RowPosition
{
	RowKind kind;
	int at; ///< slot number (group times kRowLanes plus lane) in groups of four; otherwise index of a row, Bullet's own among them
};

struct ContactRows
{
	/// Rows solved in sequence: groups, rotating rows or Bullet's rows from `first` to `last` - 1.
	struct Run
	{
		RowKind kind;
		int first, last;
	};
	std::vector<Run> runs;
	/// Normal rows; friction rows have the same numbers times `directions`.
	std::vector<FourRows> normalRows[2], frictionRows[2];
	std::vector<RotatingRow> rotatingNormalRows, rotatingFrictionRows;
	int directions = 1;

	std::vector<NodePoint> points; ///< the first is a placeholder for no node
	std::vector<btVector3> change; ///< velocity change of the nodes, m/s

	/// All contact points that have rows, except Bullet's own.
	struct Contact
	{
		btManifoldPoint* point;
		RowPosition position;
	};
	std::vector<Contact> contacts;
	/// Rows to be pushed out of penetrations, in Bullet's order, including Bullet's own.
	struct Deep
	{
		RowPosition position;
		btScalar rhs, impulse;
	};
	std::vector<Deep> deep;

	void clear( int directionCount );
	int addPoint( btRigidBody& body );
	/// Allocates a slot after all rows that move these nodes; a row with a static object has no `b`.
	RowPosition allocate( RowKind kind, int a, int b );
	/// Appends a step.
	void addStep( RowKind kind, int at );

	// Solve the rows of a run other than Bullet's. `worst` is raised to their squared residuals.
	void solveNormalRun( const Run& run, btSolverBody* bodies, Lanes& worst );
	void solveFrictionRun( const Run& run, btSolverBody* bodies, Lanes& worst );
	/// Returns the row's residual, m/s.
	btScalar pushOut( Deep& out, btSolverBody* bodies );
	/// Copies the impulses to the contact points.
	void writeImpulses() const;
	/// Copies velocities, and with `isSplit` positions, to the bodies.
	void writeVelocities( bool isSplit, btScalar timeStep ) const;

private:
	struct OpenGroups
	{
		std::vector<int> step, filled; ///< of each group
		std::size_t first = 0;         ///< no group before it has a free lane
	};
	OpenGroups m_openGroups[2];
	int m_stepCount = 0;
};

} // namespace pliant
