// +-----------------------------------------------------------------------------------------------------------------+
// | Medians, because other load on a shared machine prolongs single steps; maxima, because these make a game drop     |
// | frames.                                                                                                           |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/step_log.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <numeric>

namespace pliant_demos {

namespace {

constexpr double kMilliseconds = 1e3;

struct Spread
{
	double median = 0, maximum = 0;
};

Spread spreadOf( std::vector<double> values )
{
	if ( values.empty() )
	{
		return {};
	}
	std::sort( values.begin(), values.end() );
	return { kMilliseconds * values[values.size() / 2], kMilliseconds * values.back() };
}

std::string row( const char* name, const Spread& spread )
{
	char text[80];
	std::snprintf( text, sizeof( text ), "  %-12s %10.3f %10.3f\n", name, spread.median, spread.maximum );
	return text;
}

nlohmann::json toJson( const Spread& spread )
{
	return { { "median", spread.median }, { "max", spread.maximum } };
}

} // namespace

void StepLog::add( const pliant::StepReport& report, double wallSeconds, int rigidContacts )
{
	for ( Stage& stage : m_stages )
	{
		stage.seconds.push_back( report.*stage.member );
	}
	m_wall.push_back( wallSeconds );
	m_maxSoftContacts = std::max( m_maxSoftContacts, report.softContacts );
	m_maxContacts = std::max( m_maxContacts, rigidContacts + report.softContacts );
	m_maxSubsteps = std::max( m_maxSubsteps, report.substeps );
	m_quarantined = std::max( m_quarantined, report.quarantined );
	m_unreachable = std::max( m_unreachable, report.unreachableStiffness );
}

double StepLog::wallSeconds() const
{
	return std::accumulate( m_wall.begin(), m_wall.end(), 0.0 );
}

double StepLog::medianStep() const
{
	return spreadOf( m_wall ).median;
}

double StepLog::longestStep() const
{
	return spreadOf( m_wall ).maximum;
}

double StepLog::medianMatching() const
{
	const auto matching = std::find_if(
		m_stages.begin(), m_stages.end(), []( const Stage& stage ) { return stage.member == &pliant::StepReport::matching; } );
	return spreadOf( matching->seconds ).median;
}

double StepLog::medianSkinning() const
{
	return spreadOf( m_skinning ).median;
}

std::string StepLog::table() const
{
	char heading[80];
	std::snprintf( heading, sizeof( heading ), "  %-12s %10s %10s\n", "ms per step", "median", "max" );
	std::string text = heading;
	for ( const Stage& stage : m_stages )
	{
		text += row( stage.name, spreadOf( stage.seconds ) );
	}
	return text + row( "whole step", spreadOf( m_wall ) ) + row( "skins, frame", spreadOf( m_skinning ) );
}

nlohmann::json StepLog::json() const
{
	nlohmann::json stages;
	for ( const Stage& stage : m_stages )
	{
		stages[stage.name] = toJson( spreadOf( stage.seconds ) );
	}
	stages["whole step"] = toJson( spreadOf( m_wall ) );
	stages["skinning per frame"] = toJson( spreadOf( m_skinning ) );
	return stages;
}

} // namespace pliant_demos
