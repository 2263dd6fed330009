#include "demos/shard_count.h"

#include <algorithm>
#include <functional>

namespace pliant_demos {

void ShardCount::note( const Stage& stage, double seconds )
{
	const pliant::StepReport& report = stage.world().stepReport();
	m_links += report.brokenLinks;
	m_pieces += report.fragments;
	m_removed += report.removedPieces;
	m_firstCrack = m_firstCrack == 0 && m_links > 0 ? seconds : m_firstCrack;
	m_longestFracture = std::max( m_longestFracture, report.fracture );
	if ( m_links > 0 )
	{
		m_steps.push_back( report.total );
	}
	for ( const pliant::FractureEvent& event : stage.world().fractureEvents() )
	{
		m_area += event.area;
		m_energy += event.energy;
	}
}

FindingTable ShardCount::table( const Stage& stage, const char* name, int smallCells ) const
{
	std::vector<double> masses, steps = m_steps;
	double mass = 0, small = 0;
	for ( int i = 0; i < stage.world().softBodyCount(); ++i )
	{
		const pliant::SoftBody& body = *stage.world().softBody( i );
		masses.push_back( double( body.mass() ) );
		mass += masses.back();
		small += body.cellCount() <= smallCells ? masses.back() : 0;
	}
	std::sort( masses.begin(), masses.end(), std::greater<>() );
	double held = 0;
	int large = 0;
	for ( std::size_t i = 0; i < masses.size() && held < 0.9 * mass; ++i, ++large )
	{
		held += masses[i];
	}
	std::sort( steps.begin(), steps.end() );
	const double median = steps.empty() ? 0 : steps[steps.size() / 2], worst = steps.empty() ? 0 : steps.back();
	return { std::string( "what became of the " ) + name,
		{ "bodies", "hold 90 % of the mass", "mass in small ones, %", "removed", "broken links", "crack, m^2", "energy, J",
			"first crack, s", "mass, kg", "median step, ms", "worst step, ms", "worst fracture, ms", "awake at last" },
		{ { name,
			{ double( masses.size() ), double( large ), 100 * small / mass, double( m_removed ), double( m_links ), m_area, m_energy,
				m_firstCrack, mass, 1e3 * median, 1e3 * worst, 1e3 * m_longestFracture,
				double( stage.world().stepReport().awakeSoftBodies ) } } } };
}

} // namespace pliant_demos
