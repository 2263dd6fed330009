#pragma once

// When a body breaks, and what happens to the pieces. Ohta et al. 2009, "Fracturing"; Steinemann et al. 2008, section 5.1.

#include "pliant/export.h"
#include "pliant/result.h"

namespace pliant {

struct Material;

/// When a link between two finest cells breaks.
enum class BreakRule : int
{
	Never, ///< no link breaks by itself. Default.
	/// A link breaks when the distance of its two cells exceeds ( 1 + breakStrain ) times its rest length (Ohta et al. 2009). Cheap; cracks
	/// follow the lattice.
	Distance,
	/// When the largest stretch of a region exceeds the limit set by strength or breakStrain, all its links that cross the plane normal to
	/// that stretch break at once, and a crack continues in the plane in which it began. Cracks follow the load, not the lattice.
	Plane
};

/// What happens to pieces of at most Fracture::smallCells cells.
enum class SmallPieces : int
{
	Keep,  ///< they become bodies like all others
	Rigid, ///< each becomes one rigid cluster (Method::SingleCluster), the cheapest body. It does not break by itself, but can be cut.
	Fade,  ///< as Rigid; removed from the world after Fracture::fadeTime, and deleted if the world owns it
	Remove ///< not created; FractureEvent reports their number and mass. The part that remains of the body itself is never removed.
};

/// Off by default: a body that cannot break stores nothing for it and does no work for it. smallCells, smallPieces, fadeTime and maxPieces
/// also apply to cuts, with any rule.
struct Fracture
{
	/// When a link breaks. BreakRule::Never: the body can still be cut.
	BreakRule rule = BreakRule::Never;

	/// Strain at which the material breaks, (0, 10]: a link breaks at ( 1 + breakStrain ) times its rest length. Unused if strength is set.
	float breakStrain = 0.3f;
	/// Tensile strength, Pa, [0, 1e12]. Above 0 it replaces breakStrain by strength / Material::youngsModulus.
	float strength = 0.0f;

	/// Time after a break during which no further link breaks, s, [0, 10]. Keeps vibrations after a crack from shattering the pieces.
	float coolDown = 1.0f / 60.0f;

	/// BreakRule::Plane: an existing crack grows at this fraction of the stretch that begins a new one, (0, 1]. Small values make brittle
	/// bodies break into few large pieces.
	float growthFraction = 1.0f;

	/// Pieces of at most this many finest cells are small, 0 to 1 000 000.
	int smallCells = 0;
	/// What happens to them.
	SmallPieces smallPieces = SmallPieces::Keep;
	float fadeTime = 2.0f; ///< lifetime of a piece with SmallPieces::Fade, s, (0, 3600]

	/// Largest number of pieces that one body may break into over its life, including itself and the pieces of its pieces, 1 to 100 000.
	/// Once it is reached, further parts stay in the body that they would separate from: cracked, but not separated.
	int maxPieces = 1000;
};

/// Toughness that varies with position and direction: a factor on the limit strain of each link.
struct ToughnessField
{
	/// Called once for each link. `point`: 3 floats, the middle of the link, mesh coordinates, m. `direction`: 3 floats, unit vector along
	/// the link, mesh coordinates. Returns a factor above 0; infinity: the link never breaks. A value not above 0 is refused
	/// (BadArgument). Null: 1 everywhere.
	float ( *fraction )( const float* point, const float* direction, void* context ) = nullptr;
	void* context = nullptr; ///< passed to `fraction`; used only during the call that sets the field
};

/// Returns Ok, or BadSettings with a sentence about the first setting that is out of its range (NaN included).
PLIANT_API Status check( const Fracture& fracture );

} // namespace pliant
