// +-----------------------------------------------------------------------------------------------------------------+
// | Plots by gnuplot.                                                                                                |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/plot.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

namespace pliant_study {

namespace {

const char* const kLayerColours[] = { "#b8b8b8", "#b3402a", "#e3b23c", "#2a6f97", "#5b5ea6", "#8fb996", "#d9822b", "#3a3a3a", "#7fb7be" };

/// In single quotes, for gnuplot and shells.
std::string quoted( const std::string& text )
{
	std::string safe = "'";
	for ( const char c : text )
	{
		safe += c == '\'' ? ' ' : c;
	}
	return safe + "'";
}

void writeBars( const Plot& plot, std::ostream& script )
{
	script << "set style data histograms\nset style histogram rowstacked\nset style fill solid 0.85 border -1\nset boxwidth 0.7\nset xtics "
			  "rotate by -20 "
			  "font ',9'\n$data << EOD\n";
	for ( std::size_t b = 0; b < plot.bars.size(); ++b )
	{
		script << '"' << plot.bars[b] << '"';
		for ( const Series& series : plot.series )
		{
			script << ' ' << series.y[b];
		}
		script << '\n';
	}
	script << "EOD\nplot ";
	for ( std::size_t s = 0; s < plot.series.size(); ++s )
	{
		script << ( s > 0 ? ", " : "" ) << "$data using " << s + 2 << ( s == 0 ? ":xtic(1)" : "" ) << " lc rgb '"
			   << kLayerColours[s % std::size( kLayerColours )] << "' title " << quoted( plot.series[s].title );
	}
	script << '\n';
}

void writeLines( const Plot& plot, std::ostream& script )
{
	for ( std::size_t s = 0; s < plot.series.size(); ++s )
	{
		script << "$s" << s << " << EOD\n";
		for ( std::size_t k = 0; k < plot.series[s].x.size(); ++k )
		{
			script << plot.series[s].x[k] << ' ' << plot.series[s].y[k] << '\n';
		}
		script << "EOD\n";
	}
	script << "plot ";
	for ( std::size_t s = 0; s < plot.series.size(); ++s )
	{
		script << ( s > 0 ? ", " : "" ) << "$s" << s << " using 1:2 with " << plot.series[s].style << " title "
			   << quoted( plot.series[s].title );
	}
	script << '\n';
}

} // namespace

std::string svgOf( const Plot& plot, const std::string& folder, std::string& why )
{
	if ( std::system( "command -v gnuplot > /dev/null 2>&1" ) != 0 )
	{
		why = "no plots, since gnuplot (gnuplot-nox) is not installed";
		return {};
	}
	std::error_code error;
	std::filesystem::create_directories( folder, error );
	const std::string script = folder + "/" + plot.name + ".gp", picture = folder + "/" + plot.name + ".svg";
	{
		std::ofstream out( script );
		out << "set terminal svg size 860,480 dynamic font 'sans-serif,12' background '#ffffff'\nset output " << quoted( picture )
			<< "\nset title " << quoted( plot.title ) << " noenhanced\nset xlabel " << quoted( plot.xLabel ) << "\nset ylabel "
			<< quoted( plot.yLabel )
			<< "\nset key outside right top noenhanced font ',10'\nset grid lc rgb '#dddddd'\nset xtics noenhanced\n"
			<< ( plot.isLogX ? "set logscale x\n" : "" ) << ( plot.isLogY ? "set logscale y\n" : "" );
		plot.bars.empty() ? writeLines( plot, out ) : writeBars( plot, out );
	}
	if ( std::system( ( "gnuplot " + quoted( script ) + " > /dev/null 2>&1" ).c_str() ) != 0 )
	{
		why = "gnuplot could not draw " + script;
		return {};
	}
	std::ifstream file( picture );
	std::stringstream text;
	text << file.rdbuf();
	const std::string svg = text.str();
	const std::size_t begin = svg.find( "<svg" ); // the lines before it are for separate files
	return begin == std::string::npos ? std::string() : svg.substr( begin );
}

} // namespace pliant_study
