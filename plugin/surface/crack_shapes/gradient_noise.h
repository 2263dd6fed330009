#pragma once

// Smooth noise that bends the planes of the lattice, so that fragments do not look like bricks.
// Ohta et al. 2009, "Fracturing": displacement of crack vertices by Perlin noise (Perlin 2002, "Improving noise").

#include "lattice/lattice.h"

#include <cstdint>

namespace pliant {

/// A map of space bent by noise, in cells: forward( x ) = x + a N( x / wavelength ); each component of N lies in [-1, 1] and almost always
/// in [-1/2, 1/2]. It depends on the position only, so coincident points stay coincident.
class NoiseWarp
{
public:
	/// `amplitude` and `wavelength` in cells; amplitude 0: no noise. With amplitude <= kMostNoise * wavelength the map does not fold.
	NoiseWarp( double amplitude, double wavelength, std::uint32_t seed );

	bool isOff() const { return m_amplitude == 0.0; }
	Vec3d forward( const Vec3d& position ) const { return isOff() ? position : Vec3d( position + m_amplitude * noise( position ) ); }
	/// The inverse of `forward`, up to rounding.
	Vec3d backward( const Vec3d& position ) const;

	/// N alone; `position` in cells.
	Vec3d noise( const Vec3d& position ) const;

private:
	double m_amplitude;
	double m_frequency; ///< 1 / wavelength
	std::uint32_t m_seed;
};

} // namespace pliant
