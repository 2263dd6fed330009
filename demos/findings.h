#pragma once

// Findings of a scene as tables: printed, and their means over several draws.

#include "demos/scene.h"

#include <vector>

namespace pliant_demos {

void print( const FindingTable& table );

/// Tables of several runs of one scene, in the order of the runs.
class FindingMeans
{
public:
	/// All must have the same tables as the first.
	void add( std::vector<FindingTable> tables );
	/// The mean of each number; for tables of one row the smallest and the largest number as well.
	std::vector<FindingTable> tables() const;

private:
	std::vector<std::vector<FindingTable>> m_runs;
};

} // namespace pliant_demos
