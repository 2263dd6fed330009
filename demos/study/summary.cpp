// +-----------------------------------------------------------------------------------------------------------------+
// | Runs combined.                                                                                                   |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/summary.h"

#include "demos/study/reference.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace pliant_study {

namespace {

constexpr double kTimeNoise = 1.1;   // the times of a step vary by that factor from run to run
constexpr double kLeastError = 1e-7; // below it a mean of logarithms is meaningless: the vertices are floats

void markFront( std::vector<Summary>& all )
{
	for ( Summary& one : all )
	{
		one.isOnFront = one.refused.empty() && one.isHealthy && std::none_of( all.begin(), all.end(), [&one]( const Summary& other ) {
			return other.refused.empty() && other.isHealthy && other.median <= one.median && other.errors.mean <= one.errors.mean &&
				( other.median < one.median || other.errors.mean < one.errors.mean );
		} );
	}
}

/// The median of a candidate's runs; of an even number the lower middle one, since disturbances only make a run longer. 0 without runs.
double middleOver( const std::vector<Record>& records, const Summary& of, const std::string& scene, double Record::*time )
{
	std::vector<double> times;
	for ( const Record& record : records )
	{
		if ( record.scene == scene && record.candidate == of.candidate && record.refused.empty() )
		{
			times.push_back( record.*time );
		}
	}
	if ( times.empty() )
	{
		return 0;
	}
	const auto middle = times.begin() + std::ptrdiff_t( ( times.size() - 1 ) / 2 );
	std::nth_element( times.begin(), middle, times.end() );
	return *middle;
}

void addRun( Summary& sum, const Record& record )
{
	const double fraction = 1.0 / ++sum.runs;
	const auto blend = [fraction]( double& mean, double value ) { mean += fraction * ( value - mean ); };
	blend( sum.nodes, record.nodes );
	blend( sum.substeps, record.substeps );
	for ( std::size_t k = 0; k < kStageCount; ++k )
	{
		blend( sum.stages[k], record.stages[k] );
	}
	// Welford: spread holds the sum of squares until the last run is in.
	const double before = sum.errors.mean;
	blend( sum.errors.mean, record.errors.mean );
	sum.spread += ( record.errors.mean - before ) * ( record.errors.mean - sum.errors.mean );
	blend( sum.errors.deviation, record.errors.deviation );
	blend( sum.errors.shape, record.errors.shape );
	blend( sum.last.mean, record.last.mean );
	blend( sum.last.deviation, record.last.deviation );
	blend( sum.last.shape, record.last.shape );
	sum.curve.resize( std::max( sum.curve.size(), record.curve.size() ), 0.0 );
	for ( std::size_t k = 0; k < record.curve.size(); ++k )
	{
		blend( sum.curve[k], record.curve[k] );
	}
	if ( record.worst > sum.worst )
	{
		sum.worst = record.worst;
		sum.worstFrame = record.worstFrame;
		sum.worstOrientation = record.orientation;
	}
	const auto most = []( double& to, double value ) { to = std::max( to, value ); };
	most( sum.bytes, record.bytes ); // later runs reuse memory that was freed, which is not counted: the first run has the full number
	most( sum.volumeDrift, record.volumeDrift );
	most( sum.momentumDrift, record.momentumDrift );
	most( sum.spinDrift, record.spinDrift );
	most( sum.energyGrowth, record.energyGrowth );
	most( sum.brokenAt, record.brokenAt );
	sum.isHealthy = sum.isHealthy && record.isHealthy;
}

} // namespace

std::vector<Summary> summarise( const std::vector<Record>& records, const std::string& scene )
{
	std::vector<Summary> all;
	for ( const Record& record : records )
	{
		if ( record.scene != scene || isReference( record ) )
		{
			continue;
		}
		auto at = std::find_if( all.begin(), all.end(), [&record]( const Summary& s ) { return s.candidate == record.candidate; } );
		if ( at == all.end() )
		{
			Summary fresh;
			fresh.candidate = record.candidate;
			fresh.family = record.family;
			fresh.isOurs = record.isOurs;
			at = all.insert( all.end(), fresh );
		}
		if ( record.refused.empty() )
		{
			addRun( *at, record );
		}
		else
		{
			at->refused = record.refused;
		}
	}
	for ( Summary& one : all )
	{
		one.median = middleOver( records, one, scene, &Record::median );
		one.slow = middleOver( records, one, scene, &Record::slow );
		one.slowest = middleOver( records, one, scene, &Record::slowest );
		one.spread = one.runs > 1 ? std::sqrt( one.spread / ( one.runs - 1 ) ) : 0.0;
	}
	markFront( all );
	return all;
}

