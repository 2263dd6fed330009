#pragma once

// The demos' colours, linear RGB.

#include "third_party_glue/draw_list.h"

namespace pliant_demos {

inline constexpr pliant_glue::Colour kTerracotta = { 0.78f, 0.27f, 0.13f };
inline constexpr pliant_glue::Colour kTeal = { 0.05f, 0.42f, 0.40f };
inline constexpr pliant_glue::Colour kPlum = { 0.42f, 0.12f, 0.33f };
inline constexpr pliant_glue::Colour kStone = { 0.44f, 0.43f, 0.41f };
inline constexpr pliant_glue::Colour kSlate = { 0.16f, 0.27f, 0.42f };
inline constexpr pliant_glue::Colour kOchre = { 0.72f, 0.46f, 0.10f };
inline constexpr pliant_glue::Colour kOak = { 0.42f, 0.25f, 0.11f };
inline constexpr pliant_glue::Colour kMoss = { 0.22f, 0.36f, 0.12f };
inline constexpr pliant_glue::Colour kBrick = { 0.48f, 0.09f, 0.07f };

} // namespace pliant_demos
