#pragma once

// Return values: a code for the program and a sentence for the developer. No public function throws.

#include "pliant/export.h"

#include <string>
#include <utility>

namespace pliant {

/// Why a call was refused. `Ok` is zero. Meshes and the build of templates have codes of their own. In all other calls the code follows the
/// kind of mistake: BadMaterial for a Material, BadSettings for one of the structures of settings, BadArgument for all else. Where two of
/// them do not go together, the one that the call sets is to blame; in SoftBody::create the settings.
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
	OutOfMemory,      ///< memory did not suffice; nothing has changed
	Cancelled,        ///< the progress callback returned false
	BadSettings, ///< a value of a settings structure (LatticeSettings, Fracture, Wind and others) is out of its range, or does not go with
				 ///< the material
	BadMaterial, ///< a value of Material is out of its range, or does not go with another one or with the body
	BadArgument, ///< any other argument is invalid (a number, an index, a pointer, a field), or this build lacks a feature (build.h)
	/// The surface is folded so often within its bounding box that no cell size separates its layers; or, with Shell::Never, it is so
	/// folded or so widely open that telling inside from outside takes too long.
	TooFolded,
	/// The data of a load is no snapshot of this kind, is truncated or damaged, comes from a newer version or from a build of the other
	/// precision, or does not fit the world or the templates.
	BadSnapshot
};

/// The code's name, e.g. "TooManyCells"; "unknown" for a value that is no ResultCode. Never null.
[[nodiscard]] PLIANT_API const char* toString( ResultCode code );

/// The outcome of a call: a code, and a sentence that names the cause and, where there is one, the setting to change. Empty for Ok.
struct [[nodiscard]] Status
{
	ResultCode code = ResultCode::Ok; ///< why the call was refused
	std::string sentence;             ///< in English, for the developer; empty for Ok

	/// Whether the call was carried out.
	[[nodiscard]] bool ok() const { return code == ResultCode::Ok; }
};

/// A value, or the reason why there is none. `value` is default-constructed unless `ok()`.
template <class T>
struct [[nodiscard]] Result
{
	Status status; ///< the outcome
	T value{};     ///< the result; default-constructed (null for pointers) unless ok()

	/// Whether there is a value.
	[[nodiscard]] bool ok() const { return status.ok(); }
	/// The same.
	explicit operator bool() const { return ok(); }

	/// A result with a value.
	[[nodiscard]] static Result success( T made ) { return Result{ Status{}, std::move( made ) }; }
	/// A result without one. `code`: not Ok.
	[[nodiscard]] static Result failure( ResultCode code, std::string sentence )
	{
		return Result{ Status{ code, std::move( sentence ) }, T{} };
	}
};

} // namespace pliant
