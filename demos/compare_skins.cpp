// +-----------------------------------------------------------------------------------------------------------------+
// | A scene drawn twice in each frame, with skins of the library and with skins of the graphics card, and the         |
// | distances between vertices and pictures.                                                                          |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/play.h"
#include "demos/run.h"

#include <cstdio>

#if PLIANT_HAS_GL
	#include "third_party_glue/offscreen.h"
	#include "third_party_glue/png_file.h"
	#include "third_party_glue/renderer.h"

	#include <algorithm>
	#include <cmath>
	#include <cstdlib>
	#include <filesystem>
#endif

namespace pliant_demos {

#if PLIANT_HAS_GL

namespace {

constexpr double kMostApart = 1e-4; // cells
constexpr double kMostTurned = 1.0; // degrees
constexpr double kFewTurned = 5e-3; // of the normals: where triangles that face each other cancel, rounding decides
constexpr double kSliver = 2e-3;    // cells: normals of narrower triangles are not compared
constexpr int kVisible = 8;         // of 255: a pixel that differs by more is counted
constexpr double kFewPixels = 1e-3; // of the picture: pixels at silhouettes, where a sample is covered in one picture only

struct Difference
{
	double position = 0, turned = 0, normals = 0, pixels = 0; ///< cells; share of normals; degrees; share of pixels
	int largest = 0;                                          ///< of a pixel's channels, of 255
	long long vertices = 0;
};

class Comparison
{
public:
	Comparison( const SceneEntry& entry, const RunSettings& settings ) : m_settings( settings )
	{
		StageOptions onCpu = settings.stage, onGpu = settings.stage;
		onCpu.gpuSkin = false;
		onGpu.gpuSkin = true;
		m_cpu = std::make_unique<Play>( entry, onCpu );
		m_gpu = std::make_unique<Play>( entry, onGpu );
	}

	int run( std::string& why )
	{
		m_context = pliant_glue::Offscreen::create( why );
		m_ofCpu = m_context ? pliant_glue::Renderer::create( why ) : nullptr;
		m_ofGpu = m_ofCpu ? pliant_glue::Renderer::create( why ) : nullptr;
		if ( !m_ofGpu || !m_cpu->isGood() || !m_gpu->isGood() )
		{
			why = why.empty() ? "a body was refused" : why;
			return 1;
		}
		const auto [frames, stepsPerFrame] = m_cpu->film( m_settings.framesPerSecond, m_settings.frames );
		Difference worst;
		for ( int frame = 0; frame < frames; ++frame )
		{
			const Difference now = compare();
			worst.position = std::max( worst.position, now.position );
			worst.turned = std::max( worst.turned, now.turned );
			worst.normals = std::max( worst.normals, now.normals );
			worst.largest = std::max( worst.largest, now.largest );
			worst.vertices += now.vertices;
			if ( now.pixels >= worst.pixels )
			{
				worst.pixels = now.pixels;
				keepPictures();
			}
			for ( int k = 0; k < stepsPerFrame; ++k )
			{
				m_cpu->step();
				m_gpu->step();
			}
		}
		return report( worst, frames );
	}

private:
	static void draw( Play& play, pliant_glue::DrawList& list )
	{
		for ( Stage* stage : play.stages() )
		{
			for ( int i = 0; i < stage->world().softBodyCount(); ++i )
			{
				stage->world().softBody( i )->setSurfaceTolerance( 0 );
			}
		}
		play.skin();
		list.clear();
		play.draw( list, false );
		list.camera = play.scene().camera( play.seconds() );
		list.light = play.scene().light();
	}

	Difference compare()
	{
		draw( *m_cpu, m_listOfCpu );
		draw( *m_gpu, m_listOfGpu );
		m_pictureOfCpu = m_ofCpu->drawPicture( m_listOfCpu, m_settings.width, m_settings.height, m_settings.supersampling );
		m_pictureOfGpu = m_ofGpu->drawPicture( m_listOfGpu, m_settings.width, m_settings.height, m_settings.supersampling );
		Difference found;
		std::size_t differing = 0;
		for ( std::size_t at = 0; at < m_pictureOfCpu.rgb.size(); at += 3 )
		{
			int most = 0;
			for ( std::size_t k = at; k < at + 3; ++k )
			{
				most = std::max( most, std::abs( int( m_pictureOfCpu.rgb[k] ) - int( m_pictureOfGpu.rgb[k] ) ) );
			}
			found.largest = std::max( found.largest, most );
			differing += most > kVisible ? 1 : 0;
		}
		found.pixels = 3.0 * double( differing ) / double( m_pictureOfCpu.rgb.size() );
		compareVertices( found );
		return found;
	}

