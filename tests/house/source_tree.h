#pragma once

// +-----------------------------------------------------------------------------------------------------------------+
// | The repository's own sources as text: files, their lines, their includes, and the rules that apply to them.     |
// +-----------------------------------------------------------------------------------------------------------------+

#include <filesystem>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace house {

struct Include
{
	std::string name;     ///< as written
	std::string resolved; ///< our file with that name, from the root; empty for other files
	int line = 0;
	bool angled = false;
};

struct SourceFile
{
	std::string path; ///< from the root, with slashes
	std::vector<std::string> lines;
	std::vector<Include> includes;

	bool isHeader() const;
};

/// A sentence for each breach, in the order of the paths.
using Complaints = std::vector<std::string>;

class SourceTree
{
public:
	/// Reads every .h and .cpp below the folders of `root` that hold sources.
	explicit SourceTree( const std::filesystem::path& root );

	/// Sorted by path.
	const std::map<std::string, SourceFile>& files() const { return m_files; }
	const std::filesystem::path& root() const { return m_root; }

private:
	void read( const std::filesystem::path& file );
	std::string resolve( const SourceFile& from, const Include& include ) const;

	std::filesystem::path m_root;
	std::map<std::string, SourceFile> m_files;
};

/// Returns the parts one after the other.
std::string joined( std::initializer_list<std::string_view> parts );

/// Includes lead to lower floors of the plugin only, and foreign libraries are included in their own folders only.
Complaints checkFloors( const SourceTree& tree );

/// Within a floor of the plugin: headers include lower sub-folders only, every folder is listed, and none has too many files.
Complaints checkSubfolders( const SourceTree& tree );

/// The stages of a step are called in plugin/world/step/world_step.cpp, each of them, and from no other file.
Complaints checkStages( const SourceTree& tree );

/// They are called there in the order of the step.
Complaints checkStageOrder( const SourceTree& tree );

/// No header includes itself through others.
Complaints checkCircles( const SourceTree& tree );

/// No core file reaches a Bullet header through its includes; no public one an Eigen header.
Complaints checkReach( const SourceTree& tree );

/// Length of files and functions, include guards, words that our sources must not contain.
Complaints checkShape( const SourceTree& tree );

/// No two headers of the plugin define a constant with the same name: for the linker they would be one object, with either value.
Complaints checkConstants( const SourceTree& tree );

/// A number that is a constant of a file's scope is in a file of constants, unless it is listed as a part of a structure or a format.
Complaints checkNumbers( const SourceTree& tree );

/// The calls of the public headers that take an argument other than a bool: the number of overloads by qualified name.
std::map<std::string, int> publicCalls( const SourceTree& tree );

/// Each of them has a test of its misuse.
Complaints checkMisuse( const SourceTree& tree );

/// The top level contains only the files and folders that belong there.
Complaints checkTopLevel( const std::filesystem::path& root );

/// Files, folders and tests that documents name exist, and so do the targets of their links.
Complaints checkDocuments( const SourceTree& tree );

/// One version everywhere.
Complaints checkVersion( const std::filesystem::path& root );

} // namespace house
