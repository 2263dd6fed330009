// +-----------------------------------------------------------------------------------------------------------------+
// | The study of one mesh.                                                                                           |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/study.h"

#include "demos/study/page.h"
#include "demos/study/progress.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

namespace pliant_study {

namespace {

constexpr double kFrontBudget = 2e-3; // s: up to this budget our methods have to be on the front

/// All runs of the plan, and their weights in the progress bar.
struct Job
{
	SceneInfo scene;
	Candidate candidate;
	int orientation = 0;
};

std::vector<Job> jobsOf( const StudyPlan& plan )
{
	std::vector<Job> jobs;
	for ( const SceneInfo& scene : plan.scenes )
	{
		Candidate turned = reference( plan.candidates );
		turned.setting += ", turned";
		jobs.push_back( { scene, turned, 1 } );
		// All candidates at each orientation in turn, so that temporary load on the machine slows all alike.
		for ( int o = 0; o < plan.orientations; ++o )
		{
			for ( const Candidate& candidate : candidates( plan.candidates ) )
			{
				// Bullet's own bodies have no lattice: they have a single orientation.
				if ( o == 0 || candidate.engine == Engine::Pliant )
				{
					jobs.push_back( { scene, candidate, o } );
				}
			}
		}
	}
	return jobs;
}

class Runner
{
public:
	Runner( const StudyPlan& plan, const Specimen& specimen, RunStore& store ) : m_plan( plan ), m_specimen( specimen ), m_store( store ) {}

	/// False if it was stopped or failed; `why` then has the reason.
	bool run( std::string& why )
	{
		std::vector<Job> jobs = jobsOf( m_plan );
		jobs.erase( std::remove_if( jobs.begin(), jobs.end(),
						[this]( const Job& job ) { return m_store.has( job.candidate.name(), job.scene.name, job.orientation ); } ),
			jobs.end() );
		Progress progress( int( jobs.size() ) );
		for ( const Job& job : jobs )
		{
			if ( stopWasAsked() )
			{
				why = "Stopped. The same command goes on where it was.";
				return false;
			}
			progress.begin( std::string( job.scene.name ) + ": " + job.candidate.name() );
			if ( m_scene != job.scene.name && !takeReference( job.scene, why ) )
			{
				return false;
			}
			if ( !m_store.add( pliant_study::run( orderOf( job ) ) ) )
			{
				why = "The runs cannot be written into " + m_plan.folder + ".";
				return false;
			}
			progress.done();
		}
		return true;
	}

	/// The reference of a scene that has been run.
	const Reference* referenceOf( const SceneInfo& scene, std::string& why )
	{
		return takeReference( scene, why ) ? &m_reference : nullptr;
	}

private:
	RunOrder orderOf( const Job& job ) const
	{
		RunOrder order;
		order.scene = job.scene;
		order.specimen = &m_specimen;
		order.candidate = job.candidate;
		order.orientation = job.orientation;
		order.reference = &m_reference.track;
		order.referenceBrokenAt = m_reference.brokenAt;
		return order;
	}

	bool takeReference( const SceneInfo& scene, std::string& why )
	{
		if ( m_scene == scene.name )
		{
			return true;
		}
		m_scene = scene.name;
		const std::string path = m_plan.folder + "/reference_" + scene.name + ".bin";
		if ( read( path, m_specimen, m_reference ) )
		{
			return true;
		}
		m_reference = Reference();
		RunOrder order;
		order.scene = scene;
		order.specimen = &m_specimen;
		order.candidate = reference( m_plan.candidates );
		order.track = &m_reference.track;
		const Record record = pliant_study::run( order );
		if ( !record.refused.empty() || !record.isHealthy )
		{
			why = "The reference could not be run: " +
				( record.refused.empty() ? std::string( "its numbers stopped being finite." ) : record.refused );
			return false;
		}
		m_reference.brokenAt = record.brokenAt;
		if ( !write( path, m_reference ) || !m_store.add( record ) )
		{
			why = "The reference cannot be written into " + m_plan.folder + ".";
			return false;
		}
		return true;
	}

