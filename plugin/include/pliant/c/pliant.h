#pragma once

// Pliant in plain C: all of it (docs/guide/c.md).
//
//     pliant/c/types.h       results, identities, version, buffers
//     pliant/c/settings.h    materials, breaking, levels of detail, attachments
//     pliant/c/template.h    meshes converted into cells
//     pliant/c/world.h       worlds, events, rays, saving, what all objects have
//     pliant/c/rigid.h       rigid bodies
//     pliant/c/joints.h      joints of rigid bodies and frames
//     pliant/c/body.h        soft bodies
//     pliant/c/forces.h      wind, water, fields, explosions, gas in hollow bodies
//     pliant/c/skeleton.h    bodies that follow an animated pose
//     pliant/c/query.h       nearest points, inside or outside, volume
//     pliant/c/debug.h       debug drawing
//     pliant/c/render.h      skinning on the graphics card, tangents, further meshes
//
// pliant/c/mix.h, not included here, is C++: for engines that use both faces on one world.

#include "pliant/c/body.h"
#include "pliant/c/debug.h"
#include "pliant/c/forces.h"
#include "pliant/c/joints.h"
#include "pliant/c/query.h"
#include "pliant/c/render.h"
#include "pliant/c/rigid.h"
#include "pliant/c/settings.h"
#include "pliant/c/skeleton.h"
#include "pliant/c/template.h"
#include "pliant/c/types.h"
#include "pliant/c/world.h"
