// Every model of some folders becomes a body that is dropped on a floor; a line has the result. Usage:
//
//   model_survey [--cells N] folder or file ...
//
// Each model is scaled to 1 m. A line has: the result of building, its processor seconds, the number of cells (and of those of the shell),
// connected parts, the depth of the lowest drawn point below the floor after 150 frames (in cells; negative above the floor), and the file.
// Ends with a summary. The exit code is 1 if a model failed, 77 if there are no models.

#include "third_party_glue/assimp_mesh.h"

#include <pliant/soft_body_world.h>

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

constexpr int kSurveyFrames = 150;
constexpr float kDropHeight = 0.1f;     // m, lowest point over the floor
constexpr double kSecondsAllowed = 1.0; // to build
constexpr double kRefusalsAllowed = 0.02;
constexpr int kNothingToLookAt = 77;

struct Survey
{
	int models = 0, bodies = 0, refused = 0, slow = 0, deep = 0;
};

/// Centred, its longest side 1 m; vertices that no triangle uses are ignored.
void scaleToOne( pliant_glue::ModelMesh& mesh )
{
	std::array<double, 3> low, high;
	low.fill( 1e300 );
	high.fill( -1e300 );
	for ( const std::uint32_t vertex : mesh.indices )
	{
		for ( std::size_t k = 0; k < 3; ++k )
		{
			low[k] = std::min( low[k], double( mesh.positions[3 * vertex + k] ) );
			high[k] = std::max( high[k], double( mesh.positions[3 * vertex + k] ) );
		}
	}
	const double size = std::max( { high[0] - low[0], high[1] - low[1], high[2] - low[2] } );
	for ( std::size_t i = 0; i < mesh.positions.size(); ++i )
	{
		mesh.positions[i] = float( ( mesh.positions[i] - 0.5 * ( low[i % 3] + high[i % 3] ) ) / ( size > 0.0 ? size : 1.0 ) );
	}
}

/// At least one triangle has an area.
bool hasArea( const pliant_glue::ModelMesh& mesh )
{
	double most = 0.0;
	for ( std::size_t t = 0; t < mesh.indices.size(); t += 3 )
	{
		const auto corner = [&]( std::size_t k ) {
			const float* p = &mesh.positions[3 * std::size_t( mesh.indices[t + k] )];
			return btVector3( p[0], p[1], p[2] );
		};
		most = std::max( most, double( ( corner( 1 ) - corner( 0 ) ).cross( corner( 2 ) - corner( 0 ) ).length2() ) );
	}
	return most > 0.0;
}

double lowestDrawn( const pliant::SoftBody& body, const pliant_glue::ModelMesh& mesh )
{
	const pliant::SurfaceView view = body.surface();
	double low = 1e300;
	for ( const std::uint32_t vertex : mesh.indices )
	{
		low = std::min( low, double( view.positions[3 * std::size_t( vertex ) + 1] ) );
	}
	return low + double( view.origin.y() );
}

/// Final depth of the lowest drawn point below the floor, m.
double dropOnFloor( const std::shared_ptr<const pliant::BodyTemplate>& shape, const pliant_glue::ModelMesh& mesh )
{
	btDefaultCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher( &configuration );
	btDbvtBroadphase broadphase;
	btSequentialImpulseConstraintSolver solver;
	pliant::SoftBodyWorld world( &dispatcher, &broadphase, &solver, &configuration );
	btStaticPlaneShape plane( btVector3( 0, 1, 0 ), 0 );
	btRigidBody floor( 0, nullptr, &plane );
	world.addRigidBody( &floor );
	double depth = 0.0;
	{
		pliant::SoftBodyResult made = pliant::SoftBody::create( shape, btTransform::getIdentity() );
		pliant::SoftBody& body = *made.value;
		static_cast<void>( body.teleport(
			btTransform( btQuaternion::getIdentity(), btVector3( 0, btScalar( kDropHeight - lowestDrawn( body, mesh ) ), 0 ) ) ) );
		world.addSoftBody( &body );
		for ( int frame = 0; frame < kSurveyFrames; ++frame )
		{
			world.stepSimulation( btScalar( 1 ) / 60, 0 );
		}
		depth = -lowestDrawn( body, mesh );
	}
	world.removeRigidBody( &floor );
	return depth;
}

void look( const fs::path& file, int cells, Survey& survey )
{
	pliant_glue::ReadResult read = pliant_glue::readModel( file.string() );
	if ( !read.ok() )
	{
		return;
	}
	pliant_glue::ModelMesh& mesh = read.mesh;
	scaleToOne( mesh );
	if ( !hasArea( mesh ) )
	{
		std::printf( "no area %s\n", file.c_str() );
		return;
	}
	pliant::MeshView view;
	view.positions = mesh.positions.data();
	view.vertexCount = mesh.vertexCount();
	view.indices = mesh.indices.data();
	view.triangleCount = mesh.triangleCount();
	pliant::LatticeSettings settings;
	settings.targetCells = cells;
	const std::clock_t start = std::clock();
	const auto built = pliant::BodyTemplate::build( view, settings );
	const double seconds = double( std::clock() - start ) / CLOCKS_PER_SEC;
	++survey.models;
	if ( !built.ok() )
	{
		++survey.refused;
		std::printf(
			"%-12s %7.3f s %s\n    %s\n", pliant::toString( built.status.code ), seconds, file.c_str(), built.status.sentence.c_str() );
		return;
	}
	const pliant::BuildReport& report = built.value->report();
	const double depth = dropOnFloor( built.value, mesh ) / double( built.value->cellSize() );
	++survey.bodies;
	survey.slow += seconds > kSecondsAllowed;
	survey.deep += !( depth <= 1.0 );
	std::printf( "%-12s %7.3f s %6d cells %6d shell %5d parts %7.3f below %s\n", "Ok", seconds, report.cells, report.shellCells,
		report.components, depth, file.c_str() );
	std::fflush( stdout );
}

} // namespace

int main( int count, char** words )
{
	int cells = 800;
	Survey survey;
	for ( int k = 1; k < count; ++k )
	{
		const std::string word = words[k];
		if ( word == "--cells" && k + 1 < count )
		{
			cells = std::atoi( words[++k] );
			continue;
		}
		std::vector<fs::path> files;
		if ( fs::is_regular_file( word ) )
		{
			files.emplace_back( word );
		}
		else if ( fs::is_directory( word ) )
		{
			for ( const auto& entry : fs::recursive_directory_iterator( word ) )
			{
				if ( entry.is_regular_file() )
				{
					files.push_back( entry.path() );
				}
			}
		}
		std::sort( files.begin(), files.end() );
		for ( const fs::path& file : files )
		{
			look( file, cells, survey );
		}
	}
	std::printf( "%d models: %d bodies, %d refused; %d took more than %.0f s to build, %d are drawn more than a cell below the floor\n",
		survey.models, survey.bodies, survey.refused, survey.slow, kSecondsAllowed, survey.deep );
	if ( survey.models == 0 )
	{
		return kNothingToLookAt;
	}
	return survey.slow > 0 || survey.deep > 0 || survey.refused > kRefusalsAllowed * survey.models ? 1 : 0;
}
