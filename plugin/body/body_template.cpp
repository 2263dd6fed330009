// Builds the data that bodies share from a mesh: cells, links and skin. Ohta et al. 2009, "Preprocessing".

#include "pliant/body_template.h"

#include "archive/settings_archive.h"
#include "body/constants.h"
#include "lattice/attempt.h"
#include "lattice/build/build_lattice.h"
#include "lattice/features.h"
#include "matching/regions/level_tables.h"
#include "surface/crack_complex/cell_complex.h"
#include "surface/crack_state/crack_patches.h"
#include "surface/render/skin_tables.h"
#include "surface/render/vertex_data.h"
#include "surface/skin/skinning.h"

#include <algorithm>
#include <chrono>
#include <mutex>

namespace pliant {

struct BodyTemplate::Data
{
	std::shared_ptr<const Lattice> lattice; // bodies hold it too
	std::shared_ptr<TemplateCache> cache = std::make_shared<TemplateCache>();
	SkinBinding skin;
	BuildReport report;
	int vertexCount = 0;
	int triangleCount = 0;
	std::vector<std::uint32_t> indices;
	std::vector<float> textureCoordinates;
	std::vector<std::uint32_t> submeshOfTriangle;

	std::mutex tableMutex;
	std::shared_ptr<const std::vector<float>> tangents;
	std::shared_ptr<const SkinTables> skinTables; ///< null: not requested yet

	// For cracks, which most templates never use.
	std::vector<float> positions; ///< of the mesh's vertices, m
	LatticeSettings settings;
	std::mutex crackMutex;
	bool hasTriedCracks = false;
	std::shared_ptr<const CellComplex> crackComplex;
	std::shared_ptr<const CrackPatches> crackPatches;

	std::once_flag isHashed;
	std::uint64_t fingerprint = 0;

