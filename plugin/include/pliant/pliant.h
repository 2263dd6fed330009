#pragma once

// The headers for most programs: a world, templates of meshes, materials, bodies. The further headers, by subject:
//
//     pliant/soft_body_world_over.h    soft bodies in Bullet's other worlds, or in the game's own
//     pliant/render/gpu_surface.h      skins for renderers that skin on the GPU
//     pliant/render/render_mesh.h      further render meshes on a body
//     pliant/render/vertex_attributes.h  tangents, and what vertices of cracks come from
//     pliant/vehicle_raycaster.h       wheels of Bullet's vehicle on soft bodies
//     pliant/io/snapshot.h             saving and restoring
//     pliant/game/skeleton.h           bodies that follow an animated pose
//     pliant/c/pliant.h                the face in plain C, for other languages; pliant/c/mix.h for both on one world
//     pliant/build.h, version.h        which features and which version this is
//
// Included here, and usable separately: mesh.h, crack.h and body_template.h (meshes), material.h, adaptivity.h (levels of detail),
// fracture.h, attachment.h, soft_body.h, soft_body_host.h (calls of a world), step_report.h (times, fracture events), task_runner.h
// (threads), result.h (reasons of refusals).

#include "pliant/body_template.h"
#include "pliant/material.h"
#include "pliant/mesh.h"
#include "pliant/result.h"
#include "pliant/soft_body.h"
#include "pliant/soft_body_world.h"
