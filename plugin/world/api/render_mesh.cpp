// Further render meshes of a body. Broken ones are drawn from the body's own links, as bodies that were not drawn before they broke.

#include "pliant/render/render_mesh.h"

#include "body/levels/levels.h"
#include "lattice/attempt.h"
#include "lattice/features.h"
#include "lattice/mesh/weld.h"
#include "surface/crack_complex/cell_complex.h"
#include "surface/render/vertex_data.h"
#include "world/api/drawn_mesh.h"
#include "world/step/soft_body_system.h"

#include <mutex>

namespace pliant {

struct RenderMesh::Data
{
	std::shared_ptr<const BodyTemplate> bodyTemplate;
	std::vector<float> positions, textureCoordinates;
	std::vector<std::uint32_t> indices;
	SkinBinding binding;

	// Made on request.
	mutable std::mutex mutex;
	mutable std::shared_ptr<const SkinTables> tables;
	mutable bool hasTriedCracks = false;
	mutable std::shared_ptr<const CrackPatches> patches;

	MeshView view() const
	{
		MeshView mesh{ positions.data(), positions.size() / 3, 3, indices.data(), indices.size() / 3 };
		mesh.textureCoordinates = texture();
		return mesh;
	}
	const float* texture() const { return textureCoordinates.empty() ? nullptr : textureCoordinates.data(); }
	SkinTriangles triangles() const { return { indices.data(), int( indices.size() / 3 ) }; }
	std::shared_ptr<const SkinTables> skinTables() const
	{
		const std::lock_guard<std::mutex> lock( mutex );
		tables = tables ? tables : std::make_shared<const SkinTables>( makeSkinTables( binding, triangles() ) );
		return tables;
	}
	/// Null: cracks of this mesh cannot be computed.
	std::shared_ptr<const CrackPatches> crackPatches() const
	{
		const std::lock_guard<std::mutex> lock( mutex );
		if ( !hasTriedCracks && hasFeature( Feature::Fracture ) )
		{
			const LatticeSettings& settings = bodyTemplate->settings();
			const auto complex = CellComplex::build( view(), bodyTemplate->lattice(), binding, settings, settings.cracks ).value;
			patches = complex ? CrackPatches::make( complex, texture() ) : nullptr;
		}
		hasTriedCracks = true;
		return patches;
	}
};

RenderMesh::RenderMesh() : m_data( std::make_unique<Data>() ) {}

RenderMesh::~RenderMesh() = default;

Result<std::shared_ptr<const RenderMesh>> RenderMesh::bind( std::shared_ptr<const BodyTemplate> bodyTemplate, const MeshView& mesh )
{
	using Answer = Result<std::shared_ptr<const RenderMesh>>;
	return withinMemory( kNoMemoryToBuild, [&]() -> Answer {
		insist( requireFeature( Feature::Surface ) );
		rejectIf( !bodyTemplate, "RenderMesh::bind", "the template must not be null." );
		WeldedMesh welded;
		BuildReport report;
		insist( weldMesh( mesh, bodyTemplate->settings(), welded, report ) );
		const std::shared_ptr<RenderMesh> made( new RenderMesh );
		Data& data = *made->m_data;
		for ( std::size_t i = 0; i < mesh.vertexCount; ++i )
		{
			const float* const p = mesh.positions + i * mesh.positionStride;
			data.positions.insert( data.positions.end(), p, p + 3 );
		}
		data.indices.assign( mesh.indices, mesh.indices + 3 * mesh.triangleCount );
		if ( mesh.textureCoordinates )
		{
			data.textureCoordinates.assign( mesh.textureCoordinates, mesh.textureCoordinates + 2 * mesh.vertexCount );
		}
		const Skinning kind = bodyTemplate->settings().skinning;
		data.binding = bindSkin(
			data.view(), bodyTemplate->lattice(), welded.weldedVertex, kind == Skinning::None ? Skinning::NearbyNodes : kind );
		data.bodyTemplate = std::move( bodyTemplate );
		return Answer::success( made );
	} );
}

int RenderMesh::vertexCount() const
{
	return int( m_data->positions.size() / 3 );
}

int RenderMesh::triangleCount() const
{
	return int( m_data->indices.size() / 3 );
}

const BodyTemplate& RenderMesh::bodyTemplate() const
{
	return *m_data->bodyTemplate;
}

// === A mesh on a body ===

struct RenderSkin::Impl
{
	std::shared_ptr<const RenderMesh> mesh;
	CrackView cracks;
	bool isShown = false, isCracked = false, areSourcesKnown = false;
	unsigned fractureVersion = 0;    ///< of the body, as it is drawn
	const SoftBody* shown = nullptr; ///< compared only: it may have been deleted
	int cellCount = 0;               ///< of that body
	std::vector<float> positions[2], normals[2];
	btVector3 origin = btVector3( 0, 0, 0 );
	int current = 0;
	unsigned frame = 0, mapVersion = 0; ///< SkinBuffers::mapVersion of the frame
	double fraction = 1.0;
	SkinScratch scratch;
	GpuSkin gpu;
	std::vector<VertexSource> sources;

