#include "demos/story.h"

#include <cmath>
#include <cstdio>

namespace pliant_demos {

void Story::atLeast( const std::string& what, double found, double least )
{
	m_points.push_back( { what, found, least, std::numeric_limits<double>::infinity() } );
}

void Story::atMost( const std::string& what, double found, double most )
{
	m_points.push_back( { what, found, -std::numeric_limits<double>::infinity(), most } );
}

FindingTable Story::table() const
{
	FindingTable table{ "what must have happened", { "found", "at least", "at most" }, {} };
	for ( const Point& point : m_points )
	{
		table.rows.push_back( { point.what, { point.found, point.least, point.most } } );
	}
	return table;
}

std::vector<std::string> Story::failures() const
{
	std::vector<std::string> sentences;
	for ( const Point& point : m_points )
	{
		if ( !( point.found >= point.least && point.found <= point.most && std::isfinite( point.found ) ) )
		{
			char numbers[96];
			std::snprintf( numbers, sizeof( numbers ), "%.4g instead of %.4g to %.4g", point.found, point.least, point.most );
			sentences.push_back( point.what + ": " + numbers );
		}
	}
	return sentences;
}

} // namespace pliant_demos
