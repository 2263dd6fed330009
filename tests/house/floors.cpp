#include "house/source_tree.h"

#include <algorithm>
#include <optional>
#include <set>

namespace house {

namespace {

// The floors of the plugin, from the lowest up. A file includes files of its own folder and of lower floors.
struct Floor
{
	const char* folder;
	int height;
};

const Floor kFloors[] = {
	{ "plugin/include/", 0 },
	{ "plugin/archive/", 1 },
	{ "plugin/threads/", 1 },
	{ "plugin/lattice/", 2 },
	{ "plugin/adapt/", 3 },
	{ "plugin/matching/", 4 },
	{ "plugin/fracture/", 5 },
	{ "plugin/surface/", 6 },
	{ "plugin/body/", 7 },
	{ "plugin/world/", 8 },
	{ "plugin/c/", 9 },
};

// The sub-folders of a floor, from the lowest up. A header includes headers of its own sub-folder and of lower ones. A source file may
// include any header of its floor, because it implements its sub-folder's functions on state that all sub-folders share.
const std::vector<std::vector<const char*>> kSubfolders = {
	{ "plugin/lattice/", "plugin/lattice/mesh/", "plugin/lattice/inside/", "plugin/lattice/faces/", "plugin/lattice/build/" },
	{ "plugin/adapt/", "plugin/adapt/octree/", "plugin/adapt/regions/", "plugin/adapt/moments/" },
	{ "plugin/matching/kernels/", "plugin/matching/", "plugin/matching/regions/", "plugin/matching/clusters/", "plugin/matching/step/",
		"plugin/matching/implicit/" },
	{ "plugin/fracture/", "plugin/fracture/shards/" },
	{ "plugin/surface/", "plugin/surface/kernels/", "plugin/surface/skin/", "plugin/surface/crack_shapes/", "plugin/surface/crack_complex/",
		"plugin/surface/crack_state/", "plugin/surface/crack_mesh/", "plugin/surface/render/" },
	{ "plugin/body/implicit/", "plugin/body/levels/", "plugin/body/", "plugin/body/state/" },
	{ "plugin/world/", "plugin/world/shape/", "plugin/world/query/", "plugin/world/touch/", "plugin/world/search/", "plugin/world/self/",
		"plugin/world/respond/", "plugin/world/detect/", "plugin/world/linear/", "plugin/world/joints/", "plugin/world/block/",
		"plugin/world/rigid/", "plugin/world/game/", "plugin/world/bodies/", "plugin/world/step/", "plugin/world/api/",
		"plugin/world/io/" },
	{ "plugin/c/", "plugin/c/soft/" },
};

constexpr std::size_t kMostFilesOfAFolder = 20;

// Returns the index of a file's sub-folder on its floor; -1 for a folder that no floor lists.
int indexOf( const std::vector<const char*>& subfolders, const std::string& path )
{
	const std::string folder = path.substr( 0, path.rfind( '/' ) + 1 );
	const auto found = std::ranges::find( subfolders, folder );
	return found == subfolders.end() ? -1 : int( found - subfolders.begin() );
}

constexpr int kFace = 0;
constexpr int kWorld = 8;

const Floor* floorOf( const std::string& path )
{
	const auto* found = std::ranges::find_if( kFloors, [&path]( const Floor& floor ) { return path.starts_with( floor.folder ); } );
	return found == std::end( kFloors ) ? nullptr : found;
}

bool isCore( const std::string& path )
{
	const Floor* floor = floorOf( path );
	return floor != nullptr && floor->height > kFace && floor->height < kWorld;
}

bool isPublic( const std::string& path )
{
	return path.starts_with( "plugin/include/" );
}

// The public face in C; the name of its one header for C++ shows that it is for both.
bool isC( const std::string& path )
{
	return path.starts_with( "plugin/include/pliant/c/" ) && path != "plugin/include/pliant/c/mix.h";
}

bool isKnownToC( const Include& include )
{
	return include.name == "stdint.h" || include.resolved == "plugin/include/pliant/export.h" || isC( include.resolved );
}

bool isBullet( const std::string& name )
{
	return name.starts_with( "Bullet" ) || name.starts_with( "LinearMath/" ) || name.starts_with( "bt" );
}

bool isEigen( const std::string& name )
{
	return name.starts_with( "Eigen/" ) || name.starts_with( "unsupported/Eigen/" );
}

// Names of the standard library's headers have neither a slash nor a dot; headers of processor intrinsics are the exception.
bool isStandard( const std::string& name )
{
	return name.find_first_of( "/." ) == std::string::npos || name == "immintrin.h" || name == "arm_neon.h";
}

std::string locationOf( const SourceFile& file, const Include& include )
{
	return file.path + ":" + std::to_string( include.line ) + ": includes " + include.name + ", ";
}

std::optional<std::string> wrongInPlugin( const SourceFile& file, const Include& include )
{
	const Floor* from = floorOf( file.path );
	if ( from == nullptr )
	{
		return "and stands in no folder that has a floor (house/floors.cpp lists them)";
	}
	if ( isC( file.path ) )
	{
		return isKnownToC( include ) ? std::nullopt : std::optional<std::string>( "which is not C" );
	}
	if ( include.resolved.empty() )
	{
		if ( isStandard( include.name ) && include.angled )
		{
			return std::nullopt;
		}
		const bool eigenWelcome = !isPublic( file.path );
		const bool bulletWelcome = isPublic( file.path ) || from->height >= kWorld;
		if ( ( eigenWelcome && isEigen( include.name ) ) || ( bulletWelcome && isBullet( include.name ) ) )
		{
			return std::nullopt;
		}
		return "which this folder does not know";
	}
	const Floor* to = floorOf( include.resolved );
	if ( to == nullptr )
	{
		return "which is not the plugin's";
	}
	if ( from != to && to->height >= from->height )
	{
		return "an arrow that does not run down (" + std::string( from->folder ) + " to " + to->folder + ")";
	}
	return std::nullopt;
}

std::optional<std::string> wrongElsewhere( const SourceFile& file, const Include& include )
{
	const bool demo = file.path.starts_with( "demos/" );
	const bool glue = file.path.starts_with( "third_party_glue/" );
	const std::string& to = include.resolved;
	if ( glue && ( to.starts_with( "plugin/" ) || to.starts_with( "demos/" ) || include.name.starts_with( "pliant/" ) ) )
	{
		return "but glue knows foreign libraries only";
	}
	if ( demo && to.starts_with( "plugin/" ) && !isPublic( to ) )
	{
		return "a private header of the plugin";
	}
	if ( ( demo || glue ) && to.starts_with( "tests/" ) )
	{
		return "which belongs to the tests";
	}
	return std::nullopt;
}

// Depth first through the includes; `path` is the chain of files from the start.
class CircleSearch
{
public:
	explicit CircleSearch( const SourceTree& tree ) : m_tree( tree ) {}

