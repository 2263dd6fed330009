#pragma once

// How Pliant answers: a code for the program, a sentence for its author. Nothing throws across the public face.

#include "pliant/export.h"

#include <string>
#include <utility>

namespace pliant {

/// Why a call was refused. `Ok` is zero.
enum class ResultCode : int
{
	Ok = 0,
	EmptyMesh,        ///< no vertex or no triangle
	NonFiniteVertex,  ///< a coordinate is NaN or infinite
	IndexOutOfRange,  ///< a triangle names a vertex that is not there
	ExtentOutOfRange, ///< the mesh is too small or too large for float arithmetic at the asked cell size
	ZeroVolume,       ///< no triangle has an area; or no inside was found at the asked cell size and Shell::Never was asked for
	TooManyTriangles, ///< more triangles than LatticeSettings::maxTriangles
	TooManyCells,     ///< more cells than LatticeSettings::maxCells
	OutOfMemory,
	Cancelled,   ///< the progress callback said stop
	BadSettings, ///< a knob of LatticeSettings is out of its range
	BadMaterial, ///< a value of Material is out of its range
	BadArgument,
	FileNotFound,
	FileUnreadable, ///< the file is there, but no mesh can be read out of it
	FileTooLarge,
	TimeLimit,
	TooFolded ///< the surface is folded so often into its box that no cell size can tell its layers apart; or, with Shell::Never,
			  ///< folded or open so widely that telling inside from outside takes too long
};

/// The code's name, e.g. "TooManyCells". Never null.
PLIANT_API const char* toString( ResultCode code );

/// What came of a call: a code, and a sentence that names the cause and, where there is one, the knob to turn.
struct Status
{
	ResultCode code = ResultCode::Ok;
	std::string sentence;

	bool ok() const { return code == ResultCode::Ok; }
};

/// A value, or the reason why there is none. `value` is default-made unless `ok()`.
template <class T>
struct Result
{
	Status status;
	T value{};

	bool ok() const { return status.ok(); }
	explicit operator bool() const { return ok(); }

	static Result success( T made ) { return Result{ Status{}, std::move( made ) }; }
	static Result failure( ResultCode code, std::string sentence ) { return Result{ Status{ code, std::move( sentence ) }, T{} }; }
};

} // namespace pliant
