#include "c/settings.h"

#include "c/call.h"

#include <cstdio>

namespace pliant::c {

namespace {

/// Copies fields from the library's structure.
struct ToC
{
	template <class C, class Cpp>
	void operator()( C& c, const Cpp& cpp )
	{
		c = C( cpp );
	}
	template <class Cpp>
	void choice( std::int32_t& c, const Cpp& cpp, int, const char* )
	{
		c = std::int32_t( cpp );
	}
};

/// Copies fields to the library's structure.
struct FromC
{
	pliant_result code = PLIANT_OK;
	pliant_result refusal; ///< for a number that is no enumerator

	template <class C, class Cpp>
	void operator()( const C& c, Cpp& cpp )
	{
		cpp = Cpp( c );
	}
	/// `count`: number of enumerators, from 0 on.
	template <class Cpp>
	void choice( const std::int32_t& c, Cpp& cpp, int count, const char* name )
	{
		if ( c < 0 || c >= count )
		{
			char sentence[120];
			std::snprintf( sentence, sizeof sentence, "%s must be one of its enumerators, 0 to %d.", name, count - 1 );
			code = refuse( refusal, sentence );
			return;
		}
		cpp = Cpp( c );
	}
};

// Each field once, for both directions.

template <class F, class C, class Cpp>
void materialFields( F& f, C& c, Cpp& m )
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

template <class F, class C, class Cpp>
void fractureFields( F& f, C& c, Cpp& m )
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

template <class F, class C, class Cpp>
void adaptivityFields( F& f, C& c, Cpp& m )
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

template <class F, class C, class Cpp>
void debrisFields( F& f, C& c, Cpp& m )
{
	f( c.max_pieces, m.maxPieces );
	f( c.max_nodes, m.maxNodes );
	f( c.fade_time, m.fadeTime );
	f( c.pieces_per_step, m.piecesPerStep );
	f( c.settle_time, m.settleTime );
}

template <class F, class C, class Cpp>
void attachmentFields( F& f, C& c, Cpp& m )
{
	f( c.compliance, m.compliance );
	f( c.breaking_force, m.breakingForce );
}

template <class F, class C, class Cpp>
void latticeFields( F& f, C& c, Cpp& m )
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

template <class C, class Cpp, class Fields>
C made( const Cpp& cpp, Fields&& fields )
{
	C c{};
	ToC to;
	fields( to, c, cpp );
	return c;
}

/// `full`: the defaults, which the fields of the caller's version overwrite.
template <class C, class Cpp, class Fields>
pliant_result taken( const C* given, C& full, Cpp& out, pliant_result refusal, Fields&& fields )
{
	if ( const pliant_result code = readSized( given, full ); code != PLIANT_OK )
	{
		return code;
	}
	Cpp read = out;
	FromC from{ PLIANT_OK, refusal };
	fields( from, full, read );
	if ( from.code == PLIANT_OK )
	{
		out = read;
	}
	return from.code;
}

pliant_debris_budget inC( const DebrisBudget& budget )
{
	return made<pliant_debris_budget>( budget, []( auto& f, auto& c, auto& m ) { debrisFields( f, c, m ); } );
}

pliant_attachment_settings inC( const AttachmentSettings& settings )
{
	return made<pliant_attachment_settings>( settings, []( auto& f, auto& c, auto& m ) { attachmentFields( f, c, m ); } );
}

pliant_lattice_settings inC( const LatticeSettings& settings )
{
	pliant_lattice_settings c = made<pliant_lattice_settings>( settings, []( auto& f, auto& to, auto& m ) { latticeFields( f, to, m ); } );
	c.threads = 1;
	return c;
}

} // namespace

pliant_material inC( const Material& material )
{
	return made<pliant_material>( material, []( auto& f, auto& c, auto& m ) { materialFields( f, c, m ); } );
}

pliant_fracture inC( const Fracture& fracture )
{
	return made<pliant_fracture>( fracture, []( auto& f, auto& c, auto& m ) { fractureFields( f, c, m ); } );
}

pliant_adaptivity inC( const Adaptivity& adaptivity )
{
	return made<pliant_adaptivity>( adaptivity, []( auto& f, auto& c, auto& m ) { adaptivityFields( f, c, m ); } );
}

pliant_result take( const pliant_material* given, Material& out )
{
	pliant_material full = inC( Material{} );
	return taken( given, full, out, PLIANT_BAD_MATERIAL, []( auto& f, auto& c, auto& m ) { materialFields( f, c, m ); } );
}

pliant_result take( const pliant_fracture* given, Fracture& out )
{
	pliant_fracture full = inC( Fracture{} );
	return taken( given, full, out, PLIANT_BAD_SETTINGS, []( auto& f, auto& c, auto& m ) { fractureFields( f, c, m ); } );
}

pliant_result take( const pliant_adaptivity* given, Adaptivity& out )
{
	pliant_adaptivity full = inC( Adaptivity{} );
	return taken( given, full, out, PLIANT_BAD_SETTINGS, []( auto& f, auto& c, auto& m ) { adaptivityFields( f, c, m ); } );
}

pliant_result take( const pliant_debris_budget* given, DebrisBudget& out )
{
	pliant_debris_budget full = inC( DebrisBudget{} );
	return taken( given, full, out, PLIANT_BAD_SETTINGS, []( auto& f, auto& c, auto& m ) { debrisFields( f, c, m ); } );
}

pliant_result take( const pliant_attachment_settings* given, AttachmentSettings& out )
{
	pliant_attachment_settings full = inC( AttachmentSettings{} );
	return taken( given, full, out, PLIANT_BAD_SETTINGS, []( auto& f, auto& c, auto& m ) { attachmentFields( f, c, m ); } );
}

pliant_result take( const pliant_lattice_settings* given, LatticeSettings& out, pliant_lattice_settings& full )
{
	full = inC( LatticeSettings{} );
	return taken( given, full, out, PLIANT_BAD_SETTINGS, []( auto& f, auto& c, auto& m ) { latticeFields( f, c, m ); } );
}

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_material_init( pliant_material* material, uint32_t size )
{
	return writeSized( inC( Material{} ), material, size );
}

pliant_result pliant_fracture_init( pliant_fracture* fracture, uint32_t size )
{
	return writeSized( inC( Fracture{} ), fracture, size );
}

pliant_result pliant_adaptivity_init( pliant_adaptivity* adaptivity, uint32_t size )
{
	return writeSized( inC( Adaptivity{} ), adaptivity, size );
}

pliant_result pliant_debris_budget_init( pliant_debris_budget* budget, uint32_t size )
{
	return writeSized( inC( DebrisBudget{} ), budget, size );
}

pliant_result pliant_attachment_settings_init( pliant_attachment_settings* settings, uint32_t size )
{
	return writeSized( inC( AttachmentSettings{} ), settings, size );
}

pliant_result pliant_lattice_settings_init( pliant_lattice_settings* settings, uint32_t size )
{
	return writeSized( inC( LatticeSettings{} ), settings, size );
}
