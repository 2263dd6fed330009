// +-----------------------------------------------------------------------------------------------------------------+
// | The study as one page: first the recommendation, then the reasons.                                               |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/page.h"

#include "demos/study/plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>

namespace pliant_study {

namespace {

constexpr double kBudgets[] = { 0.25e-3, 0.5e-3, 1e-3, 2e-3, 4e-3 }; // s
constexpr std::size_t kMostCurves = 8;
const char* const kOurColours[] = { "#b3402a", "#d9822b", "#8b2f5c", "#c9a227", "#e0632f", "#6d2b1f" };
const char* const kOtherColours[] = {
	"#2a6f97", "#3b8a6e", "#5b5ea6", "#7a8b99", "#4aa3a2", "#345995", "#89a35e", "#8d99ae", "#555555", "#1b4965" };

std::string escaped( const std::string& text )
{
	std::string safe;
	for ( const char c : text )
	{
		switch ( c )
		{
			case '<': safe += "&lt;"; break;
			case '>': safe += "&gt;"; break;
			case '&': safe += "&amp;"; break;
			default: safe += c;
		}
	}
	return safe;
}

std::string format( const char* pattern, double value )
{
	char text[48];
	std::snprintf( text, sizeof( text ), pattern, value );
	return text;
}

std::vector<const Summary*> frontOf( const std::vector<Summary>& all )
{
	std::vector<const Summary*> front;
	for ( const Summary& one : all )
	{
		if ( one.isOnFront )
		{
			front.push_back( &one );
		}
	}
	std::sort( front.begin(), front.end(), []( const Summary* a, const Summary* b ) { return a->median < b->median; } );
	return front;
}

/// Some of many values, including the first and the last.
std::vector<const Summary*> thinned( std::vector<const Summary*> front, std::size_t most )
{
	std::vector<const Summary*> few;
	for ( std::size_t k = 0; k < std::min( most, front.size() ); ++k )
	{
		few.push_back( front.size() <= most ? front[k] : front[k * ( front.size() - 1 ) / ( most - 1 )] );
	}
	return few;
}

Plot frontPlot( const std::string& name, const std::vector<Summary>& all, double floor )
{
	Plot plot{ std::string( "front_" ).append( name ), name + ": error against time (lower and further left is better)",
		"us a game step of 1/60 s, median", "error, share of the diagonal", true, true, {}, {} };
	std::vector<std::string> families;
	std::size_t ours = 0, others = 0;
	for ( const Summary& one : all )
	{
		if ( !one.refused.empty() || std::find( families.begin(), families.end(), one.family ) != families.end() )
		{
			continue;
		}
		families.push_back( one.family );
		const char* colour = one.isOurs ? kOurColours[ours++ % std::size( kOurColours )]
										: kOtherColours[others++ % std::size( kOtherColours )];
		Series series;
		series.title = one.family;
		series.style = std::string( one.isOurs ? "points pt 7" : "points pt 9" ) + " ps 0.9 lc rgb '" + colour + "'";
		for ( const Summary& s : all )
		{
			if ( s.family == one.family && s.refused.empty() && s.errors.mean > 0 )
			{
				series.x.push_back( 1e6 * s.median );
				series.y.push_back( s.errors.mean );
			}
		}
		plot.series.push_back( series );
	}
	Series line = { "front", "steps lw 1.5 lc rgb '#222222'", {}, {} };
	for ( const Summary* s : frontOf( all ) )
	{
		line.x.push_back( 1e6 * s->median );
		line.y.push_back( s->errors.mean );
	}
	plot.series.push_back( line );
	if ( floor > 0 && !line.x.empty() )
	{
		plot.series.push_back(
			{ "two references differ by", "lines dt 2 lc rgb '#999999'", { line.x.front(), line.x.back() }, { floor, floor } } );
	}
	return plot;
}

Plot curvePlot( const PageScene& scene )
{
	const std::string name = scene.scene.name;
	Plot plot{ std::string( "time_" ).append( name ), name + ": error over time, of those on the front", "s",
		"error, share of the diagonal", false, false, {}, {} };
	for ( const Summary* s : thinned( frontOf( scene.all ), kMostCurves ) )
	{
		Series series = { s->candidate, "lines lw 1.5", {}, s->curve };
		for ( std::size_t k = 0; k < s->curve.size(); ++k )
		{
			series.x.push_back( double( k + 1 ) * scene.scene.framesAWrite * kGameStep );
		}
		plot.series.push_back( series );
	}
	return plot;
}

Plot splitPlot( const PageScene& scene )
{
	const std::string name = scene.scene.name;
	Plot plot{ std::string( "split_" ).append( name ), name + ": where the time of a step goes", "", "us a game step, mean", false, false,
		{}, {} };
	const std::vector<const Summary*> front = thinned( frontOf( scene.all ), kMostCurves );
	for ( const Summary* s : front )
	{
		plot.bars.push_back( s->candidate );
	}
	for ( std::size_t k = 0; k < kStageCount; ++k )
	{
		Series layer = { kStageNames[k], "", {}, {} };
		for ( const Summary* s : front )
		{
			layer.y.push_back( 1e6 * s->stages[k] );
		}
		plot.series.push_back( layer );
	}
	return plot;
}

void writeBudgets( const std::vector<Summary>& all, std::ostream& out )
{
	out << "<h2>What to take</h2><table><tr><th>for a step of</th><th>take</th><th>it takes</th><th>slowest "
		   "step</th><th>error</th><th>shape alone</th><th>nodes</th></tr>\n";
	for ( const double budget : kBudgets )
	{
		const Summary* s = best( all, budget );
		out << "<tr><td>" << format( "%g ms", 1e3 * budget ) << "</td>";
		if ( s == nullptr )
		{
			out << "<td colspan=6>nothing that was tried fits</td></tr>\n";
			continue;
		}
		out << "<td><b>" << escaped( s->candidate ) << "</b></td><td>" << format( "%.0f us", 1e6 * s->median ) << "</td><td>"
			<< format( "%.0f us", 1e6 * s->slowest ) << "</td><td>" << format( "%.2f %%", 100 * s->errors.mean ) << "</td><td>"
			<< format( "%.2f %%", 100 * s->errors.shape ) << "</td><td>" << format( "%.0f", s->nodes ) << "</td></tr>\n";
	}
	out << "</table>\n";
}

std::string drift( double value )
{
	return value < 0 ? "-" : format( "%.1e", value );
}

void writeTable( const PageScene& scene, std::ostream& out )
{
	out << "<details><summary>All " << scene.all.size()
		<< " candidates</summary><table><tr><th>candidate</th><th>nodes</th><th>substeps</th><th>median, us</th>"
		   "<th>99 %, us</th><th>most, us</th><th>kB</th><th>error, %</th><th>+-</th><th>over vertices</th><th>shape, %</th><th>at the "
		   "end, %</th><th>worst, %</th>"
		   "<th>volume, %</th><th>momentum</th><th>spin</th><th>energy up</th></tr>\n";
	for ( const Summary& s : scene.all )
	{
		out << "<tr" << ( s.isOnFront ? " class=front" : "" ) << "><td>" << escaped( s.candidate ) << "</td>";
		if ( !s.refused.empty() )
		{
			out << "<td colspan=16>" << escaped( s.refused ) << "</td></tr>\n";
			continue;
		}
		out << "<td>" << format( "%.0f", s.nodes ) << "</td><td>" << format( "%.1f", s.substeps ) << "</td><td>"
			<< format( "%.0f", 1e6 * s.median ) << "</td><td>" << format( "%.0f", 1e6 * s.slow ) << "</td><td>"
			<< format( "%.0f", 1e6 * s.slowest ) << "</td><td>" << format( "%.0f", s.bytes / 1024 ) << "</td><td>"
			<< format( "%.3f", 100 * s.errors.mean ) << "</td><td>" << format( "%.3f", 100 * s.spread ) << "</td><td>"
			<< format( "%.3f", 100 * s.errors.deviation ) << "</td><td>" << format( "%.3f", 100 * s.errors.shape ) << "</td><td>"
			<< format( "%.3f", 100 * s.last.mean ) << "</td><td>" << format( "%.3f", 100 * s.worst ) << "</td><td>"
			<< format( "%.2f", 100 * s.volumeDrift ) << "</td><td>" << drift( s.momentumDrift ) << "</td><td>" << drift( s.spinDrift )
			<< "</td><td>" << drift( s.energyGrowth ) << ( s.isHealthy ? "" : " <b>stopped</b>" ) << "</td></tr>\n";
	}
	out << "</table></details>\n";
}

void writeHead( const PageContent& content, std::ostream& out )
{
	const CandidatePlan& plan = content.plan->candidates;
	out << "<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'><title>Error against run "
		   "time: "
		<< escaped( content.plan->meshName )
		<< "</title><style>body{font:15px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 "
		   "1rem;color:#222}table{border-collapse:collapse;"
		   "font-size:13px;margin:1rem 0}td,th{padding:.2rem .6rem;border-bottom:1px solid "
		   "#ddd;text-align:right}td:first-child,th:first-child{text-align:left}"
		   "tr.front{background:#fbf1e6}svg,img{max-width:100%;height:auto}details{overflow-x:auto}figure{display:inline-block;margin:."
		   "5rem;max-width:26rem}"
		   "figcaption{font-size:13px}</style>\n<h1>Error against run time: "
		<< escaped( content.plan->meshName ) << "</h1><p>" << content.specimen->mesh.triangleCount() << " triangles, "
		<< format( "%.3g m", content.specimen->diagonal ) << " from corner to corner, " << format( "%g kg/m<sup>3</sup>", plan.density )
		<< ", E = " << format( "%.3g Pa", plan.modulus ) << ". Every candidate at up to " << content.plan->orientations
		<< " orientations of its lattice; finest " << plan.cells
		<< " cells. The error is the mean distance of the mesh's vertices from where a uniform lattice of " << 8 * plan.cells
		<< " cells at the same modulus and 16 or more substeps has them, as a share of the diagonal. Times are of one thread of "
		<< escaped( processorName() ) << ", the whole of a game step of 1/60 s with contacts and skin.</p>\n";
}

} // namespace

std::string processorName()
{
	std::ifstream file( "/proc/cpuinfo" );
	std::string line;
	while ( std::getline( file, line ) )
	{
		if ( line.rfind( "model name", 0 ) == 0 )
		{
			return line.substr( line.find( ':' ) + 2 );
		}
	}
	return "an unknown processor";
}

std::string whatIsGivenUp( const std::vector<Summary>& all, const Summary& pick )
{
	std::ostringstream out;
	const Summary* finest = best( all, HUGE_VAL );
	if ( finest == nullptr || finest->candidate == pick.candidate )
	{
		return "Nothing that was tried is better at any price.";
	}
	out << "Given up: " << finest->candidate << " has an error of " << format( "%.4f", finest->errors.mean ) << " instead of "
		<< format( "%.4f", pick.errors.mean ) << ", at " << format( "%.3g ms", 1e3 * finest->median ) << " a step.";
	if ( pick.slowest > 2 * pick.median )
	{
		out << " Its slowest step takes " << format( "%.3g ms", 1e3 * pick.slowest ) << ".";
	}
	if ( pick.momentumDrift > 1e-3 )
	{
		out << " It does not keep momentum (" << format( "%.1g", pick.momentumDrift ) << " lost or gained).";
	}
	if ( pick.volumeDrift > 0.2 )
	{
		out << " Volume changes by up to " << format( "%.0f %%", 100 * pick.volumeDrift )
			<< "; Material::volumeKeeping holds it for more time.";
	}
	return out.str();
}

bool writePage( const PageContent& content, const std::string& path, std::string& why )
{
	const std::string folder = content.plan->folder + "/plots";
	std::ostringstream out;
	writeHead( content, out );
	writeBudgets( content.together, out );
	if ( content.scenes.size() > 1 )
	{
		out << svgOf( frontPlot( "all_scenes", content.together, 0 ), folder, why );
	}
	for ( const PageScene& scene : content.scenes )
	{
		out << "<h2>" << scene.scene.name << ": " << scene.scene.description << "</h2>\n"
			<< svgOf( frontPlot( scene.scene.name, scene.all, scene.floor ), folder, why ) << svgOf( curvePlot( scene ), folder, why )
			<< svgOf( splitPlot( scene ), folder, why ) << scene.pictures << '\n';
		writeTable( scene, out );
	}
	out << "</html>\n";
	std::ofstream file( path );
	if ( !( file << out.str() ).flush() )
	{
		why = path + " could not be written";
		return false;
	}
	return true;
}

} // namespace pliant_study
