#pragma once

// What the inside of a broken body looks like. Ohta et al. 2009, "Fracturing", Fig. 4.

#include <cstdint>

namespace pliant {

/// What is drawn between cells. Exact is for use; the others show where it comes from (Ohta et al. 2009, Fig. 4).
enum class CrackFaces : int
{
	Exact,           ///< the border lies on the surface
	MarchingSquares, ///< corners inside or outside; the border runs straight between the crossings of a face's sides
	Bricks           ///< whole squares, whether the material fills them or not
};

struct CrackSettings
{
	CrackFaces faces = CrackFaces::Exact;

	/// How far faces stand off the lattice's planes at most, in cells, 0 (flat) to kMostNoise.
	float noiseAmplitude = 0.3f;
	/// Length of the noise's waves, cells, 1 to 100.
	float noiseWavelength = 1.6f;
	std::uint32_t noiseSeed = 1;

	/// Each edge of a face is drawn with so many pieces, 1 to 8.
	int subdivision = 2;
	/// Of these, and of the points at which borders cross the triangles that the surface was sampled with, those are left out that lie
	/// nearer than this to what is drawn without them, cells, 0 (none are left out) to 0.5. Vertices are what broken bodies cost:
	/// docs/design/cracks.md.
	float bendTolerance = 0.05f;

	/// Texture coordinates of the inside go from 0 to 1 over this length, m, above 0.
	float textureTile = 1.0f;
};

inline constexpr float kMostNoise = 0.35f;

} // namespace pliant