	void archive( Archive& archive, bool withReport );
	bool isValid() const;
};

namespace {

/// Copies the positions without gaps, for any input stride.
std::vector<float> packedPositions( const MeshView& mesh )
{
	std::vector<float> packed;
	packed.reserve( 3 * mesh.vertexCount );
	for ( std::size_t i = 0; i < mesh.vertexCount; ++i )
	{
		const float* p = mesh.positions + i * mesh.positionStride;
		packed.insert( packed.end(), p, p + 3 );
	}
	return packed;
}

template <class T>
std::vector<T> copyOf( const T* first, std::size_t count )
{
	return first ? std::vector<T>( first, first + count ) : std::vector<T>();
}

Lattice scaledLattice( const Lattice& lattice, float factor )
{
	Lattice to = lattice;
	to.cellSize *= factor;
	to.overhang *= factor;
	to.corner *= double( factor );
	to.massCentre *= double( factor );
	for ( Vec3& centre : to.restCentre )
	{
		centre *= factor;
	}
	for ( std::vector<ContactPatch>* const patches : { &to.patch, &to.edgeFace } )
	{
		for ( ContactPatch& patch : *patches )
		{
			patch.height *= factor;
			patch.radius *= factor;
		}
	}
	return to;
}

template <class T>
const T* dataOrNull( const std::vector<T>& values )
{
	return values.empty() ? nullptr : values.data();
}

} // namespace

BodyTemplate::BodyTemplate() : m_data( std::make_unique<Data>() ) {}

BodyTemplate::~BodyTemplate() = default;

Result<std::shared_ptr<const BodyTemplate>> BodyTemplate::build( const MeshView& mesh, const LatticeSettings& settings )
{
	using Answer = Result<std::shared_ptr<const BodyTemplate>>;
	const auto start = std::chrono::steady_clock::now();
	return withinMemory( kNoMemoryToBuild, [&]() -> Answer {
		insist( check( settings.cracks ) );
		if ( Status status = settings.skinning != Skinning::None ? requireFeature( Feature::Surface ) : Status{}; !status.ok() )
		{
			reject( status.code, status.sentence + " Ask for Skinning::None." );
		}
		LatticeBuild built = insist( buildLattice( mesh, settings ) );
		const std::shared_ptr<BodyTemplate> made( new BodyTemplate );
		Data& data = *made->m_data;
		data.lattice = std::make_shared<const Lattice>( std::move( built.lattice ) );
		if ( settings.skinning != Skinning::None )
		{
			data.positions = packedPositions( mesh );
			MeshView packedMesh = mesh;
			packedMesh.positions = data.positions.data();
			packedMesh.positionStride = 3;
			data.skin = bindSkin( packedMesh, *data.lattice, built.weldedVertex, settings.skinning );
			data.vertexCount = int( mesh.vertexCount );
			data.triangleCount = int( mesh.triangleCount );
			data.indices = copyOf( mesh.indices, 3 * mesh.triangleCount );
			data.textureCoordinates = copyOf( mesh.textureCoordinates, 2 * mesh.vertexCount );
			data.submeshOfTriangle = copyOf( mesh.submeshOfTriangle, mesh.triangleCount );
			data.tangents = mesh.tangents
				? std::make_shared<const std::vector<float>>( mesh.tangents, mesh.tangents + 4 * mesh.vertexCount )
				: nullptr;
		}
		data.settings = settings;
		data.settings.runner = nullptr; // owned by the game, valid only during the build
		data.settings.progress = nullptr;
		data.report = built.report;
		if ( data.report.shellCells == data.report.cells )
		{
			data.settings.shell = Shell::Always; // without an inside, cracks need not search for one
		}
		data.report.seconds = std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count();
		return Answer::success( made );
	} );
}

Result<std::shared_ptr<const BodyTemplate>> BodyTemplate::scaled( float factor ) const
{
	using Answer = Result<std::shared_ptr<const BodyTemplate>>;
	return withinMemory( kNoMemoryToBuild, [&]() -> Answer {
		rejectIf(
			!( factor >= kSmallestScale && factor <= kLargestScale ), "BodyTemplate::scaled", "the factor must be within 1e-6 to 1e6." );
		const std::shared_ptr<BodyTemplate> made( new BodyTemplate );
		Data& data = *made->m_data;
		const Data& from = *m_data;
		data.lattice = std::make_shared<const Lattice>( scaledLattice( *from.lattice, factor ) );
		data.skin = from.skin;
		for ( Vec3& position : data.skin.restPosition )
		{
			position *= factor;
		}
		data.report = from.report;
		data.report.volume *= double( factor ) * double( factor ) * double( factor );
		data.vertexCount = from.vertexCount;
		data.triangleCount = from.triangleCount;
		data.indices = from.indices;
		data.textureCoordinates = from.textureCoordinates;
		data.submeshOfTriangle = from.submeshOfTriangle;
		data.positions = from.positions;
		for ( float& position : data.positions )
		{
			position *= factor;
		}
		data.settings = from.settings;
		data.settings.cellSize *= factor;
		data.settings.shellThickness *= factor;
		return Answer::success( made );
	} );
}

// Caches and the crack complex are derived from the rest.
void BodyTemplate::Data::archive( Archive& archive, bool withReport )
{
	if ( archive.isReading() )
	{
		lattice = std::make_shared<Lattice>();
	}
	archive.write( *lattice ); // the only owner while it is read
	if ( withReport )
	{
		archive( report );
	}
	archive( vertexCount, triangleCount, indices, textureCoordinates, submeshOfTriangle, positions, settings );
	if ( archive.require( vertexCount >= 0 && triangleCount >= 0, "A template's counts are below zero." ) )
	{
		skin.archive( archive, std::size_t( vertexCount ), std::size_t( lattice->cellCount() ) );
	}
	archive.require( archive.isSound() && isValid(), "A template's mesh is not valid." );
}

bool BodyTemplate::Data::isValid() const
{
	const auto vertices = std::size_t( vertexCount ), triangles = std::size_t( triangleCount );
	const auto isFinite = []( float x ) { return std::isfinite( x ); };
	return indices.size() == 3 * triangles && positions.size() == 3 * vertices &&
		( textureCoordinates.empty() || textureCoordinates.size() == 2 * vertices ) &&
		( submeshOfTriangle.empty() || submeshOfTriangle.size() == triangles ) &&
		std::all_of( indices.begin(), indices.end(), [vertices]( std::uint32_t v ) { return v < vertices; } ) &&
		std::all_of( positions.begin(), positions.end(), isFinite ) && check( settings.cracks ).ok() && checkSettings( settings ).ok();
}

void BodyTemplate::archive( Archive& archive )
{
	m_data->archive( archive, true );
}

std::shared_ptr<BodyTemplate> BodyTemplate::blank()
{
	return std::shared_ptr<BodyTemplate>( new BodyTemplate );
}

// Without the report, whose duration differs between builds of the same mesh.
std::uint64_t BodyTemplate::fingerprint() const
{
	Data& data = *m_data;
	std::call_once( data.isHashed, [&data] {
		std::vector<std::byte> bytes;
		Archive archive( bytes );
		data.archive( archive, false );
		archive.finish();
		data.fingerprint = hashOf( bytes.data(), bytes.size() );
	} );
	return data.fingerprint;
}

int BodyTemplate::cellCount() const
{
	return m_data->lattice->cellCount();
}

int BodyTemplate::linkCount() const
{
	return m_data->lattice->linkCount();
}

float BodyTemplate::cellSize() const
{
	return m_data->lattice->cellSize;
}

const double* BodyTemplate::massCentre() const
{
	return m_data->lattice->massCentre.data();
}

const BuildReport& BodyTemplate::report() const
{
	return m_data->report;
}

int BodyTemplate::vertexCount() const
{
	return m_data->vertexCount;
}

int BodyTemplate::triangleCount() const
{
	return m_data->triangleCount;
}

const std::uint32_t* BodyTemplate::indices() const
{
	return dataOrNull( m_data->indices );
}

const float* BodyTemplate::textureCoordinates() const
{
	return dataOrNull( m_data->textureCoordinates );
}

const std::uint32_t* BodyTemplate::submeshOfTriangle() const
{
	return dataOrNull( m_data->submeshOfTriangle );
}

const Lattice& BodyTemplate::lattice() const
{
	return *m_data->lattice;
}

std::shared_ptr<const Lattice> BodyTemplate::sharedLattice() const
{
	return m_data->lattice;
}

std::shared_ptr<TemplateCache> BodyTemplate::cache() const
{
	return m_data->cache;
}

const SkinBinding& BodyTemplate::skin() const
{
	return m_data->skin;
}

std::shared_ptr<const std::vector<float>> BodyTemplate::restTangents() const
{
	Data& data = *m_data;
	const std::lock_guard<std::mutex> lock( data.tableMutex );
	if ( !data.tangents && !data.textureCoordinates.empty() )
	{
		data.tangents = std::make_shared<const std::vector<float>>( tangentsFromTexture(
			data.positions.data(), data.textureCoordinates.data(), { data.indices.data(), data.triangleCount }, data.skin.restNormal ) );
	}
	return data.tangents;
}

const LatticeSettings& BodyTemplate::settings() const
{
	return m_data->settings;
}

std::shared_ptr<const SkinTables> BodyTemplate::skinTables() const
{
	Data& data = *m_data;
	const std::lock_guard<std::mutex> lock( data.tableMutex );
	if ( !data.skinTables )
	{
		data.skinTables = std::make_shared<const SkinTables>( makeSkinTables( data.skin, { data.indices.data(), data.triangleCount } ) );
	}
	return data.skinTables;
}

std::shared_ptr<const CellComplex> BodyTemplate::crackComplex() const
{
	Data& data = *m_data;
	const std::lock_guard<std::mutex> lock( data.crackMutex );
	if ( !data.hasTriedCracks && data.skin.kind != Skinning::None )
	{
		MeshView mesh;
		mesh.positions = data.positions.data();
		mesh.vertexCount = std::size_t( data.vertexCount );
		mesh.indices = data.indices.data();
		mesh.triangleCount = std::size_t( data.triangleCount );
		mesh.textureCoordinates = dataOrNull( data.textureCoordinates );
		data.crackComplex = CellComplex::build( mesh, *data.lattice, data.skin, data.settings, data.settings.cracks ).value;
		data.crackPatches = data.crackComplex ? CrackPatches::make( data.crackComplex, mesh.textureCoordinates ) : nullptr;
		data.hasTriedCracks = true;
	}
	return data.crackComplex;
}

std::shared_ptr<const CrackPatches> BodyTemplate::crackPatches() const
{
	crackComplex();
	return m_data->crackPatches;
}

} // namespace pliant
