// +-----------------------------------------------------------------------------------------------------------------+
// | bunny_tear: Ohta et al. 2009, figures 5 b and 7 a-c. A bunny held by its head is torn by its weight, which is     |
// | applied slowly. Nodes are split where it is about to tear and merged again afterwards; a second bunny's nodes are |
// | never merged.                                                                                                     |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"

#include <algorithm>
#include <cmath>

namespace pliant_demos {

namespace {

constexpr float kBunnyTearHeight = 0.8f; // m
constexpr int kBunnyTearCells = 2000;
constexpr int kBunnyTearCoarseLevels = 1;                 // with more levels cracks stop early next to coarse nodes
constexpr btScalar kBunnyTearLift = btScalar( 1.25 );     // m of the bunny's middle above the ground
constexpr btScalar kBunnyTearApart = btScalar( 1.1 );     // m from one bunny to the other
constexpr btScalar kBunnyTearHeldFrom = btScalar( 0.13 ); // m above its middle: head and ears
constexpr btScalar kRolling = btScalar( 0.02 );           // m: without it pieces would roll to and fro throughout the film
constexpr double kFullWeightAt = 2.0;                     // s
constexpr btScalar kGravity = btScalar( 9.81 );           // m/s^2
constexpr float kNever = 60.0f;                           // s of mergeDelay: longer than the film
constexpr double kBunnyTearDuration = 16.0;               // s
constexpr double kRow = 1.0;                              // s of film for each row of the table
constexpr double kMerged = 1.0;   // s after the last crack: nodes that can be merged have been, and all bodies are still awake
constexpr double kSettled = 10.0; // s after the last crack, when a step should cost as much as before the first one

struct Hanging
{
	Stage* stage = nullptr;
	std::vector<double> nodes = {}, seconds = {}; ///< of each step
	int firstCrack = -1, lastCrack = -1;          ///< steps
	int mostNodes = 0;
};

double medianOf( const std::vector<double>& values, double from, double to )
{
	const auto at = [&]( double seconds ) {
		return values.begin() + std::ptrdiff_t( std::clamp( seconds * 60, 0.0, double( values.size() ) ) );
	};
	std::vector<double> part( at( from ), at( to ) );
	if ( part.empty() )
	{
		return 0;
	}
	std::nth_element( part.begin(), part.begin() + std::ptrdiff_t( part.size() / 2 ), part.end() );
	return part[part.size() / 2];
}

class BunnyTear : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		pliant_glue::ModelMesh mesh = stage.modelOr( "bunny00.off", makeBunnyLike );
		fitHeight( mesh, kBunnyTearHeight );
		SoftOrder order;
		order.name = "bunny";
		order.mesh = &mesh;
		order.cells = kBunnyTearCells;
		order.material.density = 300.0f;
		order.material.youngsModulus = 7.0e3f;
		order.material.damping = 50.0f;
		order.adaptivity.coarseLevels = kBunnyTearCoarseLevels;
		order.adaptivity.keepMass = 0.1f;
		order.adaptivity.refineStrain = 1.0f;   // half of the breaking stretch, as for every body that breaks
		order.adaptivity.mergeFraction = 0.95f; // it lies under its own weight afterwards
		order.adaptivity.mergeDelay = 0.25f;
		order.fracture.rule = pliant::BreakRule::Plane;
		order.fracture.breakStrain = 0.38f;    // a little below the strain that its weight causes
		order.fracture.growthFraction = 0.25f; // a tear runs through and leaves few crumbs
		order.fracture.coolDown = 0.1f;
		order.shape = stage.buildShape( order );
		if ( order.shape == nullptr )
		{
			return false;
		}
		m_beside = std::make_unique<Stage>( stage.options(), "without merging" );
		stage.setName( "with merging" );
		order.colour = kTerracotta;
		const bool isMade = hang( m_merging, stage, order, -kBunnyTearApart / 2 );
		order.colour = kSlate;
		order.adaptivity.mergeDelay = kNever;
		return isMade && hang( m_keeping, *m_beside, order, kBunnyTearApart / 2 );
	}

	std::vector<Stage*> sideStages() override { return { m_beside.get() }; }

