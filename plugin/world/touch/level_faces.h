#pragma once

// The drawn surface in front of the nodes of a body with levels: the patches of the finest cells, as seen from the node that holds them.

#include "lattice/axis_neighbours.h"
#include "lattice/lattice.h"

#include <cstdint>
#include <vector>

namespace pliant {

class Levels;

/// Tables by node, which hold until levels or links change.
class LevelFaces
{
public:
	/// A patch in the node's rest frame; its sphere's centre is `foot` - `radius` `normal`.
	struct Face
	{
		Vec3 foot;           ///< point of the surface in front of the cell, from the node's centre, m
		Vec3 normal;         ///< outwards, unit length
		float radius = 0.0f; ///< m; of a plane the largest that a node of this size can have
		bool isOwn = true;   ///< a patch of the node's own cells; false: a face at an edge, or a patch of a linked cell
	};

	/// `patches`, `beside`: of the finest cells.
	void build( const Lattice& lattice, const Levels& levels, const std::vector<ContactPatch>& patches, const AxisNeighbours& beside );

	/// Along each axis the node most nearly in that direction; nodes without a surface have none.
	const AxisNeighbours& neighbours() const { return m_neighbours; }
	const Vec3& restCentre( int node ) const { return m_restCentre[std::size_t( node )]; }
	double sizeOf( int node ) const { return m_size[std::size_t( node )]; } ///< edge of the node's block, m
	double largestSize() const { return m_largestSize; }
	/// How far the surface is in front of the nodes' spheres at most, m.
	double overhang() const { return m_overhang; }
	bool hasFaces( int node ) const { return m_start[std::size_t( node )] < m_start[std::size_t( node ) + 1]; }

	/// The face that an object is least far behind, of those within a cell of the nearest; null where it belongs to the layer above.
	/// `at`: the object's nearest point, in the rest frame, from the node's centre, m.
	const Face* nearestFace( int node, const Vec3d& at ) const;

private:
	void findNeighbours( const Levels& levels, const AxisNeighbours& beside );
	void addFaces( const Lattice& lattice, const Levels& levels, const std::vector<ContactPatch>& patches, std::size_t node );
	Face faceOf( const Lattice& lattice, const ContactPatch& patch, std::uint32_t cell, std::size_t node ) const;
	void addFace( const Face& face, double size );

	AxisNeighbours m_neighbours;
	std::vector<Vec3> m_restCentre;
	std::vector<double> m_size;
	std::vector<Face> m_faces;
	std::vector<std::uint32_t> m_start;  ///< into the faces, by node
	std::vector<std::uint32_t> m_linked; ///< scratch: cells
	double m_cellSize = 0.0, m_largestSize = 0.0, m_overhang = 0.0;
};

} // namespace pliant
