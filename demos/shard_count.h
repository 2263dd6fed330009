#pragma once

// Results of breaking: counts, sizes and times for a scene's findings.

#include "demos/scene.h"

namespace pliant_demos {

class ShardCount
{
public:
	/// Called after each step.
	void note( const Stage& stage, double seconds );
	/// One row: number of pieces, number of pieces that make up 90 % of the mass, fraction of the mass in pieces of at most `smallCells`,
	/// links, area, energy, time of the first crack, and times of steps.
	FindingTable table( const Stage& stage, const char* name, int smallCells ) const;

private:
	int m_links = 0, m_pieces = 0, m_removed = 0;
	double m_area = 0, m_energy = 0, m_firstCrack = 0, m_longestFracture = 0;
	std::vector<double> m_steps; ///< s, from the first crack on
};

/// A scene that counts the pieces of its bodies.
class ShardScene : public Scene
{
public:
	/// `name`: of the breaking body. `smallCells`: as in ShardCount::table.
	ShardScene( const char* name, int smallCells ) : m_name( name ), m_smallCells( smallCells ) {}
	void afterStep( Stage& stage, double seconds ) override { m_count.note( stage, seconds ); }
	std::vector<FindingTable> findings( const Stage& stage ) const override { return { m_count.table( stage, m_name, m_smallCells ) }; }

private:
	const char* m_name;
	int m_smallCells;
	ShardCount m_count;
};

} // namespace pliant_demos
