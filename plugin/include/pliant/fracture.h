#pragma once

// Breaking of bodies, and treatment of the pieces. Ohta et al. 2009, "Fracturing"; Steinemann et al. 2008, section 5.1.

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
	Plane,
	/// The body is divided into shards in advance (Fracture::shardSize), which are invisible until it breaks. Where the largest stretch
	/// exceeds the limit set by strength or breakStrain, a crack runs between shards, across that stretch, until it reaches a free surface
	/// or has used up the strain energy of the adjacent shards (Fracture::toughness). Crack faces are the smooth borders of the shards.
	Shards
};

/// BreakRule::Shards: how the shards are arranged.
enum class ShardPattern : int
{
	Scattered, ///< at random, of about equal size. Default. Longer along Fracture::grain where that is set.
	/// In rings around the point that breaks first, larger further away, and in sectors: glass. Fracture::grain is the axis of the rings;
	/// zero: the direction in which the body is thinnest.
	Rings
};

/// Treatment of pieces of at most Fracture::smallCells cells.
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

	/// BreakRule::Shards: mean size of a shard, m, (0, 1e6]; at most half of the body's longest side is used, and at least two cells.
	float shardSize = 0.1f;
	/// BreakRule::Shards: energy that a crack takes for its area, J/m^2, [0, 1e12]. Higher values make fewer and larger pieces. 0: as much
	/// as shards of shardSize hold at kRunsAt of the breaking stretch, so that a crack runs through a loaded body.
	float toughness = 0.0f;
	/// BreakRule::Shards: largest fraction of the body's mass that may become crumbs, small pieces of about a third of shardSize where an
	/// impact leaves more energy than cracks between shards use up, 0 to 1.
	float crumbFraction = 0.0f;
	/// BreakRule::Shards: seed of the arrangement, any number. The same seed gives the same shards.
	unsigned shardSeed = 1;
	ShardPattern shardPattern = ShardPattern::Scattered; ///< BreakRule::Shards: their arrangement
	/// BreakRule::Shards: direction of the grain, mesh coordinates, of any length; zero: none. See ShardPattern.
	float grain[3] = { 0.0f, 0.0f, 0.0f };
	/// ShardPattern::Scattered with a grain: length of a shard along it over its width, [1, 100].
	float grainLength = 4.0f;

	/// Pieces of at most this many finest cells are small, 0 to 1 000 000.
	int smallCells = 0;
	/// Treatment of small pieces.
	SmallPieces smallPieces = SmallPieces::Keep;
	float fadeTime = 2.0f; ///< lifetime of a piece with SmallPieces::Fade, s, (0, 3600]

	/// Largest number of pieces that one body may break into over its life, including itself and the pieces of its pieces, 1 to 100 000.
	/// Once it is reached, further parts stay in the body that they would separate from: cracked, but not separated.
	int maxPieces = 1000;
};

/// Toughness that varies with position and direction: a factor on the limit strain of each link.
struct ToughnessField
{
	/// Called once for each link. `point`: 3 floats, the midpoint of the link, mesh coordinates, m. `direction`: 3 floats, unit vector
	/// along the link, mesh coordinates. Returns a factor above 0; infinity: the link never breaks. A value not above 0 is refused
	/// (BadArgument). Null: 1 everywhere.
	float ( *fraction )( const float* point, const float* direction, void* context ) = nullptr;
	void* context = nullptr; ///< passed to `fraction`; used only during the call that sets the field
};

/// BreakRule::Shards: centres of shards that the game gives, instead of an arrangement by ShardPattern. A cell belongs to the shard whose
/// centre is nearest.
struct ShardCentres
{
	/// 3 floats each, mesh coordinates, m, finite. Read only during the call that sets them. Null: none.
	const float* points = nullptr;
	int count = 0; ///< 0: none; otherwise 2 to 100 000
	/// The shard of each centre, at least 0; centres of one number make one shard together, so that shards may have any shape. Null: each
	/// centre is a shard.
	const int* shards = nullptr;
};

/// BreakRule::Shards: fraction of the breaking stretch at which a crack still runs through a body, with Fracture::toughness 0.
inline constexpr float kRunsAt = 0.3f;

/// Limits for the fragments of one world (SoftBodyHost::setDebrisBudget). Pieces over the budget fade and are removed, those first that are
/// oldest for their number of nodes; never bodies marked by SoftBody::setKept, nor pieces that the game has taken
/// (SoftBodyHost::releaseFragment).
struct DebrisBudget
{
	int maxPieces = 0;     ///< pieces that the world owns, 0 to 1 000 000; 0: any number. Default.
	int maxNodes = 0;      ///< nodes of these, 0 to 1 000 000 000; 0: any number. Default.
	float fadeTime = 1.0f; ///< time in which a piece over the budget fades, s, (0, 3600]
	/// Pieces that may come off a body in one game step, 0 to 100 000; 0: any number. Default. Parts that are cracked off but over this
	/// budget stay in the body, where nothing holds them, and come off in the next steps.
	int piecesPerStep = 0;
	/// Time that a piece must have slept until it becomes scenery, s, 0 to 3600; 0: never. Default. Scenery is static
	/// (btCollisionObject::CF_STATIC_OBJECT): it collides and is drawn as before, but nothing moves, breaks or wakes it, and it counts in
	/// no budget. A game that clears the flag has the piece back. Pieces with pins, attachments or frames, and those that are kept, stay as
	/// they are.
	float settleTime = 0.0f;
};

/// Returns Ok, or BadSettings with a sentence about the first value that is out of its range (NaN included).
PLIANT_API Status check( const DebrisBudget& budget );

/// Returns Ok, or BadSettings with a sentence about the first setting that is out of its range (NaN included).
PLIANT_API Status check( const Fracture& fracture );

} // namespace pliant
