// +-----------------------------------------------------------------------------------------------------------------+
// | The cost of a step as a function of size.                                                                        |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/scale.h"
#include "demos/explicit_material.h"
#include "demos/must_succeed.h"

#include "demos/study/small_world.h"
#include "demos/study/subject.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>

namespace pliant_study {

namespace {

constexpr double kScaleCell = 0.1; // m
constexpr int kWarmSteps = 3;
constexpr double kLeastSeconds = 0.5; // of timed steps
constexpr int kFewestSteps = 7, kMostScaleSteps = 60;
constexpr int kPileSettles = 90; // steps until a pile has settled
constexpr int kBodiesNodes = 343;
constexpr int kTurns = 15; // number of comparisons of one thread with two
constexpr int kLargeBlock = 20000, kSmallBodies = 20;

int edgeOf( int nodes )
{
	return std::max( 1, int( std::lround( std::cbrt( double( nodes ) ) ) ) );
}

/// The median over as many steps as fit into half a second.
double medianStep( SmallWorld& world )
{
	for ( int k = 0; k < kWarmSteps; ++k )
	{
		world.timedStep();
	}
	std::vector<double> times;
	for ( double spent = 0; int( times.size() ) < kFewestSteps || ( spent < kLeastSeconds && int( times.size() ) < kMostScaleSteps ); )
	{
		times.push_back( world.timedStep() );
		spent += times.back();
	}
	std::nth_element( times.begin(), times.begin() + std::ptrdiff_t( times.size() / 2 ), times.end() );
	return times[times.size() / 2];
}

ScaleRow rowOf( const std::string& what, SmallWorld& world, int threads, double bytesBefore )
{
	ScaleRow row;
	row.what = what;
	row.threads = threads;
	row.bodies = int( world.bodies().size() );
	row.median = medianStep( world );
	const pliant::StepReport& report = world.world().stepReport();
	row.nodes = report.nodes;
	row.nanoseconds = 1e9 * row.median / std::max( 1.0, double( report.nodes ) * report.substeps );
	row.bytes = std::max( 0.0, bytesInUse() - bytesBefore ) / std::max( 1, report.nodes );
	return row;
}

pliant::Material stiffEnough()
{
	pliant::Material material = pliant_demos::explicitMaterial();
	material.youngsModulus = 5e4f;
	return material;
}

/// Next to each other, rotating slowly.
void addFlying( SmallWorld& world, int bodies, int nodesEach )
{
	world.world().setGravity( btVector3( 0, 0, 0 ) );
	const int edge = edgeOf( nodesEach );
	const auto shape = cubeTemplate( edge, kScaleCell, pliant::Skinning::NearbyNodes );
	for ( int k = 0; k < bodies; ++k )
	{
		pliant::SoftBody* body = world.add( shape, btVector3( btScalar( 2 * edge * kScaleCell * k ), 0, 0 ), stiffEnough() );
		pliant_demos::mustSucceed(
			body->setVelocities( btVector3( 0, 0, 0 ), btVector3( btScalar( 0.1 ), btScalar( 0.3 ), btScalar( 0.2 ) ) ) );
	}
}

} // namespace

ScaleRow flyingBlock( int nodes, int threads )
{
	ScaleRow row = flyingBodies( 1, nodes, threads );
	row.what = "one block, flying";
	return row;
}

ScaleRow flyingBodies( int bodies, int nodesEach, int threads )
{
	SmallWorld world;
	world.world().setThreadCount( threads );
	const double before = bytesInUse();
	addFlying( world, bodies, nodesEach );
	return rowOf( "bodies, flying", world, threads, before );
}

ThreadsRow twoThreads( int bodies, int nodesEach )
{
	SmallWorld world;
	addFlying( world, bodies, nodesEach );
	std::vector<double> faster;
	for ( int turn = 0; turn < kTurns; ++turn )
	{
		world.world().setThreadCount( 1 );
		const double one = medianStep( world );
		world.world().setThreadCount( 2 );
		faster.push_back( one / medianStep( world ) );
	}
	std::sort( faster.begin(), faster.end() );
	return { world.world().stepReport().nodes, bodies, faster[kTurns / 2], faster.front(), faster.back() };
}

ScaleRow pile( int bodies, int nodesEach, int threads )
{
	SmallWorld world;
	world.world().setThreadCount( threads );
	world.addGround();
	const double before = bytesInUse();
	const int edge = edgeOf( nodesEach );
	const auto shape = cubeTemplate( edge, kScaleCell, pliant::Skinning::NearbyNodes );
	const int row = edgeOf( bodies );
	const double apart = 1.1 * edge * kScaleCell;
	for ( int k = 0; k < bodies; ++k )
	{
		const int layer = k / ( row * row ), x = k % row, z = k / row % row;
		// Layers are offset by half a body, so that bodies lean on each other.
		const double aside = layer % 2 == 0 ? 0.0 : 0.5 * apart;
		world.add( shape, btVector3( btScalar( apart * x + aside ), btScalar( apart * ( layer + 0.55 ) ), btScalar( apart * z + aside ) ),
			stiffEnough() );
	}
	for ( int k = 0; k < kPileSettles; ++k )
	{
		world.timedStep();
	}
	return rowOf( "bodies, piled up", world, threads, before );
}

double exponentOf( const std::vector<double>& x, const std::vector<double>& y )
{
	double sx = 0, sy = 0, sxx = 0, sxy = 0;
	for ( std::size_t k = 0; k < x.size(); ++k )
	{
		const double a = std::log( x[k] ), b = std::log( y[k] );
		sx += a;
		sy += b;
		sxx += a * a;
		sxy += a * b;
	}
	const double n = double( x.size() ), below = n * sxx - sx * sx;
	return below > 0 ? ( n * sxy - sx * sy ) / below : 0.0;
}

namespace {

void compareThreads( const ScalePlan& plan, nlohmann::json& json )
{
	std::printf( "\n  two threads over one, in turn: the middle one of %d, least, most\n", kTurns );
	for ( const auto& [bodies, nodes] : { std::pair( 1, kLargeBlock ), std::pair( kSmallBodies, kBodiesNodes ) } )
	{
		if ( bodies <= plan.mostBodies && nodes <= plan.mostNodes )
		{
			const ThreadsRow row = twoThreads( bodies, nodes );
			std::printf( "  %3d flying, %6d nodes in all %26.2f %6.2f %6.2f\n", row.bodies, row.nodes, row.middle, row.least, row.most );
			json["two_threads"].push_back( { { "bodies", row.bodies }, { "nodes", row.nodes }, { "middle", row.middle },
				{ "least", row.least }, { "most", row.most } } );
		}
	}
}

} // namespace

int studyScale( const ScalePlan& plan )
{
	std::vector<ScaleRow> rows;
	const auto run = [&rows]( const ScaleRow& row ) {
		std::printf( "  %-20s %8d %9d %8d %12.3f %14.1f %12.0f\n", row.what.c_str(), row.bodies, row.nodes, row.threads, 1e3 * row.median,
			row.nanoseconds, row.bytes );
		std::fflush( stdout );
		rows.push_back( row );
	};
	std::printf( "  %-20s %8s %9s %8s %12s %14s %12s\n", "", "bodies", "nodes", "threads", "ms a step", "ns/node/substep", "bytes a node" );
	for ( const int threads : { 1, 2 } )
	{
		for ( const double nodes : { 1e3, 3e3, 1e4, 2e4, 5e4, 1e5, 3e5, 1e6 } )
		{
			if ( nodes <= plan.mostNodes )
			{
				run( flyingBlock( int( nodes ), threads ) );
			}
		}
		for ( const int bodies : { 1, 5, 20, 50, 200 } )
		{
			if ( bodies <= plan.mostBodies )
			{
				run( flyingBodies( bodies, kBodiesNodes, threads ) );
				run( pile( bodies, kBodiesNodes, threads ) );
			}
		}
	}
	std::map<std::string, std::pair<std::vector<double>, std::vector<double>>> series;
	nlohmann::json json;
	std::error_code error;
	std::filesystem::create_directories( plan.folder, error );
	std::ofstream csv( plan.folder + "/scale.csv" );
	csv << "what,bodies,nodes,threads,median_ms,ns_a_node_and_substep,bytes_a_node\n";
	for ( const ScaleRow& row : rows )
	{
		csv << '"' << row.what << "\"," << row.bodies << ',' << row.nodes << ',' << row.threads << ',' << 1e3 * row.median << ','
			<< row.nanoseconds << ',' << row.bytes << '\n';
		json["rows"].push_back( { { "what", row.what }, { "bodies", row.bodies }, { "nodes", row.nodes }, { "threads", row.threads },
			{ "median_s", row.median }, { "ns_a_node_and_substep", row.nanoseconds }, { "bytes_a_node", row.bytes } } );
		const std::string name = row.what + ", " + std::to_string( row.threads ) + ( row.threads == 1 ? " thread" : " threads" );
		for ( const std::string& key : { name, row.nodes <= 21000 ? name + ", up to 20 000 nodes" : std::string() } )
		{
			if ( !key.empty() )
			{
				series[key].first.push_back( row.nodes );
				series[key].second.push_back( row.median );
			}
		}
	}
	std::printf( "\n  cost over nodes, exponent\n" );
	for ( const auto& [name, xy] : series )
	{
		const double exponent = exponentOf( xy.first, xy.second );
		std::printf( "  %-56s %.3f\n", name.c_str(), exponent );
		json["exponents"][name] = exponent;
	}
	compareThreads( plan, json );
	std::ofstream( plan.folder + "/scale.json" ) << json.dump( 1 ) << '\n';
	std::printf( "\n%s/scale.csv, scale.json\n", plan.folder.c_str() );
	return csv.flush() ? 0 : 1;
}

} // namespace pliant_study
