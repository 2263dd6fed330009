// A sphere in eight pieces, pulled apart: bricks, Marching Squares, exact faces, exact faces with noise, side by side (Ohta et al. 2009,
// Fig. 4), as a picture and as figures.

#include "experiments/experiments.h"

#include "lattice/build/build_lattice.h"
#include "lattice/pieces.h"
#include "lattice/test_meshes.h"
#include "support/block_body.h"
#include "support/drawn_cracks.h"
#include "surface/crack_complex/cell_complex.h"

#ifdef PLIANT_HAS_PICTURES
	#include "third_party_glue/offscreen.h"
	#include "third_party_glue/renderer.h"
#endif

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <list>
#include <string>

namespace pliant::experiment {

namespace {

constexpr double kRadius = 0.5;
constexpr double kCellSize = 1.0 / 11.0;
constexpr float kPullApart = 0.75f; ///< of a piece's distance from the middle

struct DrawnPiece
{
	std::vector<float> positions, normals, colours;
	std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct Way
{
	const char* name;
	CrackFaces faces;
	float noise;
	int subdivision;
};

constexpr Way kWays[] = {
	{ "bricks", CrackFaces::Bricks, 0.0f, 1 },
	{ "Marching Squares", CrackFaces::MarchingSquares, 0.0f, 1 },
	{ "exact", CrackFaces::Exact, 0.0f, 1 },
	{ "exact, noise", CrackFaces::Exact, 0.3f, 3 },
};

/// Cells by the nearest of eight points; none of the planes between the points is parallel to the lattice.
std::vector<std::vector<std::uint32_t>> piecesOf( const Lattice& lattice )
{
	const Eigen::Quaternionf turn( Eigen::AngleAxisf( 0.6f, Vec3( 1.0f, 2.0f, 0.5f ).normalized() ) );
	std::vector<std::vector<std::uint32_t>> pieces( 8 );
	for ( std::uint32_t cell = 0; cell < std::uint32_t( lattice.cellCount() ); ++cell )
	{
		const Vec3 p = turn * lattice.restCentre[cell];
		pieces[std::size_t( ( p.x() > 0.05f ) + 2 * ( p.y() > -0.03f ) + 4 * ( p.z() > 0.02f ) )].push_back( cell );
	}
	return pieces;
}

std::vector<CellLink> linksBetween( const Lattice& lattice, const std::vector<std::vector<std::uint32_t>>& pieces )
{
	std::vector<std::size_t> of( std::size_t( lattice.cellCount() ) );
	for ( std::size_t k = 0; k < pieces.size(); ++k )
	{
		for ( const std::uint32_t cell : pieces[k] )
		{
			of[cell] = k;
		}
	}
	std::vector<CellLink> links;
	for ( std::uint32_t a = 0; a < std::uint32_t( lattice.cellCount() ); ++a )
	{
		for ( std::uint32_t k = lattice.linkStart[a]; k < lattice.linkStart[a + 1]; ++k )
		{
			if ( const std::uint32_t b = lattice.linkTo[k]; a < b && of[a] != of[b] )
			{
				links.push_back( { a, b } );
			}
		}
	}
	return links;
}

DrawnPiece drawPiece( const test::DrawnCracks& surface, const Lattice& lattice, const Vec3& at )
{
	const NodeState nodes = test::restNodes( lattice );
	std::vector<float> rotations;
	for ( int i = 0; i < lattice.cellCount(); ++i )
	{
		rotations.insert( rotations.end(), { 0.0f, 0.0f, 0.0f, 1.0f } );
	}
	DrawnPiece out;
	out.triangles = surface.triangles();
	out.positions.resize( 3 * surface.vertexCount() );
	out.normals.resize( 3 * surface.vertexCount() );
	SkinScratch scratch;
	skin( surface.binding(), nodes, SkinPose{ .rotations = rotations.data() },
		SkinTriangles{ out.triangles[0].data(), int( out.triangles.size() ) }, scratch, out.positions.data(), out.normals.data() );
	out.colours.resize( out.positions.size() );
	for ( std::size_t t = 0; t < out.triangles.size(); ++t )
	{
		const bool isInside = surface.sources()[t] == CellComplex::kNone;
		for ( const std::uint32_t v : out.triangles[t] )
		{
			const std::array<float, 3> colour = isInside ? std::array<float, 3>{ 0.75f, 0.34f, 0.16f }
														 : std::array<float, 3>{ 0.36f, 0.46f, 0.56f };
			std::copy( colour.begin(), colour.end(), &out.colours[3 * std::size_t( v )] );
		}
	}
	for ( std::size_t v = 0; v < surface.vertexCount(); ++v )
	{
		for ( int k = 0; k < 3; ++k )
		{
			out.positions[3 * v + std::size_t( k )] += at[k];
		}
	}
	return out;
}

double milliseconds( std::chrono::steady_clock::time_point start )
{
	return 1e3 * std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count();
}

/// One sphere broken by one method; its pieces around `at`.
void breakSphere( const Way& way, const Vec3& at, std::list<DrawnPiece>& drawn )
{
	const test::Mesh mesh = test::makeSphere( kRadius, 48, 64 );
	LatticeSettings build;
	build.cellSize = float( kCellSize );
	const Result<LatticeBuild> built = buildLattice( mesh.view(), build );
	const Lattice& lattice = built.value.lattice;
	const SkinBinding skinning = bindSkin( mesh.view(), lattice, built.value.weldedVertex, Skinning::NearbyNodes );
	CrackSettings settings;
	settings.faces = way.faces;
	settings.noiseAmplitude = way.noise;
	settings.subdivision = way.subdivision;
	const auto complex = CellComplex::build( mesh.view(), lattice, skinning, build, settings );
	if ( !complex.ok() )
	{
		std::puts( complex.status.sentence.c_str() );
		return;
	}
	test::DrawnCracks surface( complex.value );
	const auto pieces = piecesOf( lattice );
	const auto start = std::chrono::steady_clock::now();
	std::vector<std::uint32_t> faces;
	for ( const CellLink& link : linksBetween( lattice, pieces ) )
	{
		const std::uint32_t face = complex.value->faceBetween( link.a, link.b );
		face != CellComplex::kNone ? faces.push_back( face ) : void();
	}
	surface.breakFaces( faces );
	const double opened = milliseconds( start );
	const Lattice torn = withoutLinks( lattice, linksBetween( lattice, pieces ) );
	std::size_t triangles = 0;
	for ( const auto& cells : pieces )
	{
		const Lattice part = extractCells( torn, cells );
		const Vec3 shift = ( part.massCentre - lattice.massCentre ).cast<float>();
		drawn.push_back( drawPiece( surface.piece( cells, shift ), part, at + ( 1.0f + kPullApart ) * shift ) );
		triangles += drawn.back().triangles.size();
	}
	std::printf( "%-18s %6zu %8d %8zu %10.1f %10.2f\n", way.name, complex.value->cellCount(), complex.value->report.faces, triangles,
		1e3 * complex.value->report.seconds, opened );
}

struct View
{
	std::array<float, 3> eye, target;
	float fieldOfView;
	int width, height;
};

#ifdef PLIANT_HAS_PICTURES
void drawPicture( const std::list<DrawnPiece>& drawn, const std::string& path, const View& view )
{
	std::string why;
	const auto screen = pliant_glue::Offscreen::create( why );
	const auto renderer = screen ? pliant_glue::Renderer::create( why ) : nullptr;
	if ( !renderer )
	{
		std::printf( "no picture: %s\n", why.c_str() );
		return;
	}
	pliant_glue::DrawList list;
	std::uint64_t id = 0;
	for ( const DrawnPiece& piece : drawn )
	{
		pliant_glue::DrawMesh mesh;
		mesh.id = ++id;
		mesh.positions = piece.positions.data();
		mesh.normals = piece.normals.data();
		mesh.indices = piece.triangles[0].data();
		mesh.vertexCount = int( piece.positions.size() / 3 );
		mesh.triangleCount = int( piece.triangles.size() );
		mesh.vertexColours = piece.colours.data();
		list.meshes.push_back( mesh );
	}
	list.camera.eye = view.eye;
	list.camera.target = view.target;
	list.camera.fieldOfView = view.fieldOfView;
	list.light.toSun = { -0.35f, 0.8f, 0.75f };
	list.light.shadowRadius = 4.0f;
	const bool isWritten = pliant_glue::writePng( path, renderer->drawPicture( list, view.width, view.height, 2.0f ) );
	std::printf( "%s: %s\n", path.c_str(), isWritten ? "written" : "cannot be written" );
}
#else
void drawPicture( const std::list<DrawnPiece>&, const std::string&, const View& )
{
	std::puts( "no picture: built without OpenGL" );
}
#endif

} // namespace

void crackExperiment()
{
	std::puts( "way                 cells    faces triangles   build ms    open ms" );
	std::list<DrawnPiece> drawn;
	float x = -2.85f;
	for ( const Way& way : kWays )
	{
		breakSphere( way, Vec3( x, 0.95f, 0.0f ), drawn );
		x += 1.9f;
	}
	drawPicture( drawn, "crack.png", { { 0.0f, 2.6f, 8.4f }, { 0.0f, 0.85f, 0.0f }, 15.0f, 1600, 470 } );
	drawPicture( drawn, "crack_near.png", { { 2.6f, 2.3f, 3.2f }, { 1.9f, 0.8f, 0.0f }, 32.0f, 1200, 670 } );
}

} // namespace pliant::experiment
