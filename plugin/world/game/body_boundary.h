#pragma once

// The surface of a body's cells in the present shape, for force fields, gas, explosions and queries.

#include "body/body.h"
#include "lattice/faces/cell_boundary.h"

#include <vector>

namespace pliant {

class BodyBoundary
{
public:
	/// Follows the body: topology where `version` (SoftBody::fractureVersion) has changed, and positions.
	void update( const Body& body, unsigned version );

	const CellBoundary& cells() const { return m_cells; }
	int count() const { return m_cells.pointCount(); }
	/// Relative to NodeState::origin, m. Valid after update(), as are the following.
	const Vec3d& position( int point ) const { return m_position[std::size_t( point )]; }
	/// Outwards, m^2.
	const Vec3d& area( int point ) const { return m_area[std::size_t( point )]; }
	/// The mean of its nodes' velocities, m/s.
	Vec3d velocity( const Body& body, int point ) const;
	/// Its part of its nodes' masses, kg.
	double mass( const Body& body, int point ) const;
	/// Inside of a surface, m^3; negative for a cavity.
	double volume( int surface ) const { return m_volume[std::size_t( surface )]; }
	/// Calls visit( node, fraction ) for the nodes that carry a point.
	template <class F>
	void forNodes( const Body& body, int point, F&& visit ) const
	{
		const std::uint32_t begin = m_cells.cellStart[std::size_t( point )], end = m_cells.cellStart[std::size_t( point ) + 1];
		for ( std::uint32_t k = begin; k < end; ++k )
		{
			visit( body.nodeOfCell( m_cells.cell[k] ), 1.0 / double( end - begin ) );
		}
	}

private:
	void measureMaps( const Body& body );

	CellBoundary m_cells;
	bool m_isKnown = false;
	unsigned m_version = 0; ///< of the topology
	std::vector<Vec3d> m_position, m_area;
	std::vector<double> m_volume;
	std::vector<float> m_parts; ///< by node: number of points that it carries, weighted
	std::vector<float> m_rotations, m_flow, m_gradients;
	std::vector<Eigen::Matrix3f> m_map; ///< by node, from the rest shape
};

} // namespace pliant
