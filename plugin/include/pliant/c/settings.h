#pragma once

// Structures of settings, with the fields, units, ranges and defaults of their namesakes in C++: pliant/material.h, pliant/fracture.h and
// pliant/adaptivity.h say more on each. Enumerators have the values of those there. Flags are 0 or 1.
//
// Each has a function that sets its size and the defaults: call it with sizeof of the structure, then change what differs.

#include "pliant/c/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/// pliant_material::stiffness.
enum
{
	PLIANT_STIFFNESS_YOUNGS_MODULUS = 0, ///< by youngs_modulus. Default.
	PLIANT_STIFFNESS_RAW_ALPHA           ///< by alpha
};

/// pliant_material::elasticity.
enum
{
	PLIANT_ELASTICITY_EXPLICIT = 0, ///< cheap; stiff materials and heavy loads need substeps
	PLIANT_ELASTICITY_IMPLICIT,     ///< any stiffness and load, at a higher cost per step
	PLIANT_ELASTICITY_AUTOMATIC     ///< implicit where it is needed. Default.
};

/// pliant_material::method.
enum
{
	PLIANT_METHOD_LATTICE = 0,    ///< one region per node. Default.
	PLIANT_METHOD_SINGLE_CLUSTER, ///< one region for the whole body
	PLIANT_METHOD_CLUSTERS        ///< several overlapping regions
};

/// pliant_material::cluster_mode.
enum
{
	PLIANT_CLUSTER_RIGID = 0, ///< rotation and translation only
	PLIANT_CLUSTER_LINEAR,    ///< all affine deformations. Default.
	PLIANT_CLUSTER_QUADRATIC  ///< bending and twisting too
};

/// A material: pliant::Material.
typedef struct pliant_material
{
	uint32_t size;             ///< of the structure, bytes
	float density;             ///< kg/m^3, (0, 1e6]. Default 1000.
	float youngs_modulus;      ///< Pa. Default 0: by the body's size and density.
	int32_t stiffness;         ///< PLIANT_STIFFNESS_...
	float alpha;               ///< (0, 1], with PLIANT_STIFFNESS_RAW_ALPHA and single clusters. Default 1.
	float beta;                ///< blend towards linear or quadratic goals, [0, 0.95]. Default 0.
	float volume_keeping;      ///< [0, 24.5]. Default 0.
	float yield_strain;        ///< [0, 10]; 0: no plasticity. Default 0.
	float plastic_creep;       ///< 1/s, (0, 1e4]. Default 10.
	float plastic_limit;       ///< (0, 2]. Default 0.5.
	int32_t region_half_width; ///< cells, 1 to 4. Default 1.
	int32_t far_levels;        ///< 0 to 3. Default 0.
	float damping;             ///< 1/s, [0, 1000]. Default 10.
	float wobble_damping;      ///< fraction of critical damping, [0, 1]. Default 0.15.
	int32_t elasticity;        ///< PLIANT_ELASTICITY_...
	float numerical_damping;   ///< of the implicit step, [0, 1]. Default 1.
	float rigid_strain;        ///< strain below which the body moves as a rigid one, [0, 0.1]. Default 0: never.
	int32_t method;            ///< PLIANT_METHOD_...
	int32_t cluster_mode;      ///< PLIANT_CLUSTER_...
	int32_t cluster_edge;      ///< cells, 2 to 64. Default 4.
	int32_t weights;           ///< 0: conserving, the default; 1: literal, for comparison
	int32_t rotation_from;     ///< 0: from A_pq, the default; 1: from F, for comparison
} pliant_material;

/// pliant_fracture::rule.
enum
{
	PLIANT_BREAK_NEVER = 0, ///< no link breaks by itself. Default.
	PLIANT_BREAK_DISTANCE,  ///< by the length of links
	PLIANT_BREAK_PLANE,     ///< across the largest stretch of a region
	PLIANT_BREAK_SHARDS     ///< between shards that are laid out ahead
};

/// pliant_fracture::shard_pattern.
enum
{
	PLIANT_SHARDS_SCATTERED = 0, ///< at random, of about equal size. Default.
	PLIANT_SHARDS_RINGS          ///< in rings around the point that breaks first
};

/// pliant_fracture::small_pieces.
enum
{
	PLIANT_PIECES_KEEP = 0, ///< bodies like all others. Default.
	PLIANT_PIECES_RIGID,    ///< rigid clusters
	PLIANT_PIECES_FADE,     ///< rigid, and gone after fade_time
	PLIANT_PIECES_REMOVE    ///< not made
};

