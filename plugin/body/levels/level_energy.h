#pragma once

// What a change of levels brings of energy, and what a body owes of it. See level_energy.cpp.

namespace pliant {

/// What that is in joules hangs on the substep (Body::joules).
struct LevelEnergy
{
	double springs = 0.0, power = 0.0; ///< of the regions, as in RegionWork
	double stray = 0.0,
		   strayPower = 0.0; ///< of nodes that are off the body's rigid fit by u: 1/2 sum m |u|^2, kg m^2; - sum m u.v, kg m^2/s
	double motion = 0.0;     ///< J

	LevelEnergy plus( const LevelEnergy& other, double times = 1.0 ) const
	{
		return { springs + times * other.springs, power + times * other.power, stray + times * other.stray,
			strayPower + times * other.strayPower, motion + times * other.motion };
	}
};

/// What changes have brought and the next substeps take off.
struct LevelDebt
{
	LevelEnergy brought; ///< not yet counted in `energy`
	double energy = 0.0; ///< J
	float left = 0.0f;   ///< s, until it is forgiven

	/// Of a piece that has so much of the body.
	LevelDebt fraction( double of ) const { return { LevelEnergy{}.plus( brought, of ), of * energy, left }; }
};

} // namespace pliant
