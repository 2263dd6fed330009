// +-----------------------------------------------------------------------------------------------------------------+
// | What each feature costs: off, on but idle, on and working.                                                       |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/instruction_count.h"
#include "demos/study/scale.h"
#include "demos/study/small_world.h"
#include "demos/study/subject.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>

namespace pliant_study {

namespace {

constexpr int kEdge = 12;
constexpr double kCell = 0.1;

/// How a body is asked for, and what is done to it before the steps that are counted.
struct FeatureCase
{
	std::string feature, state;
	pliant::Material material;
	pliant::Adaptivity adaptivity;
	std::function<void( pliant::SoftBody& )> prepare;
};

struct Cost
{
	double instructions = 0, seconds = 0, bytes = 0; ///< a game step, a game step, in all
};

Cost measure( const FeatureCase& one, int steps )
{
	SmallWorld world;
	world.addGround();
	const double before = bytesInUse();
	pliant::SoftBody* body = world.add( cubeTemplate( kEdge, kCell, pliant::Skinning::NearbyNodes ), btVector3( 0, btScalar( kEdge * kCell / 2 ), 0 ), one.material, one.adaptivity );
	Cost cost;
	if( body == nullptr )
	{
		return cost;
	}
	if( one.prepare )
	{
		one.prepare( *body );
	}
	for( int k = 0; k < 5; ++k )
	{
		world.timedStep();
	}
	InstructionCount count;
	std::vector<double> times;
	const std::uint64_t first = count.now();
	for( int k = 0; k < steps; ++k )
	{
		times.push_back( world.timedStep() );
	}
	cost.instructions = double( count.now() - first ) / steps;
	std::nth_element( times.begin(), times.begin() + std::ptrdiff_t( times.size() / 2 ), times.end() );
	cost.seconds = times[times.size() / 2];
	cost.bytes = bytesInUse() - before;
	return cost;
}

pliant::Material plainMaterial()
{
	pliant::Material material;
	material.youngsModulus = 2e5f;
	return material;
}

/// Features one by one; "idle" is switched on where nothing happens, "working" where it does.
class FeatureList
{
public:
	FeatureList()
	{
		add( "plain", "" );
		add( "fracture", "idle" ).prepare = []( pliant::SoftBody& body ) { body.setFracture( breaking( 10.0f ) ); };
		add( "fracture", "working (cut in two)" ).prepare = []( pliant::SoftBody& body ) {
			body.setFracture( breaking( 10.0f ) );
			body.cutPlane( body.massCentre(), btVector3( 1, 0, 0 ) );
		};
		add( "self-collision", "idle" ).prepare = []( pliant::SoftBody& body ) { body.setSelfCollision( true ); };
		FeatureCase& plastic = add( "plasticity", "idle" );
		plastic.material.yieldStrain = 1.0f;
		FeatureCase& flowing = add( "plasticity", "working" );
		flowing.material.yieldStrain = 1e-4f;
		add( "kept volume", "working" ).material.volumeKeeping = 1;
		add( "levels", "idle (refined, nothing strained)" ).adaptivity = levels( 1.0f );
		add( "levels", "working (splits and merges)" ).adaptivity = levels( 0.002f );
		FeatureCase& far = add( "far levels", "idle (stiffness within reach)" );
		far.material.farLevels = 1;
		FeatureCase& reaching = add( "far levels", "working" );
		reaching.material.farLevels = 1;
		reaching.material.youngsModulus = 2e6f;
		add( "implicit", "working" ).material.elasticity = pliant::Elasticity::Implicit;
		add( "pins", "working" ).prepare = []( pliant::SoftBody& body ) {
			body.pinNodesInside( btVector3( -1, -1, -1 ), btVector3( 1, btScalar( 0.1 ), 1 ) );
		};
		add( "wider regions", "w 2" ).material.regionHalfWidth = 2;
	}

	const std::vector<FeatureCase>& all() const { return m_all; }

private:
	static pliant::Fracture breaking( float strain )
	{
		pliant::Fracture fracture;
		fracture.rule = pliant::BreakRule::Distance;
		fracture.breakStrain = strain;
		return fracture;
	}

	static pliant::Adaptivity levels( float strain )
	{
		pliant::Adaptivity settings;
		settings.coarseLevels = 2;
		settings.refineStrain = strain;
		return settings;
	}

	FeatureCase& add( const std::string& feature, const std::string& state )
	{
		FeatureCase one;
		one.feature = feature;
		one.state = state;
		one.material = plainMaterial();
		m_all.push_back( one );
		return m_all.back();
	}

	std::vector<FeatureCase> m_all;
};

} // namespace

int studyFeatures( const FeaturePlan& plan )
{
	std::error_code error;
	std::filesystem::create_directories( plan.folder, error );
	std::ofstream csv( plan.folder + "/features.csv" );
	csv << "feature,state,instructions_a_step,us_a_step,bytes,instructions_ratio,time_ratio,memory_ratio\n";
	std::printf( "A block of %d cells on a plane, %d game steps; ratios to the plain body\n\n  %-16s %-34s %14s %10s %10s\n", kEdge * kEdge * kEdge, plan.steps, "feature",
		"", "instructions", "time", "memory" );
	Cost plain;
	if( !InstructionCount().works() )
	{
		std::printf( "  (this system does not let instructions be counted: their column is empty)\n" );
	}
	const FeatureList list;
	for( const FeatureCase& one : list.all() )
	{
		const Cost cost = measure( one, plan.steps );
		plain = one.feature == "plain" ? cost : plain;
		const double instructions = plain.instructions > 0 ? cost.instructions / plain.instructions : 0.0;
		const double time = cost.seconds / plain.seconds, memory = plain.bytes > 0 ? cost.bytes / plain.bytes : 0.0;
		std::printf( "  %-16s %-34s %14.4f %10.3f %10.3f\n", one.feature.c_str(), one.state.c_str(), instructions, time, memory );
		csv << one.feature << ",\"" << one.state << "\"," << cost.instructions << ',' << 1e6 * cost.seconds << ',' << cost.bytes << ',' << instructions << ',' << time
			<< ',' << memory << '\n';
	}
	std::printf( "\n%s/features.csv\n", plan.folder.c_str() );
	return csv.flush() ? 0 : 1;
}

} // namespace pliant_study
