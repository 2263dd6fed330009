// +-----------------------------------------------------------------------------------------------------------------+
// | The stability matrix: run, stored line by line, and shown as a table.                                            |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/stability.h"

#include "demos/study/progress.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

namespace pliant_study {

namespace {

bool isWanted( const std::string& name, const std::vector<std::string>& only )
{
	return only.empty() ||
		std::any_of( only.begin(), only.end(), [&name]( const std::string& word ) { return name.rfind( word, 0 ) == 0; } );
}

using Key = std::pair<std::string, std::string>; // case, method
using Matrix = std::map<Key, Verdict>;

constexpr const char* kHeader = "steps;seed;case;method;colour;reason;inverted;energy_growth;depth_cells;recovery_s;us_a_step";

/// Lines of this plan's steps and seed; others stay in the file and are ignored.
Matrix readMatrix( const std::string& path, const StabilityPlan& plan )
{
	Matrix matrix;
	std::ifstream file( path );
	std::string line;
	while ( std::getline( file, line ) )
	{
		std::vector<std::string> fields;
		std::stringstream stream( line );
		for ( std::string field; std::getline( stream, field, ';' ); )
		{
			fields.push_back( field );
		}
		if ( fields.size() != 11 || fields[0] != std::to_string( plan.steps ) || fields[1] != std::to_string( plan.seed ) )
		{
			continue;
		}
		Verdict verdict;
		for ( const Colour colour : { Colour::Green, Colour::Yellow, Colour::Red, Colour::None } )
		{
			verdict.colour = fields[4] == toString( colour ) ? colour : verdict.colour;
		}
		verdict.reason = fields[5];
		verdict.inverted = std::atof( fields[6].c_str() );
		verdict.energyGrowth = std::atof( fields[7].c_str() );
		verdict.depth = std::atof( fields[8].c_str() );
		verdict.recovery = std::atof( fields[9].c_str() );
		verdict.microseconds = std::atof( fields[10].c_str() );
		matrix[{ fields[2], fields[3] }] = verdict;
	}
	return matrix;
}

std::string lineOf( const StabilityPlan& plan, const Key& key, const Verdict& v )
{
	std::ostringstream out;
	out.precision( 6 );
	out << plan.steps << ';' << plan.seed << ';' << key.first << ';' << key.second << ';' << toString( v.colour ) << ';' << v.reason << ';'
		<< v.inverted << ';' << v.energyGrowth << ';' << v.depth << ';' << v.recovery << ';' << v.microseconds;
	return out.str();
}

void writeCell( const StabilityPlan& plan, const Key& key, const Verdict& v, std::ostream& page )
{
	static const char* const kColours[] = { "#cfe8cf", "#f6e3a1", "#f0b4a8", "#eeeeee" };
	std::string what = v.reason.empty() ? "stands" : v.reason;
	char numbers[160];
	std::snprintf( numbers, sizeof( numbers ), "inverted %.2g, energy %+.2g, depth %.2f cells, recovery %.2f s, %.0f us", v.inverted,
		v.energyGrowth, v.depth, v.recovery, v.microseconds );
	page << "<td style='background:" << kColours[int( v.colour )] << "' title='" << numbers << "; replay: --case \"" << key.first
		 << "\" --method \"" << key.second << "\" --seed " << plan.seed << " --steps " << plan.steps << "'>"
		 << ( v.colour == Colour::Green ? "" : what ) << "</td>";
}

bool writePage(
	const StabilityPlan& plan, const std::vector<StabilityCase>& cases, const std::vector<StabilityMethod>& methods, const Matrix& matrix )
{
	std::ofstream page( plan.folder + "/stability.html" );
	page << "<!doctype html><html lang=en><meta charset=utf-8><title>Stability</title><style>body{font:14px/1.4 "
			"system-ui,sans-serif;margin:2rem}table{border-collapse:"
			"collapse;font-size:11px}td,th{border:1px solid #ccc;padding:.2rem "
			".4rem;max-width:6rem}th{text-align:left}</style><h1>Stability</h1><p>"
		 << plan.steps
		 << " game steps each. Red: numbers not finite, more than a thousandth of the cells inverted at the end, energy up by more than a "
			"hundredth "
			"without work done, a node's middle through a static plane, or no recovery within 10 s. Yellow: recovery slower than 2 s, more "
			"than half a cell deep, or "
			"stiffness that asks for more than 16 substeps. Point at a cell for its numbers and the words that replay "
			"it.</p><table><tr><th></th>";
	for ( const StabilityMethod& method : methods )
	{
		page << "<th>" << method.name << "</th>";
	}
	page << "</tr>\n";
	for ( const StabilityCase& one : cases )
	{
		page << "<tr><th>" << one.name << "</th>";
		for ( const StabilityMethod& method : methods )
		{
			const auto at = matrix.find( { one.name, method.name } );
			writeCell( plan, { one.name, method.name }, at != matrix.end() ? at->second : Verdict{ Colour::None, "not run" }, page );
		}
		page << "</tr>\n";
	}
	page << "</table></html>\n";
	return bool( page.flush() );
}

void printCounts( const std::vector<StabilityMethod>& methods, const Matrix& matrix )
{
	std::printf( "\n%-36s %6s %7s %5s\n", "", "green", "yellow", "red" );
	for ( const StabilityMethod& method : methods )
	{
		int counts[4] = {};
		std::string worst;
		for ( const auto& [key, verdict] : matrix )
		{
			if ( key.second == method.name )
			{
				++counts[int( verdict.colour )];
				worst += verdict.colour == Colour::Red ? ( worst.empty() ? "" : "; " ) + key.first + ": " + verdict.reason : "";
			}
		}
		std::printf( "%-36s %6d %7d %5d   %s\n", method.name.c_str(), counts[0], counts[1], counts[2], worst.c_str() );
	}
}

} // namespace

int studyStability( const StabilityPlan& plan )
{
	std::vector<StabilityCase> cases = stabilityCases();
	std::vector<StabilityMethod> methods = stabilityMethods( plan.withBullet );
	cases.erase(
		std::remove_if( cases.begin(), cases.end(), [&plan]( const auto& c ) { return !isWanted( c.name, plan.cases ); } ), cases.end() );
	methods.erase( std::remove_if( methods.begin(), methods.end(), [&plan]( const auto& m ) { return !isWanted( m.name, plan.methods ); } ),
		methods.end() );
	std::error_code error;
	std::filesystem::create_directories( plan.folder, error );
	const std::string path = plan.folder + "/stability.csv";
	Matrix matrix = plan.isFresh ? Matrix() : readMatrix( path, plan );
	std::ofstream csv( path, plan.isFresh ? std::ios::trunc : std::ios::app );
	if ( csv.tellp() == 0 )
	{
		csv << kHeader << '\n';
	}
	listenForStop();
	{
		Progress progress( int( cases.size() * methods.size() ) );
		for ( const StabilityCase& one : cases )
		{
			for ( const StabilityMethod& method : methods )
			{
				if ( stopWasAsked() )
				{
					std::fprintf( stderr, "\npliant_study: Stopped. The same command goes on where it was.\n" );
					return 130;
				}
				progress.begin( one.name + ": " + method.name );
				const Key key = { one.name, method.name };
				if ( matrix.find( key ) == matrix.end() )
				{
					matrix[key] = endure( one, method, plan.steps, plan.seed );
					csv << lineOf( plan, key, matrix[key] ) << std::endl;
				}
				progress.done();
			}
		}
	}
	printCounts( methods, matrix );
	if ( !csv || !writePage( plan, cases, methods, matrix ) )
	{
		std::fprintf( stderr, "pliant_study: %s cannot be written.\n", plan.folder.c_str() );
		return 1;
	}
	std::printf( "\n%s/stability.html, stability.csv\n", plan.folder.c_str() );
	const bool isRed = std::any_of( matrix.begin(), matrix.end(),
		[]( const auto& cell ) { return cell.first.second == "explicit" && cell.second.colour == Colour::Red; } );
	return isRed ? 3 : 0;
}

} // namespace pliant_study
