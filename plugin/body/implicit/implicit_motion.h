#pragma once

// One body's contribution to an implicit substep: the linear system for its new velocities, with the matching force linearised in them.
// docs/design/implicit.md. Contains no contacts: the solver of several bodies adds them to the system.
//
//   A v = b,   A = m ( 1 + gamma alpha K + h c ( 1 - P ) ),   K = ( 1 + kappa |m| ) ( 1 - P ) + kappa V,   gamma = ( 1 + sigma ) / 2
//   b = m ( v* + alpha e d / h ) + m ( gamma - sigma ) alpha K v*,   v* = v + h ( g + f / m ),   |m| the largest change of volume
//
// A node drawn toward a velocity u (node_pull.h) adds m gain to its diagonal entry of A and m gain u to b.
//
// sigma is Material::numericalDamping, c Material::damping, alpha = E h^2 / ( rho d^2 mu ) of any size, 1 - P of StrainRates.

#include "body/implicit/node_pull.h"
#include "body/implicit/segments.h"
#include "matching/implicit/strain_rates.h"
#include "matching/node_state.h"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace pliant {

class LatticeMatcher;
class TaskRunner;

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
/// An affine motion v = V + L p, p relative to the mass centre: V, then the columns of L.
using Vector12 = Eigen::Matrix<double, 12, 1>;
using Matrix12 = Eigen::Matrix<double, 12, 12>;

/// The vector of a node in an array of three components.
inline Eigen::Vector3d nodeVector( const float* values, int padded, int node )
{
	return { double( values[node] ), double( values[padded + node] ), double( values[2 * padded + node] ) };
}

struct ImplicitStep
{
	float h = 0.0f;
	float alpha = 0.0f;
	float damping = 0.0f;          ///< 1/s
	float numericalDamping = 1.0f; ///< sigma
	float volumeKeeping = 0.0f;    ///< kappa
	double secondMoment = 0.0;     ///< of a full region, per axis and mass, m^2
	double cellMoment = 0.0;       ///< of a cell of the lattice, per axis and mass, m^2
};

/// How a connected part turns within an implicit substep.
struct PartTurn
{
	double angle = 0.0;                                  ///< rad
	bool isArc = false;                                  ///< along an arc, or else along tangents
	Eigen::Matrix3d moved = Eigen::Matrix3d::Identity(); ///< what that does to its nodes' positions
	Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

class ImplicitMotion
{
public:
	/// `pushed`: the nodes' velocities plus the changes by matching; nodes.v: those of free flight, v*; both as long as `size`. `pull` must
	/// live as long as `nodes`.
	void begin( LatticeMatcher& matcher, NodeState& nodes, const float* pushed, const ImplicitStep& step, const NodePull& pull,
		TaskRunner* runner );
	/// Starts a substep of a body moved by its contacts only: G = 0, b = m v. Nothing but nodes() may be read before measureFree().
	void beginFree( NodeState& nodes );
	/// The same, with all that is read of it. `parts`: must live as long as the nodes; null: one part.
	void measureFree( NodeState& nodes, const ConnectedParts* parts );
	/// Measures nothing but the rigid motions: rigidMass(), centre(), isHeld(), momentum() and addMotion() may be called then.
	void measureRigid( NodeState& nodes, const ConnectedParts* parts );

	/// Floats of a velocity vector: three components, each padded to whole lanes.
	int size() const { return 3 * m_nodes->padded; }
	int padded() const { return m_nodes->padded; }
	const NodeState& nodes() const { return *m_nodes; }
	NodeState& nodes() { return *m_nodes; }
	const float* rightSide() const { return m_rightSide.data(); }
	/// to = A v; rows of pinned nodes are 0.
	void apply( const float* v, float* to, TaskRunner* runner );
	/// The mean of A's three diagonal entries of a node, kg.
	float diagonal( int node ) const;
	bool isElastic() const { return m_stiffness > 0.0f; }
	/// G; 0 for a body that takes part with its masses alone.
	float stiffness() const { return m_stiffness; }
	double gamma() const { return double( m_gamma ); } ///< ( 1 + sigma ) / 2 of the substep
	/// The segments of a body whose nodes are the cells of `lattice`, measured at the start of the substep; null where affine motions of
	/// the whole do as well: for small, soft and compact bodies, and those in several parts.
	const Segments* segments( const Lattice& lattice );
	bool hasHeldNodes() const { return m_hasHeldNodes; }

	// A body whose cells form several parts moves as so many: the following refers to one of them, or to the whole body where it is in one.
	const ConnectedParts& parts() const { return m_rates.parts(); }
	/// Whether some node of a part is pinned, or drawn from outside.
	bool isHeld( int part ) const { return m_isHeld[std::size_t( part )] != 0; }
	/// Whether a part is more than a point: a part of one node has no affine preconditioner.
	bool hasShape( int part ) const { return !parts().areSeveral() || parts().size( part, m_nodes->count ) > 1; }

