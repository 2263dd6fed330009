#include "house/source_tree.h"

#include <algorithm>
#include <regex>

namespace house {

namespace {

// Numbers that nobody chose for their effect: they belong to the structure or the format that the file defines.
struct Structural
{
	const char* path;
	std::vector<std::string> names;
	const char* reason;
};

const std::vector<Structural>& structuralNumbers()
{
	static const std::vector<Structural> kNumbers = {
		{ "plugin/adapt/moments/fine_moments.cpp", { "kMonomials", "kPairs" }, "the size of a matrix" },
		{ "plugin/adapt/octree/visibility_graph.h", { "kUnitsPerCell" }, "the unit of an interface's lengths" },
		{ "plugin/adapt/regions/hierarchical_sum.h", { "kSumFloats" }, "the layout of a record" },
		{ "plugin/archive/archive.cpp", { "kLanes" }, "a part of a checksum's definition" },
		{ "plugin/body/levels/level_nodes.cpp", { "kSumLanes" }, "the lanes of a vector" },
		{ "plugin/lattice/faces/boundary_faces.cpp", { "kCorners" }, "a property of cubes" },
		{ "plugin/lattice/faces/cell_boundary.cpp", { "kCornersOfCell" }, "a property of cubes" },
		{ "plugin/matching/raised_inverse.cpp", { "kSize" }, "the size of a matrix" },
		{ "plugin/surface/kernels/skin_kernels.h", { "kSkinMapFloats" }, "the layout of a record" },
		{ "plugin/threads/task_runner.cpp", { "kTaskBits", "kMaxTasks" }, "the layout of a word" },
		{ "plugin/world/detect/manifold_order.cpp", { "kKnown" }, "a mark" },
		{ "plugin/world/io/bullet_file.cpp", { "kChunkUnit", "kFileHeader" }, "a part of Bullet's file format" },
		{ "plugin/world/io/manifold_record.cpp", { "kVectors", "kScalars", "kIntegers", "kVectorBytes", "kNumbers", "kImpulseBytes" },
			"the layout of a record" },
		{ "plugin/world/io/snapshot_format.cpp", { "kFormat" }, "the version of a format" },
	};
	return kNumbers;
}

// Public headers hold the limits that games know. Kernels are compiled once per instruction set, with constants of their own.
bool mayHoldNumbers( const std::string& path )
{
	return !path.starts_with( "plugin/" ) || path.starts_with( "plugin/include/" ) || path.starts_with( "plugin/matching/kernels/" ) ||
		path.ends_with( "constants.h" );
}

// True if an expression contains a number other than 0 and the mark of which all bits are set: names, types and those two tune nothing.
bool hasNumber( const std::string& expression )
{
	static const std::regex kLiteral( R"((?:^|[^\w.])(\.?\d[\w.']*))" );
	static const std::regex kNoNumber( R"((0[0.]*|0[xX][fF]+)[fFuUlL]*)" );
	const std::sregex_iterator end;
	return std::any_of( std::sregex_iterator( expression.begin(), expression.end(), kLiteral ), end,
		[]( const std::smatch& match ) { return !std::regex_match( match[1].str(), kNoNumber ); } );
}

// The declaration that begins on a line, without comments.
std::string statementAt( const SourceFile& file, std::size_t line )
{
	std::string statement;
	for ( std::size_t i = line; i < file.lines.size() && statement.find( ';' ) == std::string::npos; ++i )
	{
		statement += file.lines[i].substr( 0, file.lines[i].find( "//" ) ) + " ";
	}
	return statement;
}

struct Constant
{
	std::string name;
	std::size_t line;
};

// In our layout declarations at the scope of a file begin in the first column. Tables, and members of classes, are no single numbers.
std::vector<Constant> numbersOf( const SourceFile& file )
{
	static const std::regex kArithmetic( R"(^(static |inline )*const(expr)? (unsigned|int|long|float|double|auto|btScalar|)"
										 R"(std::(size_t|ptrdiff_t|u?int\d+_t|chrono::\w+))\b)" );
	static const std::regex kName( R"((?:^|[^:\w])(k[A-Z]\w*)\s*[={(])" );
	std::vector<Constant> found;
	for ( std::size_t i = 0; i < file.lines.size(); ++i )
	{
		if ( !std::regex_search( file.lines[i], kArithmetic ) )
		{
			continue;
		}
		const std::string statement = statementAt( file, i );
		for ( std::sregex_iterator at( statement.begin(), statement.end(), kName ), end; at != end && hasNumber( statement ); ++at )
		{
			found.push_back( { ( *at )[1], i + 1 } );
		}
	}
	return found;
}

} // namespace

Complaints checkNumbers( const SourceTree& tree )
{
	Complaints complaints;
	for ( const auto& [path, file] : tree.files() )
	{
		if ( mayHoldNumbers( path ) )
		{
			continue;
		}
		const std::vector<Structural>& all = structuralNumbers();
		const auto known = std::ranges::find_if( all, [&]( const Structural& one ) { return one.path == path; } );
		std::vector<std::string> expected = known == all.end() ? std::vector<std::string>() : known->names;
		for ( const Constant& constant : numbersOf( file ) )
		{
			if ( std::erase( expected, constant.name ) == 0 )
			{
				complaints.push_back( path + ":" + std::to_string( constant.line ) + ": " + constant.name +
					" belongs into the folder's constants.h (house/constants.cpp lists exceptions)" );
			}
		}
		for ( const std::string& name : expected )
		{
			complaints.push_back( joined( { path, ": has no ", name, ", ", known->reason, ", which is listed as an exception" } ) );
		}
	}
	return complaints;
}

} // namespace house
