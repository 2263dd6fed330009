#pragma once

// How the crack faces of a broken body are drawn. Ohta et al. 2009, "Fracturing", Fig. 4.

#include <cstdint>

namespace pliant {

/// How the crack face between two cells is bounded. Exact is for use; the others are for comparison (Ohta et al. 2009, Fig. 4).
enum class CrackFaces : int
{
	Exact,           ///< the border lies on the mesh's surface. Default.
	MarchingSquares, ///< corners are inside or outside; the border is straight between the crossings on the sides of the face
	Bricks           ///< whole squares, whether material fills them or not
};

/// Shape of the crack faces. Values out of range are refused by BodyTemplate::build (ResultCode::BadSettings).
struct CrackSettings
{
	/// How the faces are bounded.
	CrackFaces faces = CrackFaces::Exact;

	/// Largest distance of crack faces from the planes of the lattice, cells, 0 (flat) to kMostNoise.
	float noiseAmplitude = 0.3f;
	/// Wavelength of the noise, cells, 1 to 100.
	float noiseWavelength = 1.6f;
	/// Seed of the noise, any number. The same seed gives the same crack faces.
	std::uint32_t noiseSeed = 1;

	/// Number of segments per edge of a face, 1 to 8.
	int subdivision = 2;
	/// Largest error of simplified borders, cells, 0 to 0.5: points of the subdivision, and points where borders cross the triangles of the
	/// mesh, are left out where the border drawn without them passes nearer than this. 0: none is left out. The number of vertices
	/// determines the cost of broken bodies (docs/design/cracks.md).
	float bendTolerance = 0.05f;

	/// Length over which the texture coordinates of crack faces go from 0 to 1, m, above 0 and finite.
	float textureTile = 1.0f;
};

/// Largest CrackSettings::noiseAmplitude, cells.
inline constexpr float kMostNoise = 0.35f;

} // namespace pliant
