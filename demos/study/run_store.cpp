// +-----------------------------------------------------------------------------------------------------------------+
// | Runs by line in runs.jsonl.                                                                                      |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/study.h"

#include <pliant/version.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace pliant_study {

namespace {

nlohmann::json headerOf( const StudyPlan& plan, const Specimen& specimen )
{
	return { { "study", 1 }, { "mesh", plan.meshName }, { "fingerprint", fingerprint( specimen.mesh ) }, { "cells", plan.candidates.cells },
		{ "levels", plan.candidates.levels }, { "density", plan.candidates.density }, { "modulus", plan.candidates.modulus },
		{ "short", plan.candidates.isShort },
		{ "version", PLIANT_VERSION_MAJOR * 10000 + PLIANT_VERSION_MINOR * 100 + PLIANT_VERSION_PATCH } };
}

} // namespace

bool RunStore::open( const StudyPlan& plan, const Specimen& specimen, std::string& why )
{
	namespace fs = std::filesystem;
	std::error_code error;
	if ( plan.isFresh )
	{
		fs::remove_all( plan.folder, error );
	}
	fs::create_directories( plan.folder, error );
	m_path = plan.folder + "/runs.jsonl";
	const nlohmann::json header = headerOf( plan, specimen );
	std::ifstream file( m_path );
	std::string line;
	std::string whole; // complete lines: the last one may have been cut off
	bool isCutOff = false;
	if ( std::getline( file, line ) )
	{
		if ( nlohmann::json::parse( line, nullptr, false ) != header )
		{
			why = m_path + " is of another study (mesh, material, resolution or version differ): take --fresh, or another --out.";
			return false;
		}
		whole = line + "\n";
		while ( std::getline( file, line ) )
		{
			const nlohmann::json json = nlohmann::json::parse( line, nullptr, false );
			if ( json.is_object() )
			{
				m_records.push_back( recordFrom( json ) );
				whole += line + "\n";
			}
			isCutOff = isCutOff || !json.is_object();
		}
	}
	else
	{
		whole = header.dump() + "\n";
		isCutOff = true;
	}
	return !isCutOff || writeAnew( whole, why );
}

// Writes a second file and renames it, so that nobody ever reads half a file, even if this program is killed.
bool RunStore::writeAnew( const std::string& whole, std::string& why ) const
{
	const std::string fresh = m_path + ".new";
	std::ofstream out( fresh, std::ios::trunc );
	std::error_code error;
	if ( ( out << whole ).flush() )
	{
		out.close();
		std::filesystem::rename( fresh, m_path, error );
	}
	if ( !out || error )
	{
		why = m_path + " cannot be written.";
		return false;
	}
	return true;
}

bool RunStore::has( const std::string& candidate, const std::string& scene, int orientation ) const
{
	return std::any_of( m_records.begin(), m_records.end(),
		[&]( const Record& r ) { return r.candidate == candidate && r.scene == scene && r.orientation == orientation; } );
}

bool RunStore::add( const Record& record )
{
	m_records.push_back( record );
	std::ofstream file( m_path, std::ios::app );
	return bool( ( file << toJson( record ).dump() << '\n' ).flush() );
}

} // namespace pliant_study