	void beforeStep( Stage&, double seconds ) override
	{
		const btVector3 gravity( 0, -kGravity * btScalar( std::min( 1.0, seconds / kFullWeightAt ) ), 0 );
		for ( const Hanging* bunny : { &m_merging, &m_keeping } )
		{
			bunny->stage->world().setGravity( gravity );
		}
	}

	void afterStep( Stage&, double ) override
	{
		for ( Hanging* bunny : { &m_merging, &m_keeping } )
		{
			const pliant::StepReport& report = bunny->stage->world().stepReport();
			if ( report.brokenLinks > 0 )
			{
				bunny->lastCrack = int( bunny->nodes.size() );
				bunny->firstCrack = bunny->firstCrack < 0 ? bunny->lastCrack : bunny->firstCrack;
			}
			bunny->nodes.push_back( double( report.nodes ) );
			bunny->seconds.push_back( report.total );
			bunny->mostNodes = std::max( bunny->mostNodes, report.nodes );
		}
	}

	std::vector<FindingTable> findings( const Stage& ) const override
	{
		FindingTable time{ "seconds of film; ms a step, medians", { "nodes, merging", "without", "ms, merging", "without" }, {} };
		for ( double t = 0; t + kRow <= double( m_merging.nodes.size() ) / 60; t += kRow )
		{
			time.rows.push_back( { std::to_string( int( t ) ) + " to " + std::to_string( int( t + kRow ) ) + " s",
				{ medianOf( m_merging.nodes, t, t + kRow ), medianOf( m_keeping.nodes, t, t + kRow ),
					1e3 * medianOf( m_merging.seconds, t, t + kRow ), 1e3 * medianOf( m_keeping.seconds, t, t + kRow ) } } );
		}
		FindingTable nodes{ "nodes (the paper: 207, 623, 343)", { "at first", "at most", "at last" }, {} };
		FindingTable cost{ "ms a step (the paper, after the crack: 4 with merging, 8 without)",
			{ "before", "1 s after", "10 s after", "10 s over before", "last crack, s" }, {} };
		for ( const Hanging* bunny : { &m_merging, &m_keeping } )
		{
			if ( bunny->firstCrack < 0 )
			{
				continue;
			}
			nodes.rows.push_back( { bunny->stage->name(), { bunny->nodes.front(), double( bunny->mostNodes ), bunny->nodes.back() } } );
			const double before = 1e3 * medianOf( bunny->seconds, 0, double( bunny->firstCrack ) / 60 );
			const double last = double( bunny->lastCrack ) / 60,
						 awake = 1e3 * medianOf( bunny->seconds, last + kMerged, last + kMerged + 1 );
			const double after = 1e3 * medianOf( bunny->seconds, last + kSettled, last + kSettled + 1 );
			cost.rows.push_back( { bunny->stage->name(), { before, awake, after, after / before, last } } );
		}
		return { time, nodes, cost };
	}

	double duration() const override { return kBunnyTearDuration; }
	pliant_glue::DrawCamera camera( double ) const override { return { { -0.7f, 1.25f, 4.6f }, { 0, 0.86f, 0 }, 30.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.35f, 0.80f, 0.50f }, { 0, 0.5f, 0 }, 2.0f }; }

private:
	static bool hang( Hanging& bunny, Stage& stage, SoftOrder& order, btScalar x )
	{
		order.place = btTransform( btQuaternion::getIdentity(), btVector3( x, kBunnyTearLift, 0 ) );
		bunny.stage = &stage;
		stage.addGround( btScalar( 0.8 ) );
		pliant::SoftBody* body = stage.addSoft( order );
		if ( body == nullptr )
		{
			return false;
		}
		body->setRollingFriction( kRolling );
		return body->pinNodesInside(
				   btVector3( x - 1, kBunnyTearLift + kBunnyTearHeldFrom, -1 ), btVector3( x + 1, kBunnyTearLift + 2, 1 ) ) > 0;
	}

	std::unique_ptr<Stage> m_beside;
	Hanging m_merging, m_keeping;
};

} // namespace

std::unique_ptr<Scene> makeBunnyTear()
{
	return std::make_unique<BunnyTear>();
}

} // namespace pliant_demos
