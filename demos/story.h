#pragma once

// What must have happened by the end of a scene: a scene that went another way fails.

#include <limits>
#include <string>
#include <vector>

namespace pliant_demos {

/// What a scene has measured: rows of numbers under headings.
struct FindingTable
{
	struct Row
	{
		std::string name;
		std::vector<double> values; ///< one a column
	};
	std::string caption;
	std::vector<std::string> columns;
	std::vector<Row> rows;
};

class Story
{
public:
	/// `what`: with its unit. A number that is not finite fails.
	void atLeast( const std::string& what, double found, double least );
	void atMost( const std::string& what, double found, double most );

	/// A row for each point: what was found, and what is wanted.
	FindingTable table() const;
	/// A sentence for each point that did not come about.
	std::vector<std::string> failures() const;

private:
	struct Point
	{
		std::string what;
		double found, least, most;
	};
	std::vector<Point> m_points;
};

} // namespace pliant_demos
