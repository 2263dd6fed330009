// +-----------------------------------------------------------------------------------------------------------------+
// | Frames as model files: every body a mesh of its own, in world coordinates.                                        |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/frame_sink.h"

#include "third_party_glue/assimp_mesh.h"
#include "third_party_glue/primitives.h"

#include <cmath>
#include <cstdio>

namespace pliant_demos {

using pliant_glue::DrawInstance;
using pliant_glue::ModelMesh;
using pliant_glue::Primitive;
using pliant_glue::Vec3;

namespace {

constexpr int kSphereSubdivisions = 2;

ModelMesh fromMesh( const pliant_glue::DrawMesh& from, const std::string& name )
{
	ModelMesh mesh;
	mesh.name = name;
	mesh.positions.assign( from.positions, from.positions + std::size_t( from.vertexCount ) * 3 );
	mesh.normals.assign( from.normals, from.normals + std::size_t( from.vertexCount ) * 3 );
	mesh.indices.assign( from.indices, from.indices + std::size_t( from.triangleCount ) * 3 );
	if ( from.vertexColours != nullptr )
	{
		mesh.vertexColours.assign( from.vertexColours, from.vertexColours + std::size_t( from.vertexCount ) * 3 );
	}
	for ( std::size_t i = 0; i < mesh.positions.size(); ++i )
	{
		mesh.positions[i] += from.origin[i % 3];
	}
	std::copy( from.colour.begin(), from.colour.end(), mesh.colour );
	return mesh;
}

ModelMesh fromInstance( const DrawInstance& from, const Primitive& shape, const std::string& name )
{
	ModelMesh mesh;
	mesh.name = name;
	mesh.indices = shape.indices;
	for ( std::size_t i = 0; i < shape.positions.size(); i += 3 )
	{
		const float* p = &shape.positions[i];
		for ( std::size_t k = 0; k < 3; ++k )
		{
			mesh.positions.push_back( from.axisX[k] * p[0] + from.axisY[k] * p[1] + from.axisZ[k] * p[2] + from.position[k] );
		}
		// The axes are at right angles: a normal is rotated with them, each component divided by the length of its axis.
		const float* n = &shape.normals[i];
		Vec3 turned;
		float square = 0;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			const auto unit = []( const Vec3& a ) { return std::sqrt( a[0] * a[0] + a[1] * a[1] + a[2] * a[2] ); };
			turned[k] = from.axisX[k] * n[0] / unit( from.axisX ) + from.axisY[k] * n[1] / unit( from.axisY ) +
				from.axisZ[k] * n[2] / unit( from.axisZ );
			square += turned[k] * turned[k];
		}
		for ( const float coordinate : turned )
		{
			mesh.normals.push_back( coordinate / std::sqrt( square ) );
		}
	}
	std::copy( from.colour.begin(), from.colour.end(), mesh.colour );
	return mesh;
}

class ModelSink : public FrameSink
{
public:
	explicit ModelSink( const RunSettings& settings ) :
		m_folder( settings.folder ), m_ending( settings.exportFormat ), m_every( settings.exportEvery ), m_cube( pliant_glue::unitCube() ),
		m_sphere( pliant_glue::unitSphere( kSphereSubdivisions ) )
	{}

	bool write( int frame, const pliant_glue::DrawList& list, std::string& why ) override
	{
		if ( frame % m_every != 0 )
		{
			return true;
		}
		std::vector<ModelMesh> meshes;
		for ( std::size_t i = 0; i < list.meshes.size(); ++i )
		{
			meshes.push_back( fromMesh( list.meshes[i], "soft-" + std::to_string( i ) ) );
		}
		for ( std::size_t i = 0; i < list.boxes.size(); ++i )
		{
			meshes.push_back( fromInstance( list.boxes[i], m_cube, "box-" + std::to_string( i ) ) );
		}
		for ( std::size_t i = 0; i < list.spheres.size(); ++i )
		{
			meshes.push_back( fromInstance( list.spheres[i], m_sphere, "ball-" + std::to_string( i ) ) );
		}
		char name[32];
		std::snprintf( name, sizeof( name ), "/frame_%04d.", frame );
		const pliant_glue::FileStatus status = pliant_glue::writeModel( m_folder + name + m_ending, meshes );
		why = status.sentence;
		m_written += status.ok() ? 1 : 0;
		return status.ok();
	}

	std::string finish() override { return std::to_string( m_written ) + " model files frame_*." + m_ending; }

private:
	std::string m_folder, m_ending;
	int m_every;
	int m_written = 0;
	Primitive m_cube, m_sphere;
};

} // namespace

std::unique_ptr<FrameSink> makeModelSink( const RunSettings& settings )
{
	return std::make_unique<ModelSink>( settings );
}

} // namespace pliant_demos
