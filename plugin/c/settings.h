#pragma once

// Structures of settings of the C face as those of the library.

#include "c/call.h"
#include "pliant/adaptivity.h"
#include "pliant/attachment.h"
#include "pliant/body_template.h"
#include "pliant/c/body.h"
#include "pliant/c/settings.h"
#include "pliant/c/template.h"
#include "pliant/fracture.h"
#include "pliant/material.h"
#include "pliant/soft_body.h"

#include <string>

namespace pliant::c {

/// Copies fields from the library's structure.
struct ToC
{
	template <class C, class Cpp>
	void operator()( C& c, const Cpp& cpp )
	{
		c = C( cpp );
	}
	void operator()( pliant_vec3& c, const btVector3& cpp ) { c = { double( cpp.x() ), double( cpp.y() ), double( cpp.z() ) }; }
	template <class Cpp>
	void choice( std::int32_t& c, const Cpp& cpp, int, const char* )
	{
		c = std::int32_t( cpp );
	}
};

/// Copies fields to the library's structure.
struct FromC
{
	pliant_result refusal; ///< for a number that is no enumerator

	template <class C, class Cpp>
	void operator()( const C& c, Cpp& cpp )
	{
		cpp = Cpp( c );
	}
	void operator()( const pliant_vec3& c, btVector3& cpp ) { cpp.setValue( btScalar( c.x ), btScalar( c.y ), btScalar( c.z ) ); }
	/// `count`: number of enumerators, from 0 on.
	template <class Cpp>
	void choice( const std::int32_t& c, Cpp& cpp, int count, const char* name )
	{
		if ( c < 0 || c >= count )
		{
			reject(
				refusal, ( std::string( name ) + " must be one of its enumerators, 0 to " + std::to_string( count - 1 ) + "." ).c_str() );
		}
		cpp = Cpp( c );
	}
};

// Each field once, for both directions. What has no namesake on the other side is left out.

template <class F>
void fields( F& f, pliant_material& c, Material& m )
{
	f( c.density, m.density );
	f( c.youngs_modulus, m.youngsModulus );
	f.choice( c.stiffness, m.stiffness, 2, "pliant_material::stiffness" );
	f( c.alpha, m.alpha );
	f( c.beta, m.beta );
	f( c.volume_keeping, m.volumeKeeping );
	f( c.yield_strain, m.yieldStrain );
	f( c.plastic_creep, m.plasticCreep );
	f( c.plastic_limit, m.plasticLimit );
	f( c.region_half_width, m.regionHalfWidth );
	f( c.far_levels, m.farLevels );
	f( c.damping, m.damping );
	f( c.wobble_damping, m.wobbleDamping );
	f.choice( c.elasticity, m.elasticity, 3, "pliant_material::elasticity" );
	f( c.numerical_damping, m.numericalDamping );
	f( c.rigid_strain, m.rigidStrain );
	f.choice( c.method, m.method, 3, "pliant_material::method" );
	f.choice( c.cluster_mode, m.clusterMode, 3, "pliant_material::cluster_mode" );
	f( c.cluster_edge, m.clusterEdge );
	f.choice( c.weights, m.weights, 2, "pliant_material::weights" );
	f.choice( c.rotation_from, m.rotationFrom, 2, "pliant_material::rotation_from" );
}

template <class F>
void fields( F& f, pliant_fracture& c, Fracture& m )
{
	f.choice( c.rule, m.rule, 4, "pliant_fracture::rule" );
	f( c.break_strain, m.breakStrain );
	f( c.strength, m.strength );
	f( c.cool_down, m.coolDown );
	f( c.growth_fraction, m.growthFraction );
	f( c.shard_size, m.shardSize );
	f( c.toughness, m.toughness );
	f( c.crumb_fraction, m.crumbFraction );
	f( c.shard_seed, m.shardSeed );
	f.choice( c.shard_pattern, m.shardPattern, 2, "pliant_fracture::shard_pattern" );
	for ( int k = 0; k < 3; ++k )
	{
		f( c.grain[k], m.grain[k] );
	}
	f( c.grain_length, m.grainLength );
	f( c.small_cells, m.smallCells );
	f.choice( c.small_pieces, m.smallPieces, 4, "pliant_fracture::small_pieces" );
	f( c.fade_time, m.fadeTime );
	f( c.max_pieces, m.maxPieces );
}

template <class F>
void fields( F& f, pliant_adaptivity& c, Adaptivity& m )
{
	f( c.coarse_levels, m.coarseLevels );
	f( c.keep_mass, m.keepMass );
	f( c.is_surface_fine, m.isSurfaceFine );
	f.choice( c.regions, m.regions, 3, "pliant_adaptivity::regions" );
	f.choice( c.softening, m.softening, 6, "pliant_adaptivity::softening" );
	f.choice( c.residual, m.residual, 4, "pliant_adaptivity::residual" );
	f( c.coarse_stiffness, m.coarseStiffness );
	f( c.interval_slack, m.intervalSlack );
	f( c.hierarchical_sums, m.hierarchicalSums );
	f( c.refine_strain, m.refineStrain );
	f( c.merge_fraction, m.mergeFraction );
	f( c.merge_delay, m.mergeDelay );
	f( c.refines_on_contact, m.refinesOnContact );
	f( c.nodes_per_step, m.nodesPerStep );
}

template <class F>
void fields( F& f, pliant_debris_budget& c, DebrisBudget& m )
{
	f( c.max_pieces, m.maxPieces );
	f( c.max_nodes, m.maxNodes );
	f( c.fade_time, m.fadeTime );
	f( c.pieces_per_step, m.piecesPerStep );
	f( c.settle_time, m.settleTime );
}

template <class F>
void fields( F& f, pliant_attachment_settings& c, AttachmentSettings& m )
{
	f( c.compliance, m.compliance );
	f( c.breaking_force, m.breakingForce );
}

template <class F>
void fields( F& f, pliant_lattice_settings& c, LatticeSettings& m )
{
	f( c.cell_size, m.cellSize );
	f( c.target_cells, m.targetCells );
	f( c.max_cells, m.maxCells );
	f( c.max_triangles, m.maxTriangles );
	f( c.samples_per_edge, m.samplesPerEdge );
	f( c.weld_tolerance, m.weldTolerance );
	f( c.minimum_fill, m.minimumFill );
	f.choice( c.shell, m.shell, 3, "pliant_lattice_settings::shell" );
	f( c.shell_thickness, m.shellThickness );
	f.choice( c.skinning, m.skinning, 3, "pliant_lattice_settings::skinning" );
	f( c.contact_surface, m.contactSurface );
	f.choice( c.crack_faces, m.cracks.faces, 3, "pliant_lattice_settings::crack_faces" );
	f( c.noise_amplitude, m.cracks.noiseAmplitude );
	f( c.noise_wavelength, m.cracks.noiseWavelength );
	f( c.noise_seed, m.cracks.noiseSeed );
	f( c.subdivision, m.cracks.subdivision );
	f( c.bend_tolerance, m.cracks.bendTolerance );
	f( c.texture_tile, m.cracks.textureTile );
}

/// To C, without size. By value: a table takes both sides as if it wrote them.
template <class C, class Cpp>
C inC( Cpp cpp )
{
	C c{};
	ToC to;
	fields( to, c, cpp );
	return c;
}

/// From C: the library's defaults where `given` is null. Rejects a size that is not known, and with `refusal` a number that is no
/// enumerator; all else is left to the library's checks. `full`: the defaults, which the fields of the caller's version overwrite.
template <class Cpp, class C>
Cpp take( const C* given, C& full, pliant_result refusal = PLIANT_BAD_SETTINGS )
{
	readSized( given, full );
	Cpp taken;
	FromC from{ refusal };
	fields( from, full, taken );
	return taken;
}

template <class Cpp, class C>
Cpp take( const C* given, pliant_result refusal = PLIANT_BAD_SETTINGS )
{
	C full = inC<C>( Cpp{} );
	return take<Cpp>( given, full, refusal );
}

/// The defaults for building a template, without runner and progress.
inline pliant_lattice_settings defaultLattice()
{
	auto settings = inC<pliant_lattice_settings>( LatticeSettings{} );
	settings.threads = 1;
	return settings;
}

/// A mesh, which is read during the call only.
MeshView takeMesh( const pliant_mesh* mesh );

pliant_surface inC( const SurfaceView& view );

} // namespace pliant::c
