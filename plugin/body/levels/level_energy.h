#pragma once

// Energy added by a change of levels, and the body's resulting debt. See level_energy.cpp.

namespace pliant {

/// Its value in joules depends on the substep (Body::joules).
struct LevelEnergy
{
	double springs = 0.0, power = 0.0; ///< of the regions, as in RegionWork
	/// Deviations u from the body's rigid fit: 1/2 sum m |u|^2, kg m^2; - sum m u.v, kg m^2/s.
	double deviation = 0.0, deviationPower = 0.0;
	double motion = 0.0; ///< J

	LevelEnergy plus( const LevelEnergy& other, double factor = 1.0 ) const
	{
		return { springs + factor * other.springs, power + factor * other.power, deviation + factor * other.deviation,
			deviationPower + factor * other.deviationPower, motion + factor * other.motion };
	}
};

/// Energy that changes have added and the next substeps remove.
struct LevelDebt
{
	LevelEnergy added;     ///< not yet included in `energy`
	double energy = 0.0;   ///< J
	float timeLeft = 0.0f; ///< s, until the rest is dropped

	/// The debt of a piece that has this fraction of the body.
	LevelDebt fraction( double ratio ) const { return { LevelEnergy{}.plus( added, ratio ), ratio * energy, timeLeft }; }
};

} // namespace pliant