	// Rigid motions ( V, Omega ) about the mass centre, for which A is the mass alone.
	Matrix6 rigidMass( int part = 0 ) const;
	/// The rigid motion of a part that has a momentum and an angular momentum about its centre.
	Vector6 rigidMotion( const Vector6& momentum, int part = 0 ) const;
	/// Momentum of the current node velocities, and their angular momentum about the centre.
	Vector6 momentum( int part = 0 ) const;
	const Eigen::Vector3d& centre( int part = 0 ) const { return m_rates.whole( part ).centre; }

	// Affine motions, for the preconditioner: A restricted to them, exact for a full lattice and approximate otherwise.
	Matrix12 affineMatrix( int part = 0 ) const;
	Vector12 affineSums( const float* r, int part = 0 ) const;
	/// z += the affine motion, at free nodes.
	void addAffine( const Vector12& motion, float* z, int part = 0 ) const;
	/// A node's position relative to the mass centre of its part, m.
	Eigen::Vector3d arm( int node ) const;

	/// Q^T( m v* - m v ), Q the rigid motions: momentum at the substep's start plus that of external forces, less the nodes' current
	/// momentum. It is the error of the solver's tolerance and rounding where nothing touches the body.
	Vector6 missingMomentum( int part = 0 ) const;
	/// Adds a rigid motion to the nodes' velocities.
	void addMotion( const Vector6& motion, int part = 0 );
	/// Adds rigid motions of the free parts to `velocity`, m/s, which then has the momentum and spin of `impulse`, N s.
	void giveMomentum( const float* impulse, float* velocity ) const;
	/// Before x += h v, which takes nodes along tangents: moves those of parts that rotate as rigid ones, by `least` or more, rad, by the
	/// difference to arcs. `h`: s.
	void bendToArcs( double h, double least );
	/// After it: turns their velocities too.
	void turnVelocities();
	/// The rotation of a part in the last bendToArcs(), if it goes along an arc.
	std::optional<Eigen::Matrix3d> arcOf( int part ) const;
	void copyVelocities( float* v ) const;    ///< current node velocities
	void setNodeVelocities( const float* v ); ///< of the free nodes

private:
	void measurePinned();
	void keepFreeMomentum();
	float gainOf( int node ) const { return m_pull ? m_pull->gain[std::size_t( node )] : 0.0f; }
	bool isHeldNode( int node ) const { return m_nodes->freedom[node] == 0.0f || gainOf( node ) > 0.0f; }
	float heldResistance( int node ) const;
	void measureArms();
	void addPinned( Matrix12& matrix, int part ) const;
	template <class Least, class Point>
	void raiseInertias( const Least& least, const Point& point );
	double trace( int part ) const { return m_inertias[std::size_t( part )].trace(); }

	StrainRates m_rates;
	Segments m_segments;
	unsigned m_tablesVersion = 0, m_laidOutVersion = 0; ///< of the matcher's tables plus 1, and those that m_segments are of
	bool m_areSegmentsMeasured = false;
	NodeState* m_nodes = nullptr;
	const NodePull* m_pull = nullptr; ///< null: nothing draws the nodes
	AlignedArray<float> m_rightSide;
	AlignedArray<float> m_arms;  ///< of the nodes relative to their part's mass centre, m, component by component; 0 where pinned
	double m_secondMoment = 0.0; ///< of a full region, per axis and mass, m^2
	double m_cellMoment = 0.0;   ///< of a cell, per axis and mass, m^2
	float m_stiffness = 0.0f;    ///< G = gamma alpha ( 1 + kappa |m| ) + h c
	float m_gamma = 1.0f;        ///< ( 1 + sigma ) / 2
	float m_volume = 0.0f;       ///< kappa gamma alpha / G
	double m_soundSquare = 0.0;  ///< square of the distance that sound travels in the substep, m^2
	bool m_hasHeldNodes = false;
	struct Pins
	{
		Eigen::Vector3d middle = Eigen::Vector3d::Zero(), velocity = Eigen::Vector3d::Zero(); ///< means of a part's pinned nodes
		double count = 0.0;
	};
	Pins pinsOf( int part ) const;
	std::optional<Eigen::Matrix3d> turnedByPins( int part, const Pins& pins, const Eigen::Vector3d& turn, double h ) const;
	bool isDrawn( int part ) const; ///< some node of it
	Eigen::Matrix3d turned( const Eigen::Vector3d& spin, double h, int part ) const;
	bool isCrossedBySound( int part ) const;
	/// `motion`: of `momentum`.
	bool rotatesAsRigid( int part, const Vector6& momentum, const Vector6& motion ) const;
	struct Arc
	{
		int part;
		Eigen::Matrix3d rotation;
		Eigen::Vector3d velocity;            ///< of the mass centre, or the middle of the pins, m/s
		std::optional<Eigen::Vector3d> spin; ///< angular momentum about the mass centre, kg m^2/s; none of a part with pins
	};
	Eigen::Vector3d missingTurn( const Arc& arc, const Eigen::Vector3d& middle ) const;
	std::vector<Arc> m_arcs;
	std::vector<char> m_isHeld;              ///< of each part
	std::vector<Vector6> m_freeMomentum;     ///< of each part with the velocities of free flight, v*
	std::vector<Eigen::Matrix3d> m_inertias; ///< of each part, kg m^2; with a minimum
};

} // namespace pliant