	Complaints run()
	{
		for ( const auto& [path, file] : m_tree.files() )
		{
			visit( path );
		}
		return m_found;
	}

private:
	void visit( const std::string& path )
	{
		if ( const auto at = std::ranges::find( m_way, path ); at != m_way.end() )
		{
			std::string circle = "a circle of includes: ";
			std::for_each( at, m_way.end(), [&circle]( const std::string& step ) { circle += step + " -> "; } );
			m_found.push_back( circle + path );
			return;
		}
		if ( !m_done.insert( path ).second )
		{
			return;
		}
		m_way.push_back( path );
		for ( const Include& include : m_tree.files().at( path ).includes )
		{
			if ( !include.resolved.empty() )
			{
				visit( include.resolved );
			}
		}
		m_way.pop_back();
	}

	const SourceTree& m_tree;
	std::vector<std::string> m_way;
	std::set<std::string> m_done;
	Complaints m_found;
};

// Every foreign header that a file reaches through our own, and the file of ours that names it.
std::map<std::string, std::string> foreignReach( const SourceTree& tree, const std::string& start )
{
	std::map<std::string, std::string> reached;
	std::set<std::string> seen = { start };
	std::vector<std::string> open = { start };
	while ( !open.empty() )
	{
		const SourceFile& file = tree.files().at( open.back() );
		open.pop_back();
		for ( const Include& include : file.includes )
		{
			if ( include.resolved.empty() )
			{
				reached.emplace( include.name, file.path );
			}
			else if ( seen.insert( include.resolved ).second )
			{
				open.push_back( include.resolved );
			}
		}
	}
	return reached;
}

} // namespace

Complaints checkFloors( const SourceTree& tree )
{
	Complaints complaints;
	for ( const auto& [path, file] : tree.files() )
	{
		for ( const Include& include : file.includes )
		{
			const auto wrong = path.starts_with( "plugin/" ) ? wrongInPlugin( file, include ) : wrongElsewhere( file, include );
			if ( wrong )
			{
				complaints.push_back( locationOf( file, include ) + *wrong );
			}
		}
	}
	return complaints;
}

Complaints checkSubfolders( const SourceTree& tree )
{
	Complaints complaints;
	std::map<std::string, std::size_t> files;
	for ( const auto& [path, file] : tree.files() )
	{
		if ( !path.starts_with( "plugin/" ) )
		{
			continue;
		}
		++files[path.substr( 0, path.rfind( '/' ) + 1 )];
		for ( const std::vector<const char*>& subfolders : kSubfolders )
		{
			const int from = indexOf( subfolders, path );
			const Floor* floor = floorOf( path );
			if ( from < 0 && floor != nullptr && floor == floorOf( subfolders[0] ) )
			{
				complaints.push_back( path + ": is in no sub-folder that house/floors.cpp lists" );
			}
			for ( const Include& include : file.includes )
			{
				if ( file.isHeader() && from >= 0 && indexOf( subfolders, include.resolved ) > from )
				{
					complaints.push_back(
						locationOf( file, include ) + "an include that does not point to a lower sub-folder of its floor" );
				}
			}
		}
	}
	for ( const auto& [folder, count] : files )
	{
		if ( count > kMostFilesOfAFolder )
		{
			complaints.push_back( folder + ": " + std::to_string( count ) + " files" );
		}
	}
	return complaints;
}

Complaints checkCircles( const SourceTree& tree )
{
	return CircleSearch( tree ).run();
}

Complaints checkReach( const SourceTree& tree )
{
	Complaints complaints;
	for ( const auto& [path, file] : tree.files() )
	{
		if ( !isCore( path ) && !isPublic( path ) )
		{
			continue;
		}
		for ( const auto& [name, through] : foreignReach( tree, path ) )
		{
			if ( ( isCore( path ) && isBullet( name ) ) || ( isPublic( path ) && isEigen( name ) ) )
			{
				complaints.push_back( joined( { path, ": reaches ", name, " through ", through } ) );
			}
		}
	}
	return complaints;
}

} // namespace house
