// +-----------------------------------------------------------------------------------------------------------------+
// | vase_shatter: an iron ball falls on a brittle vase. Cracks begin at the point of impact and run between the shards |
// | into which the vase is divided (BreakRule::Shards), so that it breaks into some tens of curved shards and few      |
// | crumbs.                                                                                                            |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"
#include "demos/shard_count.h"

namespace pliant_demos {

namespace {

constexpr float kWall = 0.028f; // m thick: little more than a cell
constexpr float kVaseShatterCell = 0.024f;
constexpr int kAround = 72;                              // corners of each ring
constexpr btScalar kVaseShatterBall = btScalar( 0.28 );  // m across: wider than the mouth
constexpr btScalar kBallMass = btScalar( 60 );           // kg: of iron, and hollow
constexpr btScalar kFallsFrom = btScalar( 1.8 );         // m
constexpr btScalar kVaseShatterAside = btScalar( 0.02 ); // m off the axis, so that nothing breaks symmetrically
constexpr int kCrumb = 6;                                // cells: smaller pieces are rigid
constexpr float kVaseShatterShard = 0.12f;               // m
constexpr int kMostPieces = 200;
constexpr float kClayDensity = 2000.0f; // kg/m^3
constexpr float kClayModulus = 5.0e9f;  // Pa: the whole vase is rigid until it breaks, and each shard again
constexpr float kClayStrength = 3.0e6f; // Pa

/// Outer line from the foot up to the lip: radius and height, m.
const std::vector<std::array<float, 2>>& vaseLine()
{
	static const std::vector<std::array<float, 2>> kLine = { { 0.128f, 0 }, { 0.138f, 0.04f }, { 0.180f, 0.13f }, { 0.228f, 0.234f },
		{ 0.248f, 0.338f }, { 0.225f, 0.442f }, { 0.168f, 0.533f }, { 0.123f, 0.598f }, { 0.120f, 0.65f }, { 0.158f, 0.702f } };
	return kLine;
}

class VaseShatter : public ShardScene
{
public:
	VaseShatter() : ShardScene( "vase", kCrumb ) {}
	bool init( Stage& stage ) override
	{
		stage.addGround( btScalar( 0.6 ) );
		const pliant_glue::ModelMesh mesh = makeVessel( vaseLine(), kWall, kVaseShatterCell * 0.7f, kAround );
		SoftOrder order;
		order.name = "vase";
		order.mesh = &mesh;
		order.cellSize = kVaseShatterCell;
		order.material = pliant::Material();
		order.material.density = kClayDensity;
		order.material.youngsModulus = kClayModulus;
		order.material.rigidStrain = 0.02f;
		order.fracture.rule = pliant::BreakRule::Shards;
		order.fracture.strength = kClayStrength;
		order.fracture.shardSize = kVaseShatterShard;
		order.fracture.crumbFraction = 0.04f;
		order.fracture.coolDown = 0.02f;
		order.fracture.smallCells = kCrumb;
		order.fracture.smallPieces = pliant::SmallPieces::Rigid;
		order.fracture.maxPieces = kMostPieces;
		order.friction = btScalar( 0.6 );
		order.colour = kTeal;
		order.insideColour = kOchre; // clay under the glaze
		const pliant::SoftBody* const vase = stage.addSoft( order );
		stage.addSphere( kVaseShatterBall, btVector3( kVaseShatterAside / 2, kFallsFrom, kVaseShatterAside ), kBallMass, kBrick );
		return vase != nullptr;
	}

	double duration() const override { return 2.0; }
	int slowness() const override { return 2; }
	pliant_glue::DrawCamera camera( double ) const override { return { { 0.75f, 1.20f, 3.0f }, { 0.0f, 0.34f, 0 }, 32.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.45f, 0.75f, 0.50f }, { 0.0f, 0.4f, 0 }, 1.8f }; }
};

} // namespace

std::unique_ptr<Scene> makeVaseShatter()
{
	return std::make_unique<VaseShatter>();
}

} // namespace pliant_demos
