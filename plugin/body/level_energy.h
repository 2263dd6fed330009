#pragma once

// What a change of levels brings of energy, and what a body owes of it. See level_energy.cpp.

namespace pliant {

/// What that is in joules hangs on the substep (Body::joules).
struct LevelEnergy
{
	double springs = 0.0, power = 0.0;    ///< of the regions, as in RegionWork
	double stray = 0.0, strayPower = 0.0; ///< of nodes that are off the body's rigid fit by u: 1/2 sum m |u|^2, kg m^2; - sum m u.v, kg m^2/s
	double motion = 0.0;                  ///< J

	LevelEnergy plus( const LevelEnergy& other ) const
	{
		return { springs + other.springs, power + other.power, stray + other.stray, strayPower + other.strayPower, motion + other.motion };
	}

	LevelEnergy less( const LevelEnergy& other ) const
	{
		return { springs - other.springs, power - other.power, stray - other.stray, strayPower - other.strayPower, motion - other.motion };
	}
};

/// What changes have brought and the next substeps take off.
struct LevelDebt
{
	LevelEnergy brought; ///< not yet counted in `energy`
	double energy = 0.0; ///< J
	float left = 0.0f;   ///< s, until it is forgiven

	/// Of a piece that has so much of the body.
	LevelDebt share( double of ) const
	{
		const LevelEnergy& b = brought;
		return { { of * b.springs, of * b.power, of * b.stray, of * b.strayPower, of * b.motion }, of * energy, left };
	}
};

} // namespace pliant
