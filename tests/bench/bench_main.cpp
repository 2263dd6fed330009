// Runs the benchmarks; with --markdown FILE also writes them as docs/benchmarks.md: tables, the processor's name, ratios of one run.
//   pliant_bench --benchmark_repetitions=5 --markdown docs/benchmarks.md

#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace {

std::string processorName()
{
	std::ifstream info( "/proc/cpuinfo" );
	for ( std::string line; std::getline( info, line ); )
	{
		if ( line.rfind( "model name", 0 ) == 0 )
		{
			return line.substr( line.find( ':' ) + 2 );
		}
	}
	return "unknown processor";
}

struct Row
{
	std::string label;
	double milliseconds = 0.0;
	double nanosecondsPerNode = 0.0; ///< 0: unknown
	double bytesPerNode = 0.0;       ///< 0: unknown
};

/// Prints to the console as usual and keeps the medians (or the single run).
class Keeper : public benchmark::ConsoleReporter
{
public:
	void ReportRuns( const std::vector<Run>& runs ) override
	{
		ConsoleReporter::ReportRuns( runs );
		for ( const Run& run : runs )
		{
			const bool isMedian = run.run_type == Run::RT_Aggregate && run.aggregate_name == "median";
			const bool isSingle = run.run_type == Run::RT_Iteration && run.repetitions <= 1;
			if ( run.error_occurred || !( isMedian || isSingle ) )
			{
				continue;
			}
			const std::string name = run.run_name.function_name + ( run.run_name.args.empty() ? "" : "/" + run.run_name.args );
			if ( !m_rows.count( name ) )
			{
				m_order.push_back( name );
			}
			Row& row = m_rows[name];
			row.label = run.report_label;
			row.milliseconds = run.GetAdjustedCPUTime() * 1e3 / benchmark::GetTimeUnitMultiplier( run.time_unit );
			row.nanosecondsPerNode = counter( run, "ns_per_node" );
			row.bytesPerNode = counter( run, "bytes_per_node" );
		}
	}

	void writeMarkdown( const std::string& path ) const
	{
		std::ofstream out( path );
		out << "# Benchmarks\n\nWritten by `pliant_bench --benchmark_repetitions=5 --markdown docs/benchmarks.md` (Release build); "
			   "medians, CPU time,\n"
			   "one thread unless the name says otherwise.\n\nProcessor: "
			<< processorName()
			<< ".\n\nNames: `edge` nodes along an edge of a cubic block; `w` half-width of regions; `sum` 1 table, 2 box sums; `isa` 0 "
			   "SSE2, 1 AVX2,\n"
			   "2 AVX-512; `peer` 0 Bullet pose matching, 1 Bullet clusters. A step is one substep.\n";
		std::string family;
		for ( const std::string& name : m_order )
		{
			const std::string function = name.substr( 0, name.find( '/' ) );
			if ( function != family )
			{
				family = function;
				out << "\n## " << family << "\n\n| case | ms | ns a node | bytes a node |\n|---|---|---|---|\n";
			}
			const Row& row = m_rows.at( name );
			out << "| " << ( name.size() > function.size() ? name.substr( function.size() + 1 ) : name )
				<< ( row.label.empty() ? "" : " (" + row.label + ")" ) << " | " << number( row.milliseconds ) << " | "
				<< number( row.nanosecondsPerNode ) << " | " << number( row.bytesPerNode ) << " |\n";
		}
		writeRatios( out );
	}

private:
	static double counter( const Run& run, const char* name )
	{
		const auto found = run.counters.find( name );
		return found == run.counters.end() ? 0.0 : double( found->second );
	}

	static std::string number( double value )
	{
		char text[32] = "";
		if ( value > 0.0 )
		{
			std::snprintf( text, sizeof( text ), "%.4g", value );
		}
		return text;
	}

	void writeRatios( std::ofstream& out ) const
	{
		out << "\n## Ratios in this run\n\nTime a node over ours (w = 1, box sums, widest instruction set) on the same block.\n\n"
			   "| edge | 27-point brute force | Bullet pose matching | Bullet clusters |\n|---|---|---|---|\n";
		for ( const char* edge : { "6", "13", "27" } )
		{
			const double ours = perNode( std::string( "coreStep/edge:" ) + edge + "/w:1/sum:2/isa:2" );
			out << "| " << edge << " | " << number( ratio( std::string( "bruteForce27/" ) + edge, ours ) ) << " | "
				<< number( ratio( std::string( "bulletSoftBody/edge:" ) + edge + "/peer:0", ours ) ) << " | "
				<< number( ratio( std::string( "bulletSoftBody/edge:" ) + edge + "/peer:1", ours ) ) << " |\n";
		}
	}

	double perNode( const std::string& name ) const
	{
		const auto found = m_rows.find( name );
		return found == m_rows.end() ? 0.0 : found->second.nanosecondsPerNode;
	}

	double ratio( const std::string& name, double ours ) const { return ours > 0.0 ? perNode( name ) / ours : 0.0; }

	std::map<std::string, Row> m_rows;
	std::vector<std::string> m_order;
};

} // namespace

int main( int argc, char** argv )
{
	std::string markdown;
	std::vector<char*> rest;
	for ( int i = 0; i < argc; ++i )
	{
		if ( std::strcmp( argv[i], "--markdown" ) == 0 && i + 1 < argc )
		{
			markdown = argv[++i];
			continue;
		}
		rest.push_back( argv[i] );
	}
	int count = int( rest.size() );
	benchmark::Initialize( &count, rest.data() );
	if ( benchmark::ReportUnrecognizedArguments( count, rest.data() ) )
	{
		return 1;
	}
	Keeper keeper;
	benchmark::RunSpecifiedBenchmarks( &keeper );
	if ( !markdown.empty() )
	{
		keeper.writeMarkdown( markdown );
	}
	return 0;
}
