#pragma once

// Plots by gnuplot, as SVG text to put into a page. Script and data stay in the folder for other plots.

#include <string>
#include <vector>

namespace pliant_study {

struct Series
{
	std::string title;
	std::string style; ///< gnuplot's style, after `with`
	std::vector<double> x, y;
};

struct Plot
{
	std::string name; ///< of its files
	std::string title, xLabel, yLabel;
	bool isLogX = false, isLogY = false;
	std::vector<Series> series;
	/// Stacked bars instead: each series is a layer, y by bar; x is ignored.
	std::vector<std::string> bars;
};

/// Empty if there is no gnuplot, or it failed; `why` then has the reason.
std::string svgOf( const Plot& plot, const std::string& folder, std::string& why );

} // namespace pliant_study
