#pragma once

// The demos' colours, linear RGB.

#include "third_party_glue/draw_list.h"

#include <algorithm>

namespace pliant_demos {

inline constexpr pliant_glue::Colour kTerracotta = { 0.72f, 0.20f, 0.08f };
inline constexpr pliant_glue::Colour kTeal = { 0.02f, 0.34f, 0.32f };
inline constexpr pliant_glue::Colour kPlum = { 0.36f, 0.06f, 0.27f };
inline constexpr pliant_glue::Colour kStone = { 0.38f, 0.36f, 0.33f };
inline constexpr pliant_glue::Colour kSlate = { 0.08f, 0.19f, 0.38f };
inline constexpr pliant_glue::Colour kOchre = { 0.70f, 0.38f, 0.04f };
inline constexpr pliant_glue::Colour kOak = { 0.42f, 0.25f, 0.11f };
inline constexpr pliant_glue::Colour kMoss = { 0.12f, 0.26f, 0.07f };
inline constexpr pliant_glue::Colour kBrick = { 0.48f, 0.09f, 0.07f };

/// 0: teal, as expected; halfway: ochre; 1 and above: brick.
inline pliant_glue::Colour heat( float fraction )
{
	const float s = std::clamp( fraction, 0.0f, 1.0f ) * 2;
	const pliant_glue::Colour &low = s < 1 ? kTeal : kOchre, &high = s < 1 ? kOchre : kBrick;
	const float t = s < 1 ? s : s - 1;
	return { low[0] + ( high[0] - low[0] ) * t, low[1] + ( high[1] - low[1] ) * t, low[2] + ( high[2] - low[2] ) * t };
}

} // namespace pliant_demos