	void compareVertices( Difference& found )
	{
		std::size_t turned = 0;
		for ( const pliant_glue::DrawMesh& mesh : m_listOfCpu.meshes )
		{
			std::vector<float> positions, normals;
			if ( !m_ofGpu->readSkin( mesh.id, mesh.vertexCount, positions, normals ) )
			{
				continue;
			}
			const std::vector<double> width = widestTriangles( mesh );
			for ( std::size_t v = 0; v < std::size_t( mesh.vertexCount ); ++v )
			{
				const double apart = distance( positions.data() + 4 * v, mesh.positions + 3 * v );
				const double chord = distance( normals.data() + 3 * v, mesh.normals + 3 * v );
				const double degrees = 2 * std::asin( std::min( 1.0, 0.5 * chord ) ) * 180 / 3.14159265358979;
				found.position = std::max( found.position, apart / double( mesh.cellSize ) );
				if ( width[v] > kSliver * double( mesh.cellSize ) )
				{
					found.normals = std::max( found.normals, degrees );
					turned += degrees > kMostTurned ? 1 : 0;
				}
			}
			found.vertices += mesh.vertexCount;
		}
		found.turned = found.vertices > 0 ? double( turned ) / double( found.vertices ) : 0;
	}

	static double distance( const float* a, const float* b )
	{
		double sum = 0;
		for ( int k = 0; k < 3; ++k )
		{
			sum += ( double( a[k] ) - double( b[k] ) ) * ( double( a[k] ) - double( b[k] ) );
		}
		return std::sqrt( sum );
	}

	/// For each vertex the width of its widest triangle, m: rounding rotates the normals of triangles that are hardly wider than it.
	static std::vector<double> widestTriangles( const pliant_glue::DrawMesh& mesh )
	{
		std::vector<double> widest( std::size_t( mesh.vertexCount ), 0 );
		for ( int t = 0; t < mesh.triangleCount; ++t )
		{
			const std::uint32_t* const corner = mesh.indices + 3 * std::size_t( t );
			double sides[3];
			for ( std::size_t k = 0; k < 3; ++k )
			{
				sides[k] = distance(
					mesh.positions + 3 * std::size_t( corner[k] ), mesh.positions + 3 * std::size_t( corner[( k + 1 ) % 3] ) );
			}
			const double s = 0.5 * ( sides[0] + sides[1] + sides[2] ), longest = std::max( { sides[0], sides[1], sides[2] } );
			const double area = std::sqrt( std::max( 0.0, s * ( s - sides[0] ) * ( s - sides[1] ) * ( s - sides[2] ) ) );
			for ( std::size_t k = 0; k < 3 && longest > 0; ++k )
			{
				widest[corner[k]] = std::max( widest[corner[k]], 2 * area / longest );
			}
		}
		return widest;
	}

	void keepPictures() const
	{
		std::error_code error;
		std::filesystem::create_directories( m_settings.folder, error );
		pliant_glue::writePng( m_settings.folder + "/skins_of_the_library.png", m_pictureOfCpu );
		pliant_glue::writePng( m_settings.folder + "/skins_of_the_gpu.png", m_pictureOfGpu );
	}

	int report( const Difference& worst, int frames ) const
	{
		std::printf(
			"  %d frames, %lld vertices: position %.2g cells, normal %.2g degrees (%.2g of them above %g); %.2g of the pixels above "
			"%d of 255, largest %d; state %s (%s)\n",
			frames, worst.vertices, worst.position, worst.normals, worst.turned, kMostTurned, worst.pixels, kVisible, worst.largest,
			m_cpu->stateHash() == m_gpu->stateHash() ? "equal" : "different", m_context->driver().c_str() );
		const bool isEqual = worst.vertices > 0 && worst.position <= kMostApart && worst.turned <= kFewTurned &&
			worst.pixels <= kFewPixels && m_cpu->stateHash() == m_gpu->stateHash();
		return isEqual ? 0 : 1;
	}

	RunSettings m_settings;
	std::unique_ptr<Play> m_cpu, m_gpu;
	std::unique_ptr<pliant_glue::Offscreen> m_context; // outlives the renderers, whose objects live in it
	std::unique_ptr<pliant_glue::Renderer> m_ofCpu, m_ofGpu;
	pliant_glue::DrawList m_listOfCpu, m_listOfGpu;
	pliant_glue::Picture m_pictureOfCpu, m_pictureOfGpu;
};

} // namespace

int compareSkins( const SceneEntry& entry, const RunSettings& settings )
{
	std::printf( "%s: skins of the library and of the graphics card\n", entry.name );
	std::string why;
	const int code = Comparison( entry, settings ).run( why );
	if ( !why.empty() )
	{
		std::fprintf( stderr, "%s: %s\n", entry.name, why.c_str() );
	}
	return code;
}

#else

int compareSkins( const SceneEntry&, const RunSettings& )
{
	std::fprintf( stderr, "built without OpenGL (libepoxy-dev, libegl-dev, libglm-dev, libstb-dev)\n" );
	return 1;
}

#endif

} // namespace pliant_demos
