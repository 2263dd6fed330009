// Sources of vertices, and tangents.

#include "pliant/render/vertex_attributes.h"

#include "surface/render/vertex_data.h"
#include "world/api/drawn_mesh.h"
#include "world/bodies/soft_body_impl.h"
#include "world/step/soft_body_system.h"

namespace pliant {

namespace {

/// The sources of a body's drawn vertices, up to date with its cracks. Null: it has no skin.
VertexData* knownSources( const SoftBody::Impl& impl )
{
	if ( impl.currentBinding().kind == Skinning::None )
	{
		return nullptr;
	}
	std::unique_ptr<VertexData>& known = impl.skin.vertexData;
	known = known ? std::move( known ) : std::make_unique<VertexData>();
	VertexData& data = *known;
	if ( !data.areSourcesKnown || data.sourceVersion != shownVersion( impl ) )
	{
		const CrackView* const cracks = impl.shownCracks();
		data.sources = cracks ? sourcesOf( *cracks, *impl.bodyTemplate->crackComplex() ) : std::vector<VertexSource>();
		data.sourceVersion = shownVersion( impl );
		data.areSourcesKnown = true;
	}
	return &data;
}

/// The same with rest tangents. Null: there are none.
VertexData* knownTangents( const SoftBody::Impl& impl )
{
	const std::shared_ptr<const std::vector<float>> input = impl.bodyTemplate->restTangents();
	VertexData* const data = input ? knownSources( impl ) : nullptr;
	if ( data && ( !data->areRestTangentsKnown || data->restVersion != shownVersion( impl ) ) )
	{
		const CrackView* const cracks = impl.shownCracks();
		data->restTangents = cracks ? crackTangents( *cracks, data->sources, input->data() ) : *input;
		data->restVersion = shownVersion( impl );
		data->areRestTangentsKnown = true;
		data->areTangentsKnown = false;
	}
	return data;
}

} // namespace

VertexSourceView vertexSources( const SoftBody& body )
{
	const SoftBody::Impl& impl = body.impl();
	const VertexData* const data = knownSources( impl );
	if ( !data )
	{
		return {};
	}
	return { data->sources.empty() ? nullptr : data->sources.data(), int( impl.binding().restPosition.size() ), shownVersion( impl ) };
}

TangentView restTangents( const SoftBody& body )
{
	const SoftBody::Impl& impl = body.impl();
	const VertexData* const data = knownTangents( impl );
	return data ? TangentView{ data->restTangents.data(), int( data->restTangents.size() / 4 ), shownVersion( impl ), 0 } : TangentView{};
}

TangentView tangents( const SoftBody& body )
{
	const SoftBody::Impl& impl = body.impl();
	VertexData* const data = knownTangents( impl );
	if ( !data )
	{
		return {};
	}
	const SurfaceView surface = body.surface();
	if ( !data->areTangentsKnown || data->tangentFrame != surface.frame )
	{
		TaskRunner* const runner = impl.system ? impl.system->tasks() : nullptr;
		SkinPose pose = impl.skinPose();
		pose.maps = impl.drawnMaps( runner ).data();
		turnTangents( impl.binding(), pose, data->restTangents, surface.normals, data->tangents, runner );
		data->tangentFrame = surface.frame;
		data->areTangentsKnown = true;
	}
	return { data->tangents.data(), surface.vertexCount, surface.topologyVersion, surface.frame };
}

} // namespace pliant
