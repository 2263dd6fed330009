#include "house/source_tree.h"

#include <algorithm>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

namespace house {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostFileLines = 420;
constexpr std::size_t kMostFunctionLines = 60;
constexpr std::size_t kMostColumns = 140; // as .clang-format has it
constexpr std::size_t kTab = 4;

// Words that our sources must not contain, and the reason.
struct Unwanted
{
	const char* folder;
	std::regex word;
	const char* reason;
};

const std::vector<Unwanted>& unwantedWords()
{
	static const std::vector<Unwanted> kWords = {
		{ "", std::regex( R"(\bs?rand\s*\()" ), "rand() is not the same everywhere: take a seeded generator of our own" },
		{ "plugin/", std::regex( R"(\bdynamic_cast\b)" ),
			"dynamic_cast needs run-time type information, which Bullet may be built without" },
		{ "plugin/", std::regex( R"(\bthrow\b(?!\s*(;|std::bad_alloc\b|Refusal\b)))" ),
			"nothing but want of memory is thrown, and refusals within a call (rejectIf): answer with a Status" },
		{ "plugin/", std::regex( R"(\bbtPolarDecomposition\b)" ), "btPolarDecomposition gives NaN and mirror images" },
		{ "plugin/", std::regex( R"(\bg(ContactAdded|ContactStarted|ContactEnded|ContactDestroyed|ContactProcessed)Callback\s*=[^=])" ),
			"Bullet's global callbacks belong to the game, which alone sets them" },
		{ "plugin/", std::regex( R"(\bstd::(cout|cerr|clog)\b|\bprintf\s*\()" ), "a library does not print" },
		{ "plugin/", std::regex( R"(\bstd::atomic<\s*(float|double)\b)" ), "atomic sums depend on the order of threads" },
	};
	return kWords;
}

std::string withoutComment( const std::string& line )
{
	return line.substr( 0, line.find( "//" ) );
}

std::size_t indentOf( const std::string& line )
{
	return std::min( line.find_first_not_of( '\t' ), line.size() );
}

bool startsLikeType( const std::string& line )
{
	static const std::regex kType( R"(^\s*(template\b.*>\s*)?(struct|class|union)\b)" );
	return std::regex_search( line, kType );
}

bool startsLikeFunction( const std::string& line )
{
	static const std::regex kOther( R"(^\s*(namespace|struct|class|union|enum|extern)\b|=\s*$)" );
	return !line.empty() && !std::regex_search( line, kOther );
}

// The first line of the declaration before an opening brace that is alone on its line.
std::string introduction( const std::vector<std::string>& lines, std::size_t brace )
{
	std::string first;
	for ( std::size_t i = brace; i > 0; --i )
	{
		const std::string line = withoutComment( lines[i - 1] );
		const std::size_t last = line.find_last_not_of( " \t" );
		if ( last == std::string::npos || std::string( ";{}" ).find( line[last] ) != std::string::npos || line.ends_with( "public:" ) ||
			line.ends_with( "private:" ) || line.ends_with( "protected:" ) || line[0] == '#' )
		{
			break;
		}
		static const std::regex kTemplate( R"(^\s*template\s*<.*>\s*$)" );
		first = std::regex_match( line, kTemplate ) ? first : line;
	}
	return first;
}

// In our layout functions begin in the first column, or one tab further inside a type, so that no parser is needed to measure them.
void measureFunctions( const SourceFile& file, Complaints& complaints )
{
	bool inType = false;
	for ( std::size_t i = 0; i < file.lines.size(); ++i )
	{
		const std::string& line = file.lines[i];
		const std::size_t indent = indentOf( line );
		if ( line.substr( indent ) != "{" || indent > 1 || ( indent == 1 && !inType ) )
		{
			inType = inType && line != "};";
			continue;
		}
		const std::string before = introduction( file.lines, i );
		if ( indent == 0 )
		{
			inType = startsLikeType( before );
		}
		if ( !startsLikeFunction( before ) )
		{
			continue;
		}
		const std::string closing = line.substr( 0, indent ) + "}";
		const auto end = std::find_if( file.lines.begin() + std::ptrdiff_t( i ), file.lines.end(),
			[&closing]( const std::string& other ) { return other.starts_with( closing ); } );
		const std::size_t length = std::size_t( end - file.lines.begin() ) - i - 1;
		if ( length > kMostFunctionLines )
		{
			complaints.push_back(
				file.path + ":" + std::to_string( i ) + ": a function of " + std::to_string( length ) + " lines: " + before );
		}
	}
}

/// Characters of a line of UTF-8, tabs at the layout's stops.
std::size_t widthOf( const std::string& line )
{
	std::size_t width = 0;
	for ( const char c : line )
	{
		const bool isContinuation = ( static_cast<unsigned char>( c ) & 0xC0 ) == 0x80;
		width = c == '\t' ? ( width / kTab + 1 ) * kTab : width + ( isContinuation ? 0 : 1 );
	}
	return width;
}

// Tables that clang-format does not format may be wider.
void measureWidths( const SourceFile& file, Complaints& complaints )
{
	bool isLaidOut = true;
	for ( std::size_t i = 0; i < file.lines.size(); ++i )
	{
		const std::string& line = file.lines[i];
		if ( line.find( "clang-format off" ) != std::string::npos || line.find( "clang-format on" ) != std::string::npos )
		{
			isLaidOut = line.find( "clang-format on" ) != std::string::npos;
		}
		if ( isLaidOut && widthOf( line ) > kMostColumns )
		{
			complaints.push_back( file.path + ":" + std::to_string( i + 1 ) + ": " + std::to_string( widthOf( line ) ) + " columns" );
		}
	}
}

void lookForWords( const SourceFile& file, Complaints& complaints )
{
	for ( std::size_t i = 0; i < file.lines.size(); ++i )
	{
		const std::string code = withoutComment( file.lines[i] );
		for ( const Unwanted& unwanted : unwantedWords() )
		{
			if ( file.path.starts_with( unwanted.folder ) && std::regex_search( code, unwanted.word ) )
			{
				complaints.push_back( file.path + ":" + std::to_string( i + 1 ) + ": " + unwanted.reason );
			}
		}
		static const std::regex kUsing( R"(^\s*using\s+namespace\b)" );
		if ( file.isHeader() && std::regex_search( code, kUsing ) )
		{
			complaints.push_back( file.path + ":" + std::to_string( i + 1 ) + ": a header opens a namespace for everyone who includes it" );
		}
	}
}

std::string contentsOf( const fs::path& path )
{
	std::ifstream stream( path );
	std::ostringstream text;
	text << stream.rdbuf();
	return text.str();
}

std::string firstMatch( const std::string& text, const std::string& pattern )
{
	std::smatch match;
	return std::regex_search( text, match, std::regex( pattern ) ) ? match[1].str() : "nothing";
}

} // namespace

