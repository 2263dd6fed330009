// Three gradient noises at once: one hash per lattice corner serves all three components.

#include "surface/crack_shapes/gradient_noise.h"

#include "surface/constants.h"

namespace pliant {

namespace {

/// A 32-bit hash of three coordinates: any change of a bit flips about half of the others.
std::uint32_t mix( std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t seed )
{
	std::uint32_t h = seed * 0x9e3779b9u;
	for ( const std::uint32_t word : { x, y, z } )
	{
		h = ( h ^ word ) * 0x85ebca6bu;
		h ^= h >> 13;
		h *= 0xc2b2ae35u;
		h ^= h >> 16;
	}
	return h;
}

/// 6 t^5 - 15 t^4 + 10 t^3: slope and curvature are zero at both ends.
double fade( double t )
{
	return t * t * t * ( t * ( t * 6.0 - 15.0 ) + 10.0 );
}

/// Product with one of twelve directions to the middles of a cube's edges; four of the sixteen codes are duplicates.
double slope( std::uint32_t code, const Vec3d& away )
{
	const std::uint32_t h = code & 15u;
	const double u = h < 8 ? away.x() : away.y();
	const double v = h < 4 ? away.y() : h == 12 || h == 14 ? away.x() : away.z();
	return ( ( h & 1u ) != 0 ? -u : u ) + ( ( h & 2u ) != 0 ? -v : v );
}

} // namespace

NoiseWarp::NoiseWarp( double amplitude, double wavelength, std::uint32_t seed ) :
	m_amplitude( amplitude ), m_frequency( 1.0 / wavelength ), m_seed( seed )
{}

Vec3d NoiseWarp::noise( const Vec3d& position ) const
{
	const Vec3d at = position * m_frequency + Vec3d( kNoiseShift[0], kNoiseShift[1], kNoiseShift[2] );
	const Vec3d floor = at.array().floor();
	const Vec3d within = at - floor;
	const Vec3d fraction( fade( within.x() ), fade( within.y() ), fade( within.z() ) );
	Vec3d sum = Vec3d::Zero();
	for ( int corner = 0; corner < 8; ++corner )
	{
		const Vec3d step( corner & 1, corner >> 1 & 1, corner >> 2 );
		double weight = 1.0;
		for ( int axis = 0; axis < 3; ++axis )
		{
			weight *= step[axis] != 0.0 ? fraction[axis] : 1.0 - fraction[axis];
		}
		const auto number = [&]( int axis ) { return std::uint32_t( std::int64_t( floor[axis] + step[axis] ) ); };
		const std::uint32_t hash = mix( number( 0 ), number( 1 ), number( 2 ), m_seed );
		const Vec3d away = within - step;
		sum += weight * Vec3d( slope( hash, away ), slope( hash >> 8, away ), slope( hash >> 16, away ) );
	}
	return sum;
}

Vec3d NoiseWarp::backward( const Vec3d& position ) const
{
	// x <- x' - a N( x ) contracts as long as a |grad N| < 1.
	Vec3d at = position;
	for ( int round = 0; round < kNoiseRounds && !isOff(); ++round )
	{
		const Vec3d next = position - m_amplitude * noise( at );
		const bool isStill = ( next - at ).cwiseAbs().maxCoeff() < kNoiseStill;
		at = next;
		if ( isStill )
		{
			break;
		}
	}
	return at;
}

} // namespace pliant