	const SkinBinding& binding() const { return isCracked ? cracks.binding : mesh->data().binding; }
	SkinTriangles triangles() const { return isCracked ? cracks.shown() : mesh->data().triangles(); }

	/// Updates the cracks. False if nothing can be drawn.
	bool follow( const SoftBody& body )
	{
		const SoftBody::Impl& impl = body.impl();
		if ( impl.bodyTemplate != mesh->data().bodyTemplate )
		{
			return false;
		}
		const bool isSame = shown == &body && cellCount == body.cellCount();
		if ( isShown && isSame && fractureVersion == shownVersion( impl ) )
		{
			return true;
		}
		gpu.isShown = gpu.isShown && isSame;
		gpu.mapVersion = isSame ? gpu.mapVersion : 0;
		isCracked = !impl.body->firstCells().empty();
		const std::shared_ptr<const CrackPatches> patches = isCracked ? mesh->data().crackPatches() : nullptr;
		if ( isCracked && !patches )
		{
			return false;
		}
		if ( isCracked )
		{
			showOwnCracks( impl, patches, cracks );
		}
		isShown = true;
		shown = &body;
		cellCount = body.cellCount();
		fractureVersion = shownVersion( impl );
		areSourcesKnown = false;
		mapVersion = 0;
		return true;
	}
};

RenderSkin::RenderSkin() : m_impl( std::make_unique<Impl>() ) {}

RenderSkin::~RenderSkin() = default;

Result<std::unique_ptr<RenderSkin>> RenderSkin::create( std::shared_ptr<const RenderMesh> mesh )
{
	using Answer = Result<std::unique_ptr<RenderSkin>>;
	return withinMemory( kNoMemoryToBuild, [&]() -> Answer {
		rejectIf( !mesh, "RenderSkin::create", "the mesh must not be null." );
		std::unique_ptr<RenderSkin> made( new RenderSkin );
		made->m_impl->mesh = std::move( mesh );
		return Answer::success( std::move( made ) );
	} );
}

SurfaceView RenderSkin::surface( const SoftBody& body )
{
	Impl& own = *m_impl;
	if ( !own.follow( body ) )
	{
		return {};
	}
	const SoftBody::Impl& impl = body.impl();
	TaskRunner* const runner = impl.system ? impl.system->tasks() : nullptr;
	const SkinBinding& binding = own.binding();
	const AlignedArray<float>& maps = impl.drawnMaps( runner );
	if ( own.mapVersion != impl.skin.mapVersion || own.fraction != impl.drawnFraction() )
	{
		own.current = 1 - own.current;
		std::vector<float>&positions = own.positions[own.current], &normals = own.normals[own.current];
		positions.resize( 3 * binding.restPosition.size() );
		normals.resize( positions.size() );
		SkinPose pose;
		pose.maps = maps.data();
		pose.slotOfCell = impl.body->levels() ? impl.body->levels()->cut().slotOfCell.data() : nullptr;
		skin( binding, impl.body->nodes(), pose, own.triangles(), own.scratch, positions.data(), normals.data(), runner );
		own.origin = impl.worldOrigin();
		own.mapVersion = impl.skin.mapVersion;
		own.fraction = impl.drawnFraction();
		++own.frame;
	}
	SurfaceView view;
	view.origin = own.origin;
	view.positions = own.positions[own.current].data();
	view.normals = own.normals[own.current].data();
	view.indices = own.triangles().indices;
	view.textureCoordinates = own.isCracked ? own.cracks.texture.data() : own.mesh->data().texture();
	view.triangleSource = own.isCracked ? own.cracks.sources.data() : nullptr;
	view.vertexCount = int( binding.restPosition.size() );
	view.triangleCount = own.triangles().count;
	view.topologyVersion = own.fractureVersion;
	view.frame = own.frame;
	return view;
}

GpuSurfaceView RenderSkin::gpuSurface( const SoftBody& body )
{
	Impl& own = *m_impl;
	if ( !own.follow( body ) )
	{
		return {};
	}
	DrawnMesh mesh{ own.binding(), own.triangles(), own.isCracked ? nullptr : own.mesh->data().skinTables() };
	mesh.hasOffsets = false;
	mesh.texture = own.isCracked ? own.cracks.texture.data() : own.mesh->data().texture();
	mesh.sources = own.isCracked ? own.cracks.sources.data() : nullptr;
	return gpuView( body.impl(), mesh, own.gpu );
}

VertexSourceView RenderSkin::vertexSources( const SoftBody& body )
{
	Impl& own = *m_impl;
	if ( !own.follow( body ) )
	{
		return {};
	}
	if ( !own.areSourcesKnown )
	{
		own.sources = own.isCracked ? sourcesOf( own.cracks, *own.mesh->data().crackPatches()->complex ) : std::vector<VertexSource>();
		own.areSourcesKnown = true;
	}
	return { own.sources.empty() ? nullptr : own.sources.data(), int( own.binding().restPosition.size() ), own.fractureVersion };
}

} // namespace pliant
