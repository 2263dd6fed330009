#pragma once

// Return values: a code for the program and a sentence for the developer. No public function throws.

#include "pliant/export.h"

#include <string>
#include <utility>

namespace pliant {

/// Why a call was refused. `Ok` is zero.
enum class ResultCode : int
{
	Ok = 0,
	EmptyMesh,        ///< the mesh has no vertex or no triangle
	NonFiniteVertex,  ///< a vertex coordinate is NaN or infinite
	IndexOutOfRange,  ///< a triangle refers to a vertex that does not exist
	ExtentOutOfRange, ///< the mesh is too small or too large for float arithmetic at the requested cell size
	ZeroVolume,       ///< no triangle has an area; or, with Shell::Never, no inside was found at the requested cell size
	TooManyTriangles, ///< more triangles than LatticeSettings::maxTriangles, or more than three vertices for each of these
	TooManyCells,     ///< more cells than LatticeSettings::maxCells
	OutOfMemory,
	Cancelled,      ///< the progress callback returned false
	BadSettings,    ///< a value of LatticeSettings or CrackSettings is out of its range
	BadMaterial,    ///< a value of Material is out of its range, or does not go with another one
	BadArgument,    ///< any other argument is invalid, or this build lacks a feature (build.h); the sentence says which
	FileNotFound,   ///< not returned by the library; for programs that read meshes from files
	FileUnreadable, ///< the file exists, but no mesh can be read from it; as FileNotFound
	FileTooLarge,   ///< as FileNotFound
	TimeLimit,      ///< as FileNotFound
	TooFolded ///< the surface is folded so often within its bounding box that no cell size separates its layers; or, with Shell::Never,
			  ///< it is so folded or so widely open that telling inside from outside takes too long
};

/// The code's name, e.g. "TooManyCells"; "unknown" for a value that is no ResultCode. Never null.
PLIANT_API const char* toString( ResultCode code );

/// The outcome of a call: a code, and a sentence that names the cause and, where there is one, the setting to change. Empty for Ok.
struct Status
{
	ResultCode code = ResultCode::Ok; ///< why the call was refused
	std::string sentence;             ///< in English, for the developer; empty for Ok

	/// Whether the call was carried out.
	bool ok() const { return code == ResultCode::Ok; }
};

/// A value, or the reason why there is none. `value` is default-constructed unless `ok()`.
template <class T>
struct Result
{
	Status status; ///< the outcome
	T value{};     ///< what was asked for; default-constructed (null for pointers) unless ok()

	/// Whether there is a value.
	bool ok() const { return status.ok(); }
	/// The same.
	explicit operator bool() const { return ok(); }

	/// A result with a value.
	static Result success( T made ) { return Result{ Status{}, std::move( made ) }; }
	/// A result without one. `code`: not Ok.
	static Result failure( ResultCode code, std::string sentence ) { return Result{ Status{ code, std::move( sentence ) }, T{} }; }
};

} // namespace pliant
