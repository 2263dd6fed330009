#pragma once

// Bodies of the adaptive scenes, made in code.

#include "third_party_glue/model_file.h"

#include <array>
#include <vector>

namespace pliant_demos {

/// A palm of `blocks` blocks of eight cells, with its lower corner at the origin, and thin fingers that hang below it along -y, each two
/// cells thick. Palm and fingers are aligned with the lattice of edge `cell`: blocks of the palm are full, blocks at a finger a quarter
/// full.
struct PalmPlan
{
	float cell = 0.02f;
	int blocks[3] = { 5, 4, 3 };
	int fingerCells = 24;                    ///< length, cells
	std::vector<std::array<int, 2>> fingers; ///< position of each: cells along x and z, even numbers

	float width( std::size_t axis ) const { return 8 * cell * float( blocks[axis] ); }
};
pliant_glue::ModelMesh makePalm( const PalmPlan& plan );

/// An open right hand, upright, seen from the palm: about 0.9 m from the wrist (at y = 0) to the middle finger's tip.
pliant_glue::ModelMesh makeHand();
/// Thumb, then the fingers in order: root and tip of each one's middle line.
struct Digit
{
	std::array<float, 3> root, tip;
	float radius;
};
const std::vector<Digit>& handDigits();
/// The digit that a point of the hand belongs to, and how far beyond its root it is: 0 at the root, 1 from one radius on.
struct DigitFraction
{
	std::size_t digit;
	float fraction;
};
DigitFraction digitAt( const float* point );

/// A tulip, about 0.65 m high, its foot at the origin; `petals` petals around a stem with two leaves.
pliant_glue::ModelMesh makeFlower( int petals );
constexpr float kFlowerHeadFrom = 0.40f; ///< m: petals above, stem and leaves below
constexpr float kFlowerHeadMiddle = 0.52f;

} // namespace pliant_demos
