#pragma once

// What breaks a body, and what becomes of the pieces. Ohta et al. 2009, "Fracturing"; Steinemann et al. 2008, section 5.1.

#include "pliant/export.h"
#include "pliant/result.h"

namespace pliant {

struct Material;

/// When a link between two finest cells breaks.
enum class BreakRule : int
{
	Never,
	/// When the two cells are further apart than breakStrain allows (Ohta et al. 2009): cheap, and cracks follow the lattice.
	Distance,
	/// When a region's largest stretch goes beyond what strength or breakStrain allows: all its links that cross the plane normal to that
	/// stretch break at once, and a crack goes on in the plane it began in. Cracks follow the load and not the lattice.
	Plane
};

/// What becomes of pieces with no more than Fracture::smallCells cells.
enum class SmallPieces : int
{
	Keep,  ///< bodies like all others
	Rigid, ///< one rigid cluster each (Method::SingleCluster): the cheapest body there is; it breaks no further by itself, but can be cut
	Fade,  ///< rigid too, and taken out of the world after Fracture::fadeTime: deleted if it is the world's, else only removed
	Remove ///< never made, with what it weighed; FractureEvent says how many and how much. What is left of the body itself always stays
};

/// Off by default: a body that cannot break keeps nothing for it and does nothing for it. Small pieces and maxPieces are for what is cut as
/// well, with any rule.
struct Fracture
{
	BreakRule rule = BreakRule::Never;

	/// Stretch at which material breaks, (0, 10]: a link at ( 1 + breakStrain ) of its rest length.
	float breakStrain = 0.3f;
	/// Tensile strength, Pa; above 0 it takes the place of breakStrain, which is then strength / Material::youngsModulus. [0, 1e12].
	float strength = 0.0f;

	/// No further link breaks for this long after some did, s, [0, 10]: what rings after a crack makes no dust.
	float coolDown = 1.0f / 60.0f;

	/// BreakRule::Plane: a crack that is there goes on at this share of the stretch that it takes to begin one, (0, 1]. Brittle things fly
	/// apart in few large pieces when it is small.
	float growthFraction = 1.0f;

	/// Pieces of at most this many finest cells are small, [0, 1 000 000].
	int smallCells = 0;
	SmallPieces smallPieces = SmallPieces::Keep;
	float fadeTime = 2.0f; ///< s, (0, 3600]

	/// Pieces that one body may come apart into over its life, itself and those of its pieces counted, 1 to 100 000. When it is
	/// reached, what would come off stays in one body with what it came off from: cracked, but not parted.
	int maxPieces = 1000;
};

/// How much a link withstands, as a share of what Fracture says; by place and, if wanted, by direction. `point` and `direction` are 3
/// floats each, in the mesh's coordinates, m and a unit vector along the link. Above 0; infinity: never breaks.
struct ToughnessField
{
	float ( *fraction )( const float* point, const float* direction, void* context ) = nullptr;
	void* context = nullptr; ///< used only while the field is being set
};

/// The first thing wrong with the settings, or Ok.
PLIANT_API Status check( const Fracture& fracture );

} // namespace pliant
