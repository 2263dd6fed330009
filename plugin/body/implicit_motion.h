#pragma once

// One body's part in an implicit substep: the linear system for the speeds it will have, the force of its matching linearised in them.
// docs/design/implicit.md. Knows no contacts: who solves for several bodies at once adds them to the system.
//
//   A v = b,   A = m ( 1 + G ( 1 - P ) ),   G = gamma alpha ( 1 + 3 kappa ) + h c
//   b = m ( v* + alpha e d / h ) + m ( gamma - sigma ) alpha ( 1 + 3 kappa ) ( 1 - P ) v*,   v* = v + h ( g + f / m )
//   gamma = ( 1 + sigma ) / 2
//
// sigma is Material::numericalDamping, c Material::damping, alpha = E h^2 / ( rho d^2 mu ) of any size, 1 - P of StrainRates.

#include "matching/implicit/strain_rates.h"
#include "matching/node_state.h"

#include <Eigen/Core>

#include <vector>

namespace pliant {

class LatticeMatcher;
class TaskRunner;

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
/// An affine motion v = V + L p, p from the mass centre: V, then the columns of L.
using Vector12 = Eigen::Matrix<double, 12, 1>;
using Matrix12 = Eigen::Matrix<double, 12, 12>;

struct ImplicitStep
{
	float h = 0.0f;
	float alpha = 0.0f;
	float damping = 0.0f;          ///< 1/s
	float numericalDamping = 1.0f; ///< sigma
	float volumeKeeping = 0.0f;    ///< kappa
	double secondMoment = 0.0;     ///< of a full region, an axis, per mass, m^2
};

class ImplicitMotion
{
public:
	/// `pushed`: nodes' speeds with what matching adds to them; nodes.v: those of free flight, v*; `before`: at the substep's start. All
	/// three as long as `size`.
	void begin( LatticeMatcher& matcher, NodeState& nodes, const float* pushed, const ImplicitStep& step, TaskRunner* runner );
	/// A body that is moved by its contacts alone in this substep: G = 0, b = m v. `parts`: kept as long as `nodes`; null: one.
	void beginFree( NodeState& nodes, const ConnectedParts* parts = nullptr );

	/// Floats of a vector of speeds: three components, each padded to whole lanes.
	int size() const { return 3 * m_nodes->padded; }
	int padded() const { return m_nodes->padded; }
	const NodeState& nodes() const { return *m_nodes; }
	const float* rightSide() const { return m_rightSide.data(); }
	/// to = A v; rows of held nodes are 0.
	void apply( const float* v, float* to, TaskRunner* runner );
	/// The mean of A's three diagonal entries of a node, kg.
	float diagonal( int node ) const;
	bool isElastic() const { return m_stiffness > 0.0f; }
	bool hasHeldNodes() const { return m_hasHeldNodes; }

	// A body whose cells fall into several parts moves as so many: what follows is of one of them, and of the whole body where it is in
	// one.
	const ConnectedParts& parts() const { return m_rates.parts(); }
	/// Whether some node of a part is held.
	bool isHeld( int part ) const { return m_isHeld[std::size_t( part )] != 0; }
	/// Whether a part is more than a point: of one node nothing stands in front of the system but the node.
	bool hasShape( int part ) const { return !parts().areSeveral() || parts().size( part, m_nodes->count ) > 1; }

	// Rigid motions ( V, Omega ) about the mass centre, in which A is the mass alone.
	Matrix6 rigidMass( int part = 0 ) const;
	/// Momentum of the nodes as they are, and their spin about the centre.
	Vector6 momentum( int part = 0 ) const;
	const Eigen::Vector3d& centre( int part = 0 ) const { return m_rates.whole( part ).centre; }

	// Affine motions, for what stands in front of the system: A among them as a full lattice would have it, about right elsewhere.
	Matrix12 affineMatrix( int part = 0 ) const;
	Vector12 affineSums( const float* r, int part = 0 ) const;
	/// z += the affine motion, at free nodes.
	void addAffine( const Vector12& motion, float* z, int part = 0 ) const;
	/// A node's place from the mass centre of its part, m.
	Eigen::Vector3d arm( int node ) const;

	/// What the solver's end and rounding left of Qt( m v* - m v ), Q the rigid motions, as a rigid motion of each part, of a body that
	/// touches nothing.
	void keepMomentum();
	/// Qt( m v* - m v ): what the nodes' momentum lacks to what it was at the substep's start and what forces brought since.
	Vector6 missingMomentum( int part = 0 ) const;
	/// Adds a rigid motion to the nodes' speeds.
	void addMotion( const Vector6& motion, int part = 0 );
	void copyVelocities( float* v ) const;    ///< of the nodes as they are
	void setNodeVelocities( const float* v ); ///< of the free nodes
	std::size_t bytes() const { return m_rightSide.size() * sizeof( float ) + m_rates.bytes(); }

private:
	void measureHeld();
	void measureArms();
	void addHeld( Matrix12& matrix, int part ) const;
	template <class Least, class Point>
	void raiseInertias( const Least& least, const Point& point );
	double trace( int part ) const { return m_inertias[std::size_t( part )].trace(); }

	StrainRates m_rates;
	NodeState* m_nodes = nullptr;
	AlignedArray<float> m_rightSide;
	AlignedArray<float> m_arms;  ///< of the nodes from their part's mass centre, m, component by component; 0 where one is held
	double m_secondMoment = 0.0; ///< of a full region, an axis, per mass, m^2
	float m_stiffness = 0.0f;    ///< G
	bool m_hasHeldNodes = false;
	std::vector<char> m_isHeld;              ///< of each part
	std::vector<Vector6> m_freeMomentum;     ///< of each part with the speeds of free flight, v*
	std::vector<Eigen::Matrix3d> m_inertias; ///< of each part, kg m^2; raised where it has none
};

} // namespace pliant
