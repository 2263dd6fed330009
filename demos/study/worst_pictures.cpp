// +-----------------------------------------------------------------------------------------------------------------+
// | The candidates on the front at their worst moments, next to the reference.                                        |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/page.h"

#if PLIANT_HAS_GL
	#include "demos/palette.h"
	#include "third_party_glue/offscreen.h"
	#include "third_party_glue/renderer.h"

	#include <Eigen/Geometry>

	#include <algorithm>
	#include <cstdio>
	#include <fstream>
	#include <sstream>
#endif

namespace pliant_study {

#if PLIANT_HAS_GL

namespace {

constexpr std::size_t kMostPictures = 4;
constexpr int kWidth = 640, kHeight = 480;
constexpr float kSupersampling = 1.5f;

std::string base64( const std::string& bytes )
{
	static const char* const kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	std::string text;
	for ( std::size_t k = 0; k < bytes.size(); k += 3 )
	{
		unsigned three = 0;
		for ( std::size_t j = 0; j < 3; ++j )
		{
			three = three << 8 | ( k + j < bytes.size() ? static_cast<unsigned char>( bytes[k + j] ) : 0u );
		}
		for ( std::size_t j = 0; j < 4; ++j )
		{
			text += k + j <= bytes.size() ? kDigits[three >> ( 18 - 6 * j ) & 63u] : '=';
		}
	}
	return text;
}

/// Positions and normals in drawable form.
struct DrawnMesh
{
	std::vector<float> positions, normals;

	DrawnMesh( const pliant_glue::ModelMesh& mesh, const Points& points )
	{
		Points normal = Points::Zero( 3, points.cols() );
		for ( std::size_t t = 0; t < mesh.triangleCount(); ++t )
		{
			const std::uint32_t* v = &mesh.indices[3 * t];
			const Eigen::Vector3d a = points.col( v[0] ), b = points.col( v[1] ), c = points.col( v[2] );
			for ( int k = 0; k < 3; ++k )
			{
				normal.col( v[k] ) += ( b - a ).cross( c - a );
			}
		}
		for ( Eigen::Index i = 0; i < points.cols(); ++i )
		{
			const Eigen::Vector3d n = normal.col( i ).normalized();
			for ( int k = 0; k < 3; ++k )
			{
				positions.push_back( float( points( k, i ) ) );
				normals.push_back( float( n[k] ) );
			}
		}
	}
};

class Painter
{
public:
	bool init( std::string& why )
	{
		m_context = pliant_glue::Offscreen::create( why );
		m_renderer = m_context ? pliant_glue::Renderer::create( why ) : nullptr;
		return m_renderer != nullptr;
	}

	/// The candidate on the left, the reference on the right.
	bool paint( const Specimen& specimen, Rig& rig, const Points& candidate, const Points& reference, const std::string& path )
	{
		const float d = float( specimen.diagonal );
		const DrawnMesh left( specimen.mesh, candidate ), right( specimen.mesh, reference );
		pliant_glue::DrawList list;
		addMesh( list, specimen.mesh, left, -0.5f * d, pliant_demos::kTerracotta );
		addMesh( list, specimen.mesh, right, 0.5f * d, pliant_demos::kSlate );
		Eigen::Vector3d middle;
		double radius = 0;
		if ( rig.ball( middle, radius ) )
		{
			const float size = 2 * float( radius );
			pliant_glue::DrawInstance ball;
			ball.axisX = { size, 0, 0 };
			ball.axisY = { 0, size, 0 };
			ball.axisZ = { 0, 0, size };
			ball.position = { float( middle.x() ) - 0.5f * d, float( middle.y() ), float( middle.z() ) };
			ball.colour = pliant_demos::kOchre;
			list.spheres.push_back( ball );
		}
		const Eigen::Vector3f at = ( ( candidate.rowwise().mean() + reference.rowwise().mean() ) / 2 ).cast<float>();
		list.hasGround = true;
		list.camera = { { 0.3f * d, at.y() + 0.7f * d, at.z() + 2.6f * d }, { 0, at.y(), at.z() }, 42.0f };
		list.light = { { -0.5f, 0.75f, 0.5f }, { 0, at.y(), at.z() }, 1.8f * d };
		return pliant_glue::writePng( path, m_renderer->drawPicture( list, kWidth, kHeight, kSupersampling ) );
	}

private:
	static void addMesh( pliant_glue::DrawList& list, const pliant_glue::ModelMesh& mesh, const DrawnMesh& drawn, float aside,
		const pliant_glue::Colour& colour )
	{
		pliant_glue::DrawMesh item;
		item.id = list.meshes.size();
		item.positions = drawn.positions.data();
		item.normals = drawn.normals.data();
		item.indices = mesh.indices.data();
		item.vertexCount = int( mesh.vertexCount() );
		item.triangleCount = int( mesh.triangleCount() );
		item.origin = { aside, 0, 0 };
		item.colour = colour;
		list.meshes.push_back( item );
	}

	std::unique_ptr<pliant_glue::Offscreen> m_context; // outlives the renderer, whose objects live in it
	std::unique_ptr<pliant_glue::Renderer> m_renderer;
};

} // namespace

std::string drawWorst(
	const StudyPlan& plan, const Specimen& specimen, const SceneInfo& scene, const std::vector<Summary>& all, const Reference& reference )
{
	std::vector<const Summary*> front;
	for ( const Summary& one : all )
	{
		if ( one.isOnFront && one.worstFrame > 0 )
		{
			front.push_back( &one );
		}
	}
	std::sort( front.begin(), front.end(), []( const Summary* a, const Summary* b ) { return a->median < b->median; } );
	std::string why;
	Painter painter;
	if ( front.empty() || !painter.init( why ) )
	{
		return {};
	}
	std::ostringstream out;
	const std::vector<Candidate> known = candidates( plan.candidates );
	const std::size_t count = std::min( kMostPictures, front.size() );
	for ( std::size_t k = 0; k < count; ++k )
	{
		const Summary& s = *front[count == 1 ? 0 : k * ( front.size() - 1 ) / ( count - 1 )];
		const auto candidate = std::find_if( known.begin(), known.end(), [&s]( const Candidate& c ) { return c.name() == s.candidate; } );
		const std::unique_ptr<Rig> rig = Rig::create( scene, specimen, *candidate, s.worstOrientation, why );
		while ( rig && rig->frame() < s.worstFrame )
		{
			rig->step();
		}
		const std::string path = plan.folder + "/worst_" + scene.name + "_" + std::to_string( k ) + ".png";
		Points points = specimen.points;
		if ( rig )
		{
			rig->subject().vertices( points );
		}
		if ( !rig || !painter.paint( specimen, *rig, points, reference.track[std::size_t( s.worstFrame / scene.framesAWrite ) - 1], path ) )
		{
			continue;
		}
		std::ifstream file( path, std::ios::binary );
		std::stringstream bytes;
		bytes << file.rdbuf();
		char caption[160];
		std::snprintf( caption, sizeof( caption ), " at %.2f s, its worst: %.2f %% off (left); the reference (right)",
			s.worstFrame * kGameStep, 100 * s.worst );
		out << "<figure><img alt='' src='data:image/png;base64," << base64( bytes.str() ) << "'><figcaption>" << s.candidate << caption
			<< "</figcaption></figure>\n";
	}
	return out.str();
}

#else

std::string drawWorst( const StudyPlan&, const Specimen&, const SceneInfo&, const std::vector<Summary>&, const Reference& )
{
	return {};
}

#endif

} // namespace pliant_study
