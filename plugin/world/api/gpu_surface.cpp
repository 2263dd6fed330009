// The skin for renderers that skin on the GPU, and the maps of nodes as they are drawn. Steinemann et al. 2008, section 7.

#include "pliant/render/gpu_surface.h"

#include "body/levels/levels.h"
#include "surface/skin/skinning.h"
#include "world/api/drawn_mesh.h"
#include "world/step/soft_body_system.h"
#include "world/stopwatch.h"

#include <algorithm>

namespace pliant {

double SoftBody::Impl::drawnFraction() const
{
	return system && skin.blend && skin.blend->kept.isKept() ? system->drawnFraction : 1.0;
}

const AlignedArray<float>& SoftBody::Impl::drawnMaps( TaskRunner* runner ) const
{
	if ( !skin.isMapKnown )
	{
		allSkinMaps( body->nodes(), skinPose(), skin.maps, runner );
		skin.isMapKnown = true;
		++skin.mapVersion;
	}
	const double fraction = drawnFraction();
	if ( fraction == 1.0 )
	{
		return skin.maps;
	}
	StepBlend& blend = *skin.blend;
	if ( blend.fraction != fraction || blend.mapVersion != skin.mapVersion )
	{
		blend.kept.between( body->nodes(), skin.maps, fraction, double( bodyTemplate->cellSize() ), blend.maps );
		blend.fraction = fraction;
		blend.mapVersion = skin.mapVersion;
	}
	return blend.maps;
}

void SoftBody::Impl::keepDrawn( bool moves )
{
	StepBlend& blend = *skin.blend;
	if ( !moves || bodyTemplate->skin().kind == Skinning::None )
	{
		blend.kept.forget(); // surface() recognises by drawnFraction() that another time is shown
		return;
	}
	if ( !skin.isMapKnown )
	{
		allSkinMaps( body->nodes(), skinPose(), skin.maps );
	}
	blend.kept.keep( skin.maps, body->nodes().origin );
	blend.fraction = -1.0;
	skin.isMapKnown = false;
}

namespace {

/// Updates the tables after cracks and changes of levels.
void updateTables( const SoftBody::Impl& impl, const DrawnMesh& mesh, GpuSkin& gpu )
{
	const bool isNew = !gpu.isShown || gpu.fractureVersion != shownVersion( impl );
	if ( isNew && mesh.whole )
	{
		gpu.tables.showWhole( mesh.whole, mesh.triangles );
	}
	else if ( isNew )
	{
		gpu.tables.showCracks( mesh.binding, mesh.triangles );
	}
	const Levels* const levels = impl.body->levels();
	if ( levels && ( isNew || gpu.levelVersion != levels->version() ) )
	{
		gpu.tables.showLevels( levels->cut().slotOfCell.data(), std::size_t( impl.body->lattice().cellCount() ) );
		gpu.levelVersion = levels->version();
	}
	const SkinFade& fade = impl.skin.fade;
	if ( mesh.hasOffsets && ( gpu.offsetVersion != fade.offsetVersion() || ( isNew && fade.hasOffsets() ) ) )
	{
		std::vector<SkinOffset> offsets;
		fade.hasOffsets() ? fade.spread( mesh.binding, offsets ) : void();
		gpu.tables.showOffsets( std::move( offsets ) );
		gpu.offsetVersion = fade.offsetVersion();
	}
	gpu.fractureVersion = shownVersion( impl );
	gpu.isShown = true;
}

} // namespace

GpuSurfaceView gpuView( const SoftBody::Impl& impl, const DrawnMesh& mesh, GpuSkin& gpu )
{
	const AlignedArray<float>& maps = impl.drawnMaps( impl.system ? impl.system->tasks() : nullptr );
	updateTables( impl, mesh, gpu );
	if ( gpu.mapVersion != impl.skin.mapVersion || gpu.fraction != impl.drawnFraction() )
	{
		gpu.mapVersion = impl.skin.mapVersion;
		gpu.fraction = impl.drawnFraction();
		++gpu.frame;
	}
	GpuSurfaceView view;
	view.origin = impl.worldOrigin();
	view.nodeTransforms = maps.data();
	view.nodeCount = impl.body->nodeCount();
	view.frame = gpu.frame;
	if ( mesh.hasOffsets && impl.skin.fade.hasOffsets() )
	{
		Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>( view.offsetTurn ) = impl.skin.fade.offsetTurn( impl.body->levelFrame() );
	}
	view.vertices = gpu.tables.vertices();
	view.influences = gpu.tables.influences();
	view.mixes = gpu.tables.mixes();
	view.corners = gpu.tables.corners();
	view.indices = gpu.tables.indices();
	view.nodeOfCell = gpu.tables.nodeOfCell();
	view.offsets = gpu.tables.offsets();
	view.textureCoordinates = mesh.texture;
	view.triangleSource = mesh.sources;
	view.topologyVersion = shownVersion( impl );
	return view;
}

GpuSurfaceView SoftBody::gpuSurface() const
{
	const Impl& impl = *m_impl;
	const SkinBinding& binding = impl.currentBinding();
	if ( binding.kind == Skinning::None || impl.isInField() )
	{
		return {};
	}
	double discarded = 0.0; // time of a body that is in no world
	Stopwatch watch( impl.system ? impl.system->report.skinning : discarded );
	impl.skin.gpu = impl.skin.gpu ? std::move( impl.skin.gpu ) : std::make_unique<GpuSkin>();
	DrawnMesh mesh{ binding, impl.shownTriangles(), nullptr };
	if ( const CrackView* const cracks = impl.shownCracks() )
	{
		mesh.texture = cracks->texture.data();
		mesh.sources = cracks->sources.data();
	}
	else
	{
		mesh.whole = impl.bodyTemplate->skinTables();
		mesh.texture = impl.bodyTemplate->textureCoordinates();
	}
	return gpuView( impl, mesh, *impl.skin.gpu );
}

} // namespace pliant
