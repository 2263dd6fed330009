#pragma once

// Model files in and out as plain arrays: what every reader and writer of this folder speaks. Knows no library and no plugin header.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pliant_glue {

enum class FileCode : int
{
	Ok = 0,
	NotFound,
	Unreadable, ///< the file is there, but no triangle mesh can be read out of it
	TooLarge,   ///< more bytes or vertices than ReadLimits allows
	TimeLimit,  ///< reading took longer than ReadLimits::seconds
	NotWritten,
	OutOfMemory
};

/// The code's name, e.g. "TimeLimit". Never null.
const char* toString( FileCode code );

/// A code for the program and a sentence for its user.
struct FileStatus
{
	FileCode code = FileCode::Ok;
	std::string sentence;

	bool ok() const { return code == FileCode::Ok; }
};

/// One triangle mesh. Arrays that a file does not have are empty.
struct ModelMesh
{
	std::string name;
	std::vector<float> positions;                 ///< x, y, z a vertex
	std::vector<float> normals;                   ///< x, y, z a vertex
	std::vector<float> textureCoordinates;        ///< u, v a vertex
	std::vector<float> vertexColours;             ///< linear RGB a vertex; written, not read
	std::vector<std::uint32_t> indices;           ///< three a triangle
	std::vector<std::uint32_t> submeshOfTriangle; ///< into submeshNames, one a triangle
	std::vector<std::string> submeshNames;
	float colour[3] = { 0.8f, 0.8f, 0.8f }; ///< written as the material's base colour, linear RGB

	std::size_t vertexCount() const { return positions.size() / 3; }
	std::size_t triangleCount() const { return indices.size() / 3; }
};

/// A reader gives up beyond these. Files come from strangers: what they promise is checked against what they hold.
struct ReadLimits
{
	std::size_t fileBytes = std::size_t( 512 ) << 20;
	std::size_t vertices = 20'000'000;
	double seconds = 30.0;
};

struct ReadResult
{
	FileStatus status;
	ModelMesh mesh;

	bool ok() const { return status.ok(); }
	static ReadResult failure( FileCode code, std::string sentence ) { return { { code, std::move( sentence ) }, {} }; }
};

} // namespace pliant_glue
