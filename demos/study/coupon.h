#pragma once

// A test piece: a box of cells, or a shape of its own, that is pulled, bent and released through the public face.

#include "demos/explicit_material.h"
#include "demos/study/small_world.h"

#include <Eigen/Core>

#include <functional>
#include <vector>

namespace pliant_study {

/// Returns true for rest positions that are selected.
using Where = std::function<bool( const Eigen::Vector3d& rest )>;
/// A quantity that depends on a rest position.
using Field = std::function<Eigen::Vector3d( const Eigen::Vector3d& rest )>;

struct CouponOrder
{
	Eigen::Vector3i cells = { 16, 4, 4 };                         ///< along x, y and z
	pliant_glue::ModelMesh mesh;                                  ///< replaces the box if it has vertices
	pliant::Material material = pliant_demos::explicitMaterial(); ///< youngsModulus: see `reach`
	pliant::Adaptivity adaptivity;
	double cell = 0.1;          ///< m
	double degrees = 0;         ///< between the box and its lattice, about z
	double gameStep = 1.0 / 60; ///< s
	int substeps = 4;
	/// Young's modulus as a fraction of the reach of `halfWidth` 1 at this step; 0: the material's own.
	double reach = 0.8;
};

/// The modulus that corresponds to the fraction `reach` of the displacement to the goal (alpha): alpha rho d^2 w ( w + 1 ) / ( 3 h^2 ) at w
/// = 1, Pa.
double modulusWithin( const CouponOrder& order, double reach );

class Coupon
{
public:
	explicit Coupon( const CouponOrder& order );

	const CouponOrder& order() const { return m_order; }
	double modulus() const { return double( m_order.material.youngsModulus ); }
	int count() const { return int( m_rest.size() ); }
	const Eigen::Vector3d& rest( int node ) const { return m_rest[std::size_t( node )]; }
	const std::vector<Eigen::Vector3d>& rest() const { return m_rest; }
	Eigen::Vector3d now( int node ) const;
	Eigen::Vector3d moved( int node ) const { return now( node ) - rest( node ); }
	double mass( int node ) const { return double( m_body->nodeMass( node ) ); }
	bool isHealthy() const { return m_body->isHealthy(); }

	/// Holds the selected nodes; returns their number.
	int hold( const Where& where );
	/// Moves the held nodes to `to( rest )` within the next step.
	void drive( const Field& to );
	/// A force field per mass, N/kg; from the next step on, until it is set again.
	void push( const Field& perMass );
	/// Adds `total` N to the forces, distributed by mass over the selected nodes.
	void pushAt( const Where& where, const Eigen::Vector3d& total );
	/// A couple about z of `moment` N m on the selected nodes: forces along x in proportion to the distance in y from their centre, by
	/// mass. It rotates with them.
	void bend( const Where& where, double moment );
	void clearForces();

	/// Moves every node to `to( rest )`, with velocity 0.
	void put( const Field& to );
	void step();
	/// Steps until the piece is in equilibrium: velocities are set to 0 whenever the energy of its oscillation has passed a peak, which
	/// damps it within a few oscillations. False if `most` steps are not enough.
	bool settle( int most );

	/// The affine map from rest to the present positions of the selected nodes, least squares by mass.
	Eigen::Matrix3d deformation( const Where& where ) const;
	Eigen::Vector3d meanMoved( const Where& where ) const;
	Eigen::Vector3d meanRest( const Where& where ) const;
	/// The component of a shape in the displacement of the selected nodes: sum of m shape . displacement over sum of m shape . shape.
	double along( const Field& shape ) const;
	/// Largest distance of a node from the best-fitting rest shape, m.
	double misfit() const;
	/// Of the cells that have three neighbours at rest, the fraction for which the triad of edges to them is inverted.
	double invertedFraction() const;

private:
	struct Couple
	{
		std::vector<int> nodes;
		double perMass; // N/kg per metre off the centre
		double middle;  // m
	};

	double driftEnergy() const;
	void applyForces();
	std::vector<int> nodesIn( const Where& where ) const;

	CouponOrder m_order;
	SmallWorld m_world;
	pliant::SoftBody* m_body = nullptr;
	std::vector<Eigen::Vector3d> m_rest, m_force; ///< of each node, m and N
	std::vector<Couple> m_couples;
};

} // namespace pliant_study