/// When a body breaks: pliant::Fracture.
typedef struct pliant_fracture
{
	uint32_t size;         ///< of the structure, bytes
	int32_t rule;          ///< PLIANT_BREAK_...
	float break_strain;    ///< (0, 10]; unused where strength is set. Default 0.3.
	float strength;        ///< Pa, [0, 1e12]; above 0 it replaces break_strain. Default 0.
	float cool_down;       ///< time after a break without a further one, s, [0, 10]. Default 1/60.
	float growth_fraction; ///< (0, 1]. Default 1.
	float shard_size;      ///< m, (0, 1e6]. Default 0.1.
	float toughness;       ///< J/m^2, [0, 1e12]. Default 0: by shard_size.
	float crumb_fraction;  ///< 0 to 1. Default 0.
	uint32_t shard_seed;   ///< any number. Default 1.
	int32_t shard_pattern; ///< PLIANT_SHARDS_...
	float grain[3];        ///< direction in mesh coordinates; zero, the default: none
	float grain_length;    ///< [1, 100]. Default 4.
	int32_t small_cells;   ///< pieces of at most this many cells are small, 0 to 1 000 000. Default 0.
	int32_t small_pieces;  ///< PLIANT_PIECES_...
	float fade_time;       ///< s, (0, 3600]. Default 2.
	int32_t max_pieces;    ///< of one body over its life, 1 to 100 000. Default 1000.
} pliant_fracture;

/// Levels of detail: pliant::Adaptivity.
typedef struct pliant_adaptivity
{
	uint32_t size;              ///< of the structure, bytes
	int32_t coarse_levels;      ///< 0 to 4. Default 0: none.
	float keep_mass;            ///< above 0. Default 0.5.
	int32_t is_surface_fine;    ///< flag. Default 0.
	int32_t regions;            ///< 0: multiplicity, the default; 1: union; 2: interval
	int32_t softening;          ///< 0: none; 1, 2, 3: Ohta in 1D, 2D, 3D; 4: energy; 5: by direction, the default
	int32_t residual;           ///< 0: keep; 1: soften; 2: quadratic; 3: the larger, the default
	float coarse_stiffness;     ///< (0, 1]. Default 1.
	float interval_slack;       ///< [0, 4]. Default 0.5.
	int32_t hierarchical_sums;  ///< flag. Default 1.
	float refine_strain;        ///< [0, 10]; 0, the default: never by strain
	float merge_fraction;       ///< [0, 1). Default 0.5.
	float merge_delay;          ///< s, [0, 60]. Default 0.1.
	int32_t refines_on_contact; ///< flag. Default 0.
	int32_t nodes_per_step;     ///< 8 to 1 000 000. Default 1000.
} pliant_adaptivity;

/// Limits of the pieces of one world: pliant::DebrisBudget.
typedef struct pliant_debris_budget
{
	uint32_t size;           ///< of the structure, bytes
	int32_t max_pieces;      ///< 0 to 1 000 000; 0, the default: any number
	int32_t max_nodes;       ///< 0 to 1 000 000 000; 0, the default: any number
	float fade_time;         ///< s, (0, 3600]. Default 1.
	int32_t pieces_per_step; ///< 0 to 100 000; 0, the default: any number
	float settle_time;       ///< s, 0 to 3600; 0, the default: pieces never become scenery
} pliant_debris_budget;

/// How an attachment holds: pliant::AttachmentSettings.
typedef struct pliant_attachment_settings
{
	uint32_t size;         ///< of the structure, bytes
	uint32_t reserved;     ///< 0
	double compliance;     ///< m/N, 0 and above. Default 0: stiff.
	double breaking_force; ///< N, above 0. Default infinity: never.
} pliant_attachment_settings;

/// Fills a material with its defaults. `size`: sizeof( pliant_material ), as for all of the following. Errors: PLIANT_BAD_ARGUMENT for null
/// and for a size that this version does not know.
PLIANT_API pliant_result pliant_material_init( pliant_material* material, uint32_t size );
/// The same for breaking.
PLIANT_API pliant_result pliant_fracture_init( pliant_fracture* fracture, uint32_t size );
/// The same for levels of detail.
PLIANT_API pliant_result pliant_adaptivity_init( pliant_adaptivity* adaptivity, uint32_t size );
/// The same for a budget.
PLIANT_API pliant_result pliant_debris_budget_init( pliant_debris_budget* budget, uint32_t size );
/// The same for an attachment.
PLIANT_API pliant_result pliant_attachment_settings_init( pliant_attachment_settings* settings, uint32_t size );

#ifdef __cplusplus
}
#endif
