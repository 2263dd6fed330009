#pragma once

// +-----------------------------------------------------------------------------------------------------------------+
// | The repository's own sources as text: files, their lines, what they include, and the rules they are held to.    |
// +-----------------------------------------------------------------------------------------------------------------+

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace house {

struct Include
{
	std::string name;     ///< as written
	std::string resolved; ///< the file of ours that it names, from the root; empty when it is none of ours
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

/// What is wrong, a sentence each, in the order of the paths.
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

/// Arrows only run down the floors of the plugin, and foreign libraries stay behind their doors.
Complaints checkFloors( const SourceTree& tree );

/// Within a floor of the plugin: headers include lower sub-folders only, every folder is listed, and none has too many files.
Complaints checkSubfolders( const SourceTree& tree );

/// The stages of a step are called in plugin/world/step/world_step.cpp, each of them, and from no other file.
Complaints checkStages( const SourceTree& tree );

/// There they stand in the order of the step.
Complaints checkStageOrder( const SourceTree& tree );

/// No header reaches itself.
Complaints checkCircles( const SourceTree& tree );

/// A core file reaches no Bullet header, through whatever it includes; a public one no Eigen header.
Complaints checkReach( const SourceTree& tree );

/// Length of files and functions, include guards, words that our sources do without.
Complaints checkShape( const SourceTree& tree );

/// No two headers of the plugin have a constant of one name: they are one object to the linker, of either value.
Complaints checkConstants( const SourceTree& tree );

/// The calls of the public headers that take an argument other than a bool: the number of overloads by qualified name.
std::map<std::string, int> publicCalls( const SourceTree& tree );

/// Each of them has a test of its misuse.
Complaints checkMisuse( const SourceTree& tree );

/// Nothing at the top level but what belongs there.
Complaints checkTopLevel( const std::filesystem::path& root );

/// Documents name files, folders and tests that are there, and their links lead somewhere.
Complaints checkDocuments( const SourceTree& tree );

/// One version everywhere.
Complaints checkVersion( const std::filesystem::path& root );

} // namespace house