Complaints checkShape( const SourceTree& tree )
{
	Complaints complaints;
	for ( const auto& [path, file] : tree.files() )
	{
		if ( file.lines.size() > kMostFileLines )
		{
			complaints.push_back( path + ": " + std::to_string( file.lines.size() ) + " lines" );
		}
		if ( file.isHeader() && std::ranges::find( file.lines, "#pragma once" ) == file.lines.end() )
		{
			complaints.push_back( path + ": no #pragma once" );
		}
		measureFunctions( file, complaints );
		if ( !path.starts_with( "tests/house/" ) ) // these files contain strings of code
		{
			measureWidths( file, complaints );
		}
		if ( !path.starts_with( "tests/house/" ) ) // these files contain the words themselves
		{
			lookForWords( file, complaints );
		}
	}
	return complaints;
}

Complaints checkConstants( const SourceTree& tree )
{
	static const std::regex kConstant( R"((?:inline )?constexpr .*?\b(k[A-Z]\w*)\s*[={[].*)" );
	Complaints complaints;
	std::map<std::string, std::string> first;
	for ( const auto& [path, file] : tree.files() )
	{
		for ( const std::string& line : file.lines )
		{
			std::smatch match;
			if ( file.isHeader() && path.starts_with( "plugin/" ) && std::regex_match( line, match, kConstant ) )
			{
				const auto [known, isNew] = first.try_emplace( match[1], path );
				if ( !isNew )
				{
					complaints.push_back( path + ": " + match[1].str() + " is in " + known->second + " too" );
				}
			}
		}
	}
	return complaints;
}

Complaints checkStages( const SourceTree& tree )
{
	// Calls of the stages: stages of the soft bodies, stages of Bullet's world, and corrections around Bullet's solver.
	static const std::vector<std::string> kStages = { "bodies.accelerate", "bodies.wakeHit", "bodies.dropPredictiveContacts",
		"bodies.holdPredictiveContacts", "bodies.collideWithThemselves", "bodies.endCollision", "bodies.releaseRefusedPairs",
		"m_moved.moveToNodes", "m_rolling.hide", "bodies.solveImplicit", "bodies.giveFrames", "bodies.readFrames", "m_stages.baseSolve",
		"bodies.noteSolved", "m_moved.moveBack", "bodies.wakeTouched", "m_rolling.apply", "m_impulses.add", "m_stages.baseIntegrate",
		"bodies.holdBack", "bodies.integrate", "bodies.testLinks", "m_stages.baseUpdateActivation", "bodies.updateActivation",
		"bodies.endStep" };
	static const std::set<std::string> kAlsoAtTheEnd = { "bodies.dropPredictiveContacts" }; // of the world
	const std::string order = "plugin/world/step/world_step.cpp";
	Complaints complaints;
	for ( const std::string& stage : kStages )
	{
		bool isThere = false;
		for ( const auto& [path, file] : tree.files() )
		{
			const bool calls = std::ranges::any_of( file.lines,
				[&stage]( const std::string& line ) { return withoutComment( line ).find( stage + "(" ) != std::string::npos; } );
			isThere = isThere || ( calls && path == order );
			if ( calls && path.starts_with( "plugin/" ) && path != order && !kAlsoAtTheEnd.contains( stage ) )
			{
				complaints.push_back( joined( { path, ": calls the stage ", stage, ", which ", order, " does" } ) );
			}
		}
		if ( !isThere )
		{
			complaints.push_back( joined( { order, ": does not call the stage ", stage } ) );
		}
	}
	return complaints;
}

