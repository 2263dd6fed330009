#pragma once

// Smooth noise that bends the planes of the lattice, so that what breaks along them does not look like bricks.
// Ohta et al. 2009, "Fracturing": an offset of crack vertices by Perlin noise (Perlin 2002, "Improving noise").

#include "lattice/lattice.h"

#include <cstdint>

namespace pliant {

/// Space bent by noise, in cells: forward( x ) = x + a N( x / wavelength ), each component of N within [-1, 1] and nearly always within
/// [-1/2, 1/2]. One function of place alone: whatever meets at a place is moved alike.
class NoiseWarp
{
public:
	/// `amplitude` and `wavelength` in cells. With amplitude <= kMostNoise * wavelength the map does not fold. 0: no noise.
	NoiseWarp( double amplitude, double wavelength, std::uint32_t seed );

	bool isOff() const { return m_amplitude == 0.0; }
	Vec3d forward( const Vec3d& place ) const { return isOff() ? place : Vec3d( place + m_amplitude * noise( place ) ); }
	/// The inverse, to within rounding.
	Vec3d backward( const Vec3d& place ) const;

	/// N alone, by place in cells.
	Vec3d noise( const Vec3d& place ) const;

private:
	double m_amplitude;
	double m_frequency; ///< 1 / wavelength
	std::uint32_t m_seed;
};

} // namespace pliant
