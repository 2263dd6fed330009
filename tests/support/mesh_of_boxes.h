#pragma once

// Meshes of many disconnected closed boxes that form one body.

#include "pliant/body_template.h"

#include <LinearMath/btQuaternion.h>
#include <LinearMath/btVector3.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

namespace pliant::test {

struct MeshOfBoxes
{
	std::vector<float> positions;
	std::vector<std::uint32_t> indices;

	void add( const btVector3& centre, const btVector3& half )
	{
		static const std::uint32_t box[36] = {
			0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
		const std::uint32_t first = std::uint32_t( positions.size() / 3 );
		for ( int corner = 0; corner < 8; ++corner )
		{
			for ( int k = 0; k < 3; ++k )
			{
				positions.push_back( float( centre[k] + ( corner >> k & 1 ? half[k] : -half[k] ) ) );
			}
		}
		for ( const std::uint32_t index : box )
		{
			indices.push_back( first + index );
		}
	}

	/// cellSize 0: about `targetCells` cells.
	std::shared_ptr<const BodyTemplate> build( float cellSize, int targetCells = 1000 ) const
	{
		MeshView mesh;
		mesh.positions = positions.data();
		mesh.vertexCount = positions.size() / 3;
		mesh.indices = indices.data();
		mesh.triangleCount = indices.size() / 3;
		LatticeSettings settings;
		settings.cellSize = cellSize;
		settings.targetCells = targetCells;
		settings.skinning = Skinning::None;
		return BodyTemplate::build( mesh, settings ).value;
	}
};

/// Number of cells of a box along x, y and z.
struct Cells
{
	int x, y, z;
};

/// `count` boxes arranged in a cube, one empty cell apart.
inline std::shared_ptr<const BodyTemplate> looseBoxes( int count, const Cells& cells, float cell )
{
	MeshOfBoxes mesh;
	const int along = int( std::ceil( std::cbrt( double( count ) ) - 1e-9 ) );
	const btVector3 half = btVector3( btScalar( cells.x ), btScalar( cells.y ), btScalar( cells.z ) ) * cell / 2;
	for ( int k = 0; k < count; ++k )
	{
		const btVector3 position( btScalar( k % along * ( cells.x + 1 ) ), btScalar( k / along % along * ( cells.y + 1 ) ),
			btScalar( k / along / along * ( cells.z + 1 ) ) );
		mesh.add( position * cell + half, half );
	}
	return mesh.build( cell );
}

/// `count` cubes of edge `edge` m at random positions in a unit cube, about 800 cells in all.
inline std::shared_ptr<const BodyTemplate> spreadCubes( int count, btScalar edge, unsigned seed )
{
	std::mt19937 random( seed );
	const auto fraction = [&random] { return btScalar( random() / 4294967296.0 ); };
	MeshOfBoxes mesh;
	for ( int k = 0; k < count; ++k )
	{
		const btScalar x = fraction(), y = fraction(), z = fraction();
		mesh.add( btVector3( x, y, z ), btVector3( edge, edge, edge ) / 2 );
	}
	return mesh.build( 0.0f, 800 );
}

} // namespace pliant::test
