// +-----------------------------------------------------------------------------------------------------------------+
// | A stage in a picture: skinned by the library, or as tables for the GPU.                                          |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/stage.h"

#include <pliant/render/gpu_surface.h>

#include <algorithm>
#include <chrono>

namespace pliant_demos {

namespace {

using Clock = std::chrono::steady_clock;

pliant_glue::Vec3 toVec3( const btVector3& v )
{
	return { float( v.x() ), float( v.y() ), float( v.z() ) };
}

void borrowSkin( const pliant::SoftBody& body, pliant_glue::DrawMesh& mesh )
{
	const pliant::SurfaceView skin = body.surface();
	mesh.positions = skin.positions;
	mesh.normals = skin.normals;
	mesh.origin = toVec3( skin.origin );
}

template <class T>
pliant_glue::DrawTable tableOf( const pliant::SkinArray<T>& array )
{
	pliant_glue::DrawTable table{ array.data, std::size_t( array.count ), sizeof( T ), array.version, array.changedSince, {} };
	for ( int k = 0; k < array.changedCount; ++k )
	{
		table.changed.push_back( { array.changed[k].first, array.changed[k].count } );
	}
	return table;
}

void borrowTables( const pliant::SoftBody& body, pliant_glue::DrawMesh& mesh )
{
	const pliant::GpuSurfaceView skin = body.gpuSurface();
	auto made = std::make_shared<pliant_glue::DrawSkin>();
	made->vertices = tableOf( skin.vertices );
	made->influences = tableOf( skin.influences );
	made->mixes = tableOf( skin.mixes );
	made->corners = tableOf( skin.corners );
	made->nodeOfCell = tableOf( skin.nodeOfCell );
	made->offsets = tableOf( skin.offsets );
	made->nodeTransforms = skin.nodeTransforms;
	made->nodeCount = skin.nodeCount;
	std::copy_n( skin.offsetTurn, 9, made->offsetTurn.begin() );
	mesh.skin = std::move( made );
	mesh.origin = toVec3( skin.origin );
}

} // namespace

Stage::ShownMesh Stage::shownMesh( const pliant::SoftBody& body ) const
{
	if ( m_options.gpuSkin )
	{
		const pliant::GpuSurfaceView skin = body.gpuSurface();
		return { skin.topologyVersion, skin.vertices.count, skin.indices.count / 3, skin.indices.data, skin.triangleSource };
	}
	const pliant::SurfaceView skin = body.surface();
	return { skin.topologyVersion, skin.vertexCount, skin.triangleCount, skin.indices, skin.triangleSource };
}

void Stage::skin()
{
	if ( m_isSkinned )
	{
		return;
	}
	m_isSkinned = true;
	const Clock::time_point begin = Clock::now();
	for ( const SoftItem& item : m_soft )
	{
		m_options.gpuSkin ? void( item.body->gpuSurface() ) : void( item.body->surface() );
	}
	m_log.addSkinning( secondsSince( begin ) );
	for ( SoftItem& item : m_soft )
	{
		colourCracks( item );
	}
}

/// Vertices of crack faces belong to these faces alone, since normals have a crease at the border.
void Stage::colourCracks( SoftItem& item ) const
{
	const ShownMesh skin = shownMesh( *item.body );
	if ( item.insideColour[0] < 0 || skin.triangleSource == nullptr || skin.topologyVersion == item.colouredVersion )
	{
		return;
	}
	item.colouredVersion = skin.topologyVersion;
	item.vertexColours.resize( std::size_t( skin.vertexCount ) * 3 );
	for ( std::size_t i = 0; i < item.vertexColours.size(); ++i )
	{
		item.vertexColours[i] = item.colour[i % 3];
	}
	for ( int t = 0; t < skin.triangleCount; ++t )
	{
		for ( int k = 0; skin.triangleSource[t] == pliant::SurfaceView::kInside && k < 3; ++k )
		{
			std::copy( item.insideColour.begin(), item.insideColour.end(),
				item.vertexColours.begin() + std::ptrdiff_t( skin.indices[3 * t + k] ) * 3 );
		}
	}
}

void Stage::drawNodes( const SoftItem& item, pliant_glue::DrawList& list ) const
{
	for ( int i = 0; i < item.body->nodeCount(); ++i )
	{
		const float d = 2 * float( item.body->nodeRadius( i ) );
		list.spheres.push_back( { { d, 0, 0 }, { 0, d, 0 }, { 0, 0, d }, toVec3( item.body->nodePosition( i ) ), item.colour } );
	}
}

void Stage::draw( pliant_glue::DrawList& list, bool showNodes, std::uint64_t firstId ) const
{
	if ( !m_isDrawn )
	{
		return;
	}
	for ( const RigidItem& item : m_rigid )
	{
		if ( item.isDrawn )
		{
			const btTransform& at = item.body->getWorldTransform();
			pliant_glue::DrawInstance drawn;
			drawn.axisX = toVec3( at.getBasis().getColumn( 0 ) * item.size.x() );
			drawn.axisY = toVec3( at.getBasis().getColumn( 1 ) * item.size.y() );
			drawn.axisZ = toVec3( at.getBasis().getColumn( 2 ) * item.size.z() );
			drawn.position = toVec3( at.getOrigin() );
			drawn.colour = item.colour;
			( item.isSphere ? list.spheres : list.boxes ).push_back( drawn );
		}
	}
	for ( const SoftItem& item : m_soft )
	{
		const ShownMesh skin = shownMesh( *item.body );
		if ( showNodes || skin.triangleCount == 0 )
		{
			drawNodes( item, list );
			continue;
		}
		pliant_glue::DrawMesh mesh;
		mesh.id = firstId + item.id;
		mesh.topologyVersion = skin.topologyVersion;
		mesh.indices = skin.indices;
		mesh.vertexCount = skin.vertexCount;
		mesh.triangleCount = skin.triangleCount;
		mesh.cellSize = item.body->bodyTemplate().cellSize();
		mesh.colour = item.colour;
		mesh.vertexColours = item.vertexColours.size() == std::size_t( skin.vertexCount ) * 3 ? item.vertexColours.data() : nullptr;
		m_options.gpuSkin ? borrowTables( *item.body, mesh ) : borrowSkin( *item.body, mesh );
		list.meshes.push_back( mesh );
	}
}

} // namespace pliant_demos
