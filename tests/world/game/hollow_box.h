#pragma once

// A cube with a cubic cavity, for tests of gas and of surfaces.

#include "world/test_world.h"

namespace pliant::test {

/// A cube with edge `edge` m around the origin, whose walls are one cell of `cell` m thick.
inline std::shared_ptr<const BodyTemplate> hollowBox( float edge, float cell )
{
	static const std::uint32_t faces[36] = {
		0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
	std::vector<float> positions;
	std::vector<std::uint32_t> indices;
	for ( std::uint32_t box = 0; box < 2; ++box )
	{
		const float size = box == 0 ? edge : edge - 2 * cell;
		for ( int i = 0; i < 8; ++i )
		{
			for ( int k = 0; k < 3; ++k )
			{
				positions.push_back( size * ( float( i >> k & 1 ) - 0.5f ) );
			}
		}
		for ( std::size_t k = 0; k < 36; k += 3 )
		{
			indices.insert( indices.end(),
				{ 8 * box + faces[k], 8 * box + faces[k + ( box == 0 ? 1 : 2 )], 8 * box + faces[k + ( box == 0 ? 2 : 1 )] } );
		}
	}
	MeshView mesh;
	mesh.positions = positions.data();
	mesh.vertexCount = 16;
	mesh.indices = indices.data();
	mesh.triangleCount = 24;
	LatticeSettings settings;
	settings.cellSize = cell;
	return BodyTemplate::build( mesh, settings ).value;
}

} // namespace pliant::test
