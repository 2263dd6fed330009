#include "house/source_tree.h"

#include <algorithm>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

namespace house {

namespace fs = std::filesystem;

namespace {

// Folders whose files the documents name; the documents that describe the present. docs/history/ describes the past.
const char* const kNamedFolders[] = { ".ci", "plugin", "demos", "third_party_glue", "tests", "docs" };
const char* const kDocuments[] = { "README.md", "CONTRIBUTING.md", "docs/guide", "docs/design", "docs/study.md", "docs/benchmarks.md" };

std::string relativePath( const fs::path& path, const fs::path& root )
{
	return fs::relative( path, root ).generic_string();
}

/// Every file of the repository, and every folder with a slash at its end; each with a slash in front.
std::vector<std::string> namesOf( const fs::path& root )
{
	std::vector<std::string> names;
	for ( const fs::directory_entry& entry : fs::directory_iterator( root ) )
	{
		names.push_back( "/" + entry.path().filename().string() + ( entry.is_directory() ? "/" : "" ) );
	}
	for ( const char* folder : kNamedFolders )
	{
		if ( !fs::is_directory( root / folder ) )
		{
			continue;
		}
		for ( const fs::directory_entry& entry : fs::recursive_directory_iterator( root / folder ) )
		{
			names.push_back( "/" + relativePath( entry.path(), root ) + ( entry.is_directory() ? "/" : "" ) );
		}
	}
	return names;
}

std::vector<fs::path> documentsOf( const fs::path& root )
{
	std::vector<fs::path> documents;
	for ( const char* name : kDocuments )
	{
		if ( fs::is_regular_file( root / name ) )
		{
			documents.push_back( root / name );
		}
		for ( const fs::directory_entry& entry :
			fs::is_directory( root / name ) ? fs::directory_iterator( root / name ) : fs::directory_iterator() )
		{
			if ( entry.path().extension() == ".md" )
			{
				documents.push_back( entry.path() );
			}
		}
	}
	std::ranges::sort( documents );
	return documents;
}

/// A test's name as in --gtest_filter; without the parameter's name where it has one, because the source does not contain it.
struct TestName
{
	std::string name;
	bool hasParameter;
};

template <class F>
void forEachTestLine( const SourceTree& tree, const std::regex& pattern, F&& use )
{
	for ( const auto& [path, file] : tree.files() )
	{
		for ( const std::string& line : file.lines )
		{
			std::smatch match;
			if ( path.starts_with( "tests/" ) && !path.starts_with( "tests/house/" ) && std::regex_search( line, match, pattern ) )
			{
				use( match );
			}
		}
	}
}

std::vector<TestName> testsOf( const SourceTree& tree )
{
	static const std::regex kInstance( R"(^\s*INSTANTIATE_TEST_SUITE_P\( (\w*), (\w+),)" );
	static const std::regex kTest( R"(^\s*(TEST|TEST_F|TEST_P|TYPED_TEST)\( (\w+), (\w+) \))" );
	std::map<std::string, std::set<std::string>> instances;
	forEachTestLine( tree, kInstance,
		[&instances]( const std::smatch& match ) { instances[match[2]].insert( match[1].length() == 0 ? "" : match[1].str() + "/" ); } );
	std::vector<TestName> tests;
	forEachTestLine( tree, kTest, [&]( const std::smatch& match ) {
		const std::string suite = match[2], test = match[3];
		if ( match[1] != "TEST_P" )
		{
			tests.push_back( TestName{ suite + ( match[1] == "TYPED_TEST" ? "/0." : "." ) + test, false } );
			return;
		}
		for ( const std::string& instance : instances[suite] )
		{
			tests.push_back( TestName{ joined( { instance, suite, ".", test, "/" } ), true } );
		}
	} );
	return tests;
}

/// GoogleTest's patterns: * for any text, ? for one character.
bool fits( const char* pattern, const char* text )
{
	if ( *pattern == '*' )
	{
		return fits( pattern + 1, text ) || ( *text != '\0' && fits( pattern, text + 1 ) );
	}
	if ( *pattern == '\0' || *text == '\0' )
	{
		return *pattern == *text;
	}
	return ( *pattern == '?' || *pattern == *text ) && fits( pattern + 1, text + 1 );
}

/// Any parameter is accepted: a pattern names it after a slash behind the point.
bool fits( const std::string& pattern, const TestName& test )
{
	if ( !test.hasParameter )
	{
		return fits( pattern.c_str(), test.name.c_str() );
	}
	const std::size_t slash = pattern.rfind( '/' ), point = pattern.find( '.' );
	const bool namesParameter = slash != std::string::npos && point < slash;
	return fits( pattern.c_str(), ( test.name + "0" ).c_str() ) ||
		( namesParameter && fits( pattern.substr( 0, slash + 1 ).c_str(), test.name.c_str() ) );
}

class Reader
{
public:
	Reader( const SourceTree& tree, Complaints& complaints ) :
		m_root( tree.root() ), m_names( namesOf( tree.root() ) ), m_tests( testsOf( tree ) ), m_complaints( complaints )
	{}