	const StudyPlan& m_plan;
	const Specimen& m_specimen;
	RunStore& m_store;
	std::string m_scene;
	Reference m_reference;
};

/// Mean error between the reference and one on a rotated lattice: smaller differences mean nothing.
double floorOf( const std::vector<Record>& records, const std::string& scene )
{
	for ( const Record& record : records )
	{
		if ( isReference( record ) && record.scene == scene && record.orientation != 0 )
		{
			return record.errors.mean;
		}
	}
	return 0;
}

void printFront( const std::string& name, const std::vector<Summary>& all, double floor )
{
	std::vector<Summary> front;
	std::copy_if( all.begin(), all.end(), std::back_inserter( front ), []( const Summary& s ) { return s.isOnFront; } );
	std::sort( front.begin(), front.end(), []( const Summary& a, const Summary& b ) { return a.median < b.median; } );
	std::printf( "\n%s: nothing is both faster and better than these (error: mean distance from the reference over the diagonal; two "
				 "references are %.4f apart)\n",
		name.c_str(), floor );
	std::printf( "  %-58s %10s %8s %8s %8s\n", "", "us a step", "error", "+-", "nodes" );
	for ( const Summary& s : front )
	{
		std::printf( "  %-58s %10.0f %8.4f %8.4f %8.0f\n", s.candidate.c_str(), 1e6 * s.median, s.errors.mean, s.spread, s.nodes );
	}
	const Standing ours = standing( all, kFrontBudget );
	if ( !ours.other.empty() )
	{
		std::printf( "  Ours against the front of all others under %.0f ms: at worst %.2f of their error (noise %.2f), against %s\n",
			1e3 * kFrontBudget, ours.ratio, ours.noise, ours.other.c_str() );
	}
}

void recommend( const std::vector<Summary>& all, const StudyPlan& plan )
{
	const Summary* pick = best( all, plan.budget );
	if ( pick == nullptr )
	{
		std::printf( "\nNothing that was tried fits into %.3g ms a step; the least is %.3g ms.\n", 1e3 * plan.budget,
			1e3 * std::min_element( all.begin(), all.end(), []( const Summary& a, const Summary& b ) {
				return a.median < b.median;
			} )->median );
		return;
	}
	std::printf( "\nFor %.3g ms a step: %s, %.3g ms, error %.4f.\n\n", 1e3 * plan.budget, pick->candidate.c_str(), 1e3 * pick->median,
		pick->errors.mean );
	for ( const Candidate& candidate : candidates( plan.candidates ) )
	{
		if ( candidate.name() == pick->candidate )
		{
			std::printf( "%s\n", codeOf( candidate ).c_str() );
		}
	}
	std::printf( "%s\n", whatIsGivenUp( all, *pick ).c_str() );
}

} // namespace

int study( const StudyPlan& plan, const Specimen& specimen )
{
	std::string why;
	RunStore store;
	if ( !store.open( plan, specimen, why ) )
	{
		std::fprintf( stderr, "pliant_study: %s\n", why.c_str() );
		return 1;
	}
	listenForStop();
	Runner runner( plan, specimen, store );
	if ( !runner.run( why ) )
	{
		std::fprintf( stderr, "\npliant_study: %s\n", why.c_str() );
		return stopWasAsked() ? 130 : 1;
	}
	PageContent content;
	content.plan = &plan;
	content.specimen = &specimen;
	std::vector<std::vector<Summary>> all;
	std::ofstream csv( plan.folder + "/study.csv" );
	csv << csvHeader() << '\n';
	nlohmann::json json;
	for ( const SceneInfo& scene : plan.scenes )
	{
		all.push_back( summarise( store.records(), scene.name ) );
		const double floor = floorOf( store.records(), scene.name );
		printFront( scene.name, all.back(), floor );
		for ( const Summary& one : all.back() )
		{
			csv << csvLine( scene.name, one ) << '\n';
			json[scene.name].push_back( toJson( one ) );
		}
		const Reference* reference = runner.referenceOf( scene, why );
		content.scenes.push_back( { scene, all.back(), floor,
			plan.drawsPictures && reference != nullptr ? drawWorst( plan, specimen, scene, all.back(), *reference ) : "" } );
	}
	content.together = plan.scenes.size() > 1 ? combine( all ) : all.front();
	if ( plan.scenes.size() > 1 )
	{
		printFront( "All scenes (geometric mean of the errors)", content.together, 0 );
	}
	if ( plan.budget > 0 )
	{
		recommend( content.together, plan );
	}
	std::ofstream( plan.folder + "/study.json" ) << json.dump( 1 ) << '\n';
	const bool isWritten = writePage( content, plan.folder + "/study.html", why );
	std::printf( "\n%s/study.html, study.csv, study.json, runs.jsonl%s%s\n", plan.folder.c_str(), why.empty() ? "" : "; ", why.c_str() );
	return isWritten && bool( csv.flush() ) ? 0 : 1;
}

} // namespace pliant_study
