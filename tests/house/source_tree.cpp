#include "house/source_tree.h"

#include <fstream>
#include <regex>

namespace house {

namespace fs = std::filesystem;

namespace {

const char* const kSourceFolders[] = { "plugin", "demos", "third_party_glue", "tests" };

// The folders in which includes from other folders are searched, as in the targets' include folders.
const char* const kIncludeFolders[] = { "", "plugin/", "plugin/include/", "tests/" };

} // namespace

bool SourceFile::isHeader() const
{
	return path.ends_with( ".h" );
}

SourceTree::SourceTree( const fs::path& root ) : m_root( root )
{
	for ( const char* folder : kSourceFolders )
	{
		if ( !fs::is_directory( root / folder ) )
		{
			continue;
		}
		for ( const fs::directory_entry& entry : fs::recursive_directory_iterator( root / folder ) )
		{
			const fs::path extension = entry.path().extension();
			if ( entry.is_regular_file() && ( extension == ".h" || extension == ".cpp" ) )
			{
				read( entry.path() );
			}
		}
	}
	for ( auto& [path, file] : m_files )
	{
		for ( Include& include : file.includes )
		{
			include.resolved = resolve( file, include );
		}
	}
}

void SourceTree::read( const fs::path& path )
{
	static const std::regex kInclude( R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])" );

	SourceFile file;
	file.path = fs::relative( path, m_root ).generic_string();
	std::ifstream stream( path );
	for ( std::string line; std::getline( stream, line ); )
	{
		file.lines.push_back( line );
		std::smatch match;
		if ( std::regex_search( line, match, kInclude ) )
		{
			file.includes.push_back( { match[2], "", int( file.lines.size() ), match[1] == "<" } );
		}
	}
	m_files[file.path] = std::move( file );
}

std::string SourceTree::resolve( const SourceFile& from, const Include& include ) const
{
	if ( !include.angled )
	{
		const std::string neighbour = ( fs::path( from.path ).parent_path() / include.name ).lexically_normal().generic_string();
		if ( m_files.contains( neighbour ) )
		{
			return neighbour;
		}
	}
	for ( const char* folder : kIncludeFolders )
	{
		const std::string candidate = fs::path( folder + include.name ).lexically_normal().generic_string();
		if ( m_files.contains( candidate ) )
		{
			return candidate;
		}
	}
	return "";
}

std::string joined( std::initializer_list<std::string_view> parts )
{
	std::string all;
	for ( const std::string_view part : parts )
	{
		all += part;
	}
	return all;
}

} // namespace house
