#pragma once

// Conditions that a scene must have met at its end; otherwise its run fails.

#include <limits>
#include <string>
#include <vector>

namespace pliant_demos {

/// Measurements of a scene: rows of numbers under headings.
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
	/// `what`: name and unit. A number that is not finite fails.
	void atLeast( const std::string& what, double found, double least );
	void atMost( const std::string& what, double found, double most );

	/// A row for each condition: the number found, and its bounds.
	FindingTable table() const;
	/// A sentence for each condition that is not met.
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