Complaints checkStageOrder( const SourceTree& tree )
{
	static const std::vector<std::vector<std::string>> kOrders = {
		{ "m_stages.predict", "m_stages.findPredictiveContacts", "m_stages.detect", "m_stages.findIslands", "m_stages.solve",
			"m_stages.integrate" },
		{ "bodies.accelerate", "m_stages.basePredict", "m_stages.baseFindPredictiveContacts", "bodies.holdPredictiveContacts",
			"bodies.collideWithThemselves", "bodies.endCollision", "bodies.releaseRefusedPairs", "m_moved.moveToNodes",
			"bodies.solveImplicit", "m_stages.baseSolve", "bodies.noteSolved", "m_moved.moveBack", "bodies.wakeTouched",
			"m_stages.baseIntegrate", "bodies.holdBack", "bodies.integrate", "bodies.testLinks", "m_stages.baseUpdateActivation",
			"bodies.updateActivation" } };
	const std::string path = "plugin/world/step/world_step.cpp";
	const std::vector<std::string>& lines = tree.files().at( path ).lines;
	Complaints complaints;
	for ( const std::vector<std::string>& order : kOrders )
	{
		std::ptrdiff_t before = -1;
		for ( const std::string& stage : order )
		{
			// If a stage is also called on a shorter path for worlds without soft bodies, the last call is the one for the others.
			const auto last = std::find_if( lines.rbegin(), lines.rend(),
				[&stage]( const std::string& line ) { return withoutComment( line ).find( stage + "(" ) != std::string::npos; } );
			const std::ptrdiff_t at = lines.rend() - last - 1;
			if ( at <= before )
			{
				complaints.push_back( joined( { path, ": the stage ", stage, " is not in its place" } ) );
			}
			before = std::max( before, at );
		}
	}
	return complaints;
}

Complaints checkTopLevel( const fs::path& root )
{
	static const std::set<std::string> kBelongs = { "CMakeLists.txt", "plugin", "demos", "third_party_glue", "tests", "docs", "README.md",
		"LICENSE", "CHANGELOG.md", "CONTRIBUTING.md", "CMakePresets.json", "vcpkg.json" };
	// Written by the two scripts or by tools, and ignored by git.
	static const std::regex kMade( R"(build.*|out|models|compile_commands\.json|CMakeUserPresets\.json|Testing)" );

	Complaints complaints;
	std::set<std::string> there;
	for ( const fs::directory_entry& entry : fs::directory_iterator( root ) )
	{
		const std::string name = entry.path().filename().string();
		there.insert( name );
		if ( !name.starts_with( "." ) && !kBelongs.contains( name ) && !std::regex_match( name, kMade ) )
		{
			complaints.push_back( name + " does not belong to the top level" );
		}
	}
	for ( const std::string& name : kBelongs )
	{
		if ( !there.contains( name ) )
		{
			complaints.push_back( name + " is missing from the top level" );
		}
	}
	return complaints;
}

Complaints checkVersion( const fs::path& root )
{
	const std::string header = contentsOf( root / "plugin/include/pliant/version.h" );
	std::string version;
	for ( const char* part : { "MAJOR", "MINOR", "PATCH" } )
	{
		version += version.empty() ? "" : ".";
		version += firstMatch( header, std::string( "PLIANT_VERSION_" ) + part + R"( (\d+))" );
	}
	const std::string manifest = firstMatch( contentsOf( root / "vcpkg.json" ), R"re("version": "([^"]*)")re" );
	const std::string change = firstMatch( contentsOf( root / "CHANGELOG.md" ), R"(\n## (\d+\.\d+\.\d+))" );

	Complaints complaints;
	if ( manifest != version )
	{
		complaints.push_back( "vcpkg.json says " + manifest + ", version.h " + version );
	}
	if ( change != version )
	{
		complaints.push_back( "the latest heading of CHANGELOG.md says " + change + ", version.h " + version );
	}
	return complaints;
}

} // namespace house