std::vector<Summary> combine( const std::vector<std::vector<Summary>>& scenes )
{
	std::vector<Summary> all;
	const double fraction = scenes.empty() ? 1.0 : 1.0 / double( scenes.size() );
	for ( const Summary& first : scenes.empty() ? std::vector<Summary>() : scenes.front() )
	{
		Summary sum = first;
		sum.median = sum.errors.mean = sum.errors.shape = sum.spread = 0;
		bool isEverywhere = true;
		for ( const std::vector<Summary>& scene : scenes )
		{
			const auto at = std::find_if(
				scene.begin(), scene.end(), [&first]( const Summary& s ) { return s.candidate == first.candidate; } );
			isEverywhere = isEverywhere && at != scene.end() && at->refused.empty();
			if ( !isEverywhere )
			{
				break;
			}
			sum.isHealthy = sum.isHealthy && at->isHealthy;
			sum.median += fraction * at->median;
			sum.slowest = std::max( sum.slowest, at->slowest );
			sum.errors.mean += fraction * std::log( std::max( at->errors.mean, kLeastError ) );
			sum.errors.shape += fraction * std::log( std::max( at->errors.shape, kLeastError ) );
			sum.spread += fraction * at->spread / std::max( at->errors.mean, kLeastError );
		}
		if ( isEverywhere )
		{
			sum.errors.mean = std::exp( sum.errors.mean );
			sum.errors.shape = std::exp( sum.errors.shape );
			sum.spread *= sum.errors.mean;
			all.push_back( sum );
		}
	}
	markFront( all );
	return all;
}

const Summary* best( const std::vector<Summary>& all, double budget, bool oursOnly )
{
	const Summary* found = nullptr;
	for ( const Summary& one : all )
	{
		const bool fits = one.refused.empty() && one.isHealthy && one.median <= budget && ( one.isOurs || !oursOnly );
		if ( fits && ( found == nullptr || one.errors.mean < found->errors.mean ) )
		{
			found = &one;
		}
	}
	return found;
}

Standing standing( const std::vector<Summary>& all, double budget )
{
	std::vector<Summary> others;
	std::copy_if( all.begin(), all.end(), std::back_inserter( others ), []( const Summary& one ) { return !one.isOurs; } );
	markFront( others );
	Standing worst;
	for ( const Summary& other : others )
	{
		if ( !other.isOnFront || other.median > budget )
		{
			continue;
		}
		const Summary* ours = best( all, kTimeNoise * other.median, true );
		const double ratio = ours == nullptr ? HUGE_VAL : ours->errors.mean / std::max( other.errors.mean, kLeastError );
		if ( ratio > worst.ratio )
		{
			const double mine = ours == nullptr ? 0 : ours->spread / std::max( ours->errors.mean, kLeastError );
			worst = { ratio, mine + other.spread / std::max( other.errors.mean, kLeastError ), other.candidate };
		}
	}
	return worst;
}

nlohmann::json toJson( const Summary& s )
{
	return { { "candidate", s.candidate }, { "family", s.family }, { "ours", s.isOurs }, { "runs", s.runs }, { "refused", s.refused },
		{ "nodes", s.nodes }, { "substeps", s.substeps }, { "bytes", s.bytes }, { "median_s", s.median }, { "p99_s", s.slow },
		{ "max_s", s.slowest }, { "stages_s", s.stages }, { "error", s.errors.mean }, { "error_spread", s.spread },
		{ "error_deviation", s.errors.deviation }, { "error_shape", s.errors.shape }, { "error_end", s.last.mean },
		{ "error_worst", s.worst }, { "curve", s.curve }, { "volume_drift", s.volumeDrift }, { "momentum_drift", s.momentumDrift },
		{ "spin_drift", s.spinDrift }, { "energy_growth", s.energyGrowth }, { "broken_at_s", s.brokenAt }, { "healthy", s.isHealthy },
		{ "front", s.isOnFront } };
}

std::string csvHeader()
{
	return "scene,candidate,family,ours,runs,refused,nodes,substeps,bytes,median_us,p99_us,max_us,error,error_spread,error_deviation,error_"
		   "shape,"
		   "error_end,error_worst,volume_drift,momentum_drift,spin_drift,energy_growth,broken_at_s,healthy,front";
}

std::string csvLine( const std::string& scene, const Summary& s )
{
	std::ostringstream out;
	out.precision( 6 );
	out << scene << ",\"" << s.candidate << "\",\"" << s.family << "\"," << s.isOurs << ',' << s.runs << ",\"" << s.refused << "\","
		<< s.nodes << ',' << s.substeps << ',' << s.bytes << ',' << 1e6 * s.median << ',' << 1e6 * s.slow << ',' << 1e6 * s.slowest << ','
		<< s.errors.mean << ',' << s.spread << ',' << s.errors.deviation << ',' << s.errors.shape << ',' << s.last.mean << ',' << s.worst
		<< ',' << s.volumeDrift << ',' << s.momentumDrift << ',' << s.spinDrift << ',' << s.energyGrowth << ',' << s.brokenAt << ','
		<< s.isHealthy << ',' << s.isOnFront;
	return out.str();
}

} // namespace pliant_study
