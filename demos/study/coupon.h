#pragma once

// A piece of material in a testing machine: a box of cells, or a shape of its own, that is pulled, bent and let go through the public face.

#include "demos/explicit_material.h"
#include "demos/study/small_world.h"

#include <Eigen/Core>

#include <functional>
#include <vector>

namespace pliant_study {

/// Reads as: what is at a rest place counts.
using Where = std::function<bool( const Eigen::Vector3d& rest )>;
/// Something of a rest place.
using Field = std::function<Eigen::Vector3d( const Eigen::Vector3d& rest )>;

struct CouponOrder
{
	Eigen::Vector3i cells = { 16, 4, 4 };                         ///< along x, y and z
	pliant_glue::ModelMesh mesh;                                  ///< in the box's place, where it has vertices
	pliant::Material material = pliant_demos::explicitMaterial(); ///< youngsModulus: see `reach`
	pliant::Adaptivity adaptivity;
	double cell = 0.1;          ///< m
	double degrees = 0;         ///< between the box and its lattice, about z
	double gameStep = 1.0 / 60; ///< s
	int substeps = 4;
	/// Young's modulus as a share of what `halfWidth` 1 reaches at this step; 0: the material's own.
	double reach = 0.8;
};

/// The modulus that a share `reach` of the way to the goal stands for: alpha rho d^2 w ( w + 1 ) / ( 3 h^2 ) at w = 1, Pa.
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

	/// Holds what is there; how many nodes.
	int hold( const Where& where );
	/// Moves what is held to `to( rest )` within the next step.
	void drive( const Field& to );
	/// A force field of so much a kilogram, N/kg; from the next step on, until it is set anew.
	void push( const Field& perMass );
	/// `total` N shared out by mass among what is there, on top of what pushes already.
	void pushAt( const Where& where, const Eigen::Vector3d& total );
	/// A couple about z of `moment` N m on what is there: along x, as much as y is away from its middle, by mass. It turns with it.
	void bend( const Where& where, double moment );
	void clearForces();

	/// Puts every node at `to( rest )`, at rest.
	void put( const Field& to );
	void step();
	/// Steps until it is in balance: speeds are set to 0 whenever the energy of its swinging has passed a peak, which brings
	/// it down in a few swings. False where `most` steps are too few.
	bool settle( int most );

	/// The affine map from rest to now of what is there, least squares by mass.
	Eigen::Matrix3d deformation( const Where& where ) const;
	Eigen::Vector3d meanMoved( const Where& where ) const;
	Eigen::Vector3d meanRest( const Where& where ) const;
	/// How much of a shape there is in what has moved: sum of m shape . moved over sum of m shape . shape.
	double along( const Field& shape ) const;
	/// Largest distance of a node from the rest shape put where it fits best, m.
	double misfit() const;
	/// Of the cells that have three neighbours at rest, the share whose corner of edges to them is turned over.
	double invertedFraction() const;

private:
	struct Couple
	{
		std::vector<int> nodes;
		double perMass; // N/kg a metre off the middle
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