	void read( const fs::path& document )
	{
		std::ifstream stream( document );
		bool isSample = false;
		int number = 0;
		for ( std::string line; std::getline( stream, line ); )
		{
			m_location = relativePath( document, m_root ) + ":" + std::to_string( ++number ) + ": ";
			isSample = isSample != line.starts_with( "```" );
			checkFilters( line );
			if ( isSample )
			{
				checkPaths( line, true );
				continue;
			}
			checkLinks( line, document );
			static const std::regex kCode( "`([^`]*)`" );
			for ( std::sregex_iterator code( line.begin(), line.end(), kCode ), end; code != end; ++code )
			{
				checkPaths( ( *code )[1], false );
				checkTest( ( *code )[1] );
			}
		}
	}

private:
	/// Names of source files and of folders, complete or from any folder on. A name with a * stands for several files, and a folder that
	/// begins with none of ours is written by a program: neither is checked. In code samples, which contain other names too, only files
	/// with their folders are checked.
	void checkPaths( const std::string& text, bool isSample )
	{
		static const std::regex kPath(
			R"((?:^|[\s(<"])(?:\./)?([\w.\-/]+\.(?:h|cpp|md|sh|cmake|in)|[a-z_]+/(?:[a-z_]+/)*)(?=$|[\s,;:)>"]))" );
		for ( std::sregex_iterator path( text.begin(), text.end(), kPath ), end; path != end; ++path )
		{
			const std::string name = "/" + ( *path )[1].str();
			const std::size_t slash = name.find( '/', 1 );
			const bool isFolder = name.ends_with( "/" );
			if ( ( isFolder && !isOurs( name.substr( 1, slash - 1 ) ) ) || ( isSample && ( isFolder || slash == std::string::npos ) ) )
			{
				continue;
			}
			if ( std::ranges::none_of( m_names, [&name]( const std::string& known ) { return known.ends_with( name ); } ) )
			{
				m_complaints.push_back( m_location + "there is no " + ( *path )[1].str() );
			}
		}
	}

	bool isOurs( const std::string& folder ) const
	{
		return fs::is_directory( m_root / folder ) || fs::is_directory( m_root / "plugin" / folder );
	}

	void checkLinks( const std::string& line, const fs::path& document )
	{
		static const std::regex kLink( R"(\]\(([^)#\s]+)[^)\s]*\))" );
		for ( std::sregex_iterator link( line.begin(), line.end(), kLink ), end; link != end; ++link )
		{
			const std::string to = ( *link )[1];
			if ( !to.starts_with( "http" ) && !fs::exists( document.parent_path() / to ) )
			{
				m_complaints.push_back( m_location + "a link to " + to );
			}
		}
	}

	bool isTest( const std::string& pattern ) const
	{
		return std::ranges::any_of( m_tests, [&pattern]( const TestName& test ) { return fits( pattern, test ); } );
	}

	/// A test by its name, Suite.Test or a pattern of it; prefix and parameter may be left out.
	void checkTest( const std::string& name )
	{
		static const std::regex kTest( R"([A-Z]\w+\.(\*|[A-Z]\w*\*?)(/\w*\*?)?)" );
		if ( std::regex_match( name, kTest ) && !isTest( name ) && !isTest( "*/" + name ) && !isTest( name + "/*" ) &&
			!isTest( "*/" + name + "/*" ) )
		{
			m_complaints.push_back( m_location + "there is no test " + name );
		}
	}

	void checkFilters( const std::string& line )
	{
		static const std::regex kFilter( R"re(--gtest_filter=(?:'([^']*)'|([^\s`,;)]*)))re" );
		for ( std::sregex_iterator filter( line.begin(), line.end(), kFilter ), end; filter != end; ++filter )
		{
			std::istringstream patterns( ( *filter )[1].matched ? ( *filter )[1].str() : ( *filter )[2].str() );
			for ( std::string pattern; std::getline( patterns, pattern, ':' ); )
			{
				if ( pattern != "..." && !isTest( pattern ) )
				{
					m_complaints.push_back( m_location + "no test has a name like " + pattern );
				}
			}
		}
	}

	fs::path m_root;
	std::vector<std::string> m_names;
	std::vector<TestName> m_tests;
	Complaints& m_complaints;
	std::string m_location;
};

} // namespace

Complaints checkDocuments( const SourceTree& tree )
{
	Complaints complaints;
	Reader reader( tree, complaints );
	for ( const fs::path& document : documentsOf( tree.root() ) )
	{
		reader.read( document );
	}
	return complaints;
}

} // namespace house
