// +-----------------------------------------------------------------------------------------------------------------+
// | elephants: Ohta et al. 2009, figure 7 d-i and "Results". Five, ten and fifteen elephants fall on each other and   |
// | break; bodies that touch the pink ball stick to it. Each number of bodies has a world of its own, so that the     |
// | cost of each is known; the picture shows fifteen.                                                                 |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/must_succeed.h"
#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>

namespace pliant_demos {

namespace {

constexpr int kHerds[] = { 15, 10, 5 };
constexpr double kPaperFramesPerSecond[] = { 7, 14, 45 };
constexpr float kElephantHeight = 0.42f; // m
constexpr int kElephantsCells = 500;
constexpr int kElephantsCoarseLevels = 2;
constexpr btScalar kElephantsBall = btScalar( 0.7 );                                                    // m across
constexpr btScalar kBallHeight = btScalar( 0.55 );                                                      // m of its middle
constexpr int kAcross = 3;                                                                              // elephants in a layer, on a ring
constexpr btScalar kRing = btScalar( 0.40 ), kLayer = btScalar( 0.62 ), kFirstLayer = btScalar( 1.45 ); // m
constexpr int kTopLayer = ( kHerds[0] - 1 ) / kAcross;
constexpr double kElephantsDuration = 4.5; // s
constexpr pliant_glue::Colour kPink = { 0.85f, 0.22f, 0.36f };

struct Herd
{
	Stage* stage = nullptr;
	btRigidBody* ball = nullptr;
	std::vector<pliant::StepReport> reports = {};
	std::vector<double> skinning = {}; ///< s, of each step
	double awakeNodes = 0;             ///< summed over steps
	int stuck = 0, fragments = 0, links = 0;
};

int awakeNodesOf( pliant::SoftBodyWorld& world )
{
	int nodes = 0;
	for ( int i = 0; i < world.softBodyCount(); ++i )
	{
		nodes += world.softBody( i )->isActive() ? world.softBody( i )->nodeCount() : 0;
	}
	return nodes;
}

class Elephants : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		pliant_glue::ModelMesh mesh = stage.modelOr( "elephant.off", makeBunnyLike );
		fitHeight( mesh, kElephantHeight );
		SoftOrder order;
		order.name = "elephant";
		order.mesh = &mesh;
		order.cells = kElephantsCells;
		order.material.density = 300.0f;
		order.material.youngsModulus = 3.0e4f;
		order.material.damping = 25.0f;
		order.material.elasticity = pliant::Elasticity::Automatic; // one step a frame, instead of nine explicit ones
		order.adaptivity.coarseLevels = kElephantsCoarseLevels;
		order.adaptivity.keepMass = 0.1f;
		order.adaptivity.refineStrain = 1.0f;  // half of the breaking stretch, as for every body that breaks
		order.adaptivity.mergeFraction = 0.9f; // they lie under each other's weight
		order.fracture.rule = pliant::BreakRule::Plane;
		order.fracture.breakStrain = 2.0f; // they fall at .9 of the velocity of sound: some lose a limb
		order.friction = btScalar( 0.6 );
		order.shape = stage.buildShape( order );
		if ( order.shape == nullptr )
		{
			return false;
		}
		for ( std::size_t i = 0; i < std::size( kHerds ); ++i )
		{
			Stage* own = &stage;
			const std::string name = std::to_string( kHerds[i] ) + " elephants";
			if ( i > 0 )
			{
				m_beside.push_back( std::make_unique<Stage>( stage.options(), name ) );
				own = m_beside.back().get();
				own->hide();
			}
			own->setName( name );
			m_herds.push_back( Herd{ own } );
			if ( !drop( m_herds.back(), order, kHerds[i] ) )
			{
				return false;
			}
		}
		return true;
	}

	std::vector<Stage*> sideStages() override
	{
		std::vector<Stage*> all;
		for ( const std::unique_ptr<Stage>& stage : m_beside )
		{
			all.push_back( stage.get() );
		}
		return all;
	}

	void afterStep( Stage&, double ) override
	{
		for ( Herd& herd : m_herds )
		{
			stick( herd );
			const std::size_t before = herd.stage->log().skinnings();
			herd.stage->skin(); // in each step, as in a game that draws 60 pictures a second
			herd.skinning.push_back( herd.stage->log().skinnings() > before ? herd.stage->log().lastSkinning() : 0 );
			herd.reports.push_back( herd.stage->world().stepReport() );
			herd.fragments += herd.reports.back().fragments;
			herd.links += herd.reports.back().brokenLinks;
			herd.awakeNodes += awakeNodesOf( herd.stage->world() );
		}
	}

	std::vector<FindingTable> findings( const Stage& ) const override
	{
		FindingTable split{ "ms a frame, means; ours: all that is not Bullet's collision and solver, skins included",
			{ "ours", "of it skins", "elasticity", "collision", "solver", "in all", "worst in all", "frames/s", "paper's" }, {} };
		FindingTable events{ "what happened",
			{ "pieces came off", "broken links", "nodes stuck", "nodes at first", "mean", "at last", "awake, mean", "own us each" }, {} };
		std::vector<double> totals, own;
		for ( std::size_t i = 0; i < m_herds.size(); ++i )
		{
			const Herd& herd = m_herds[i];
			double collision = 0, solve = 0, total = 0, skins = 0, matching = 0, worst = 0, nodes = 0;
			for ( std::size_t k = 0; k < herd.reports.size(); ++k )
			{
				const double all = herd.reports[k].total + herd.skinning[k];
				collision += herd.reports[k].collision;
				solve += herd.reports[k].solve;
				skins += herd.skinning[k];
				matching += herd.reports[k].matching;
				total += all;
				nodes += double( herd.reports[k].nodes ) / double( herd.reports.size() );
				worst = std::max( worst, all );
			}
			const double perFrame = 1e3 / double( herd.reports.size() );
			const double ours = total - collision - solve;
			split.rows.push_back( { herd.stage->name(),
				{ perFrame * ours, perFrame * skins, perFrame * matching, perFrame * collision, perFrame * solve, perFrame * total,
					1e3 * worst, 1e3 / ( perFrame * total ), kPaperFramesPerSecond[i] } } );
			events.rows.push_back( { herd.stage->name(),
				{ double( herd.fragments ), double( herd.links ), double( herd.stuck ), double( herd.reports.front().nodes ), nodes,
					double( herd.reports.back().nodes ), herd.awakeNodes / double( herd.reports.size() ),
					1e6 * ours / herd.awakeNodes } } );
			totals.push_back( total );
			own.push_back( ours );
		}
		// cost ~ bodies^exponent, from 5 to 15; the paper's 45 to 7 frames a second make 1.7.
		const double ratio = std::log( double( kHerds[0] ) / double( kHerds[2] ) );
		// Against awake nodes too: many bodies are awake for longer and cost more for that reason, apart from the cost of a node.
		FindingTable exponent{ "exponent of cost over bodies, 5 to 15", { "in all", "ours", "awake nodes", "the paper" },
			{ { "exponent",
				{ std::log( totals[0] / totals[2] ) / ratio, std::log( own[0] / own[2] ) / ratio,
					std::log( m_herds[0].awakeNodes / m_herds[2].awakeNodes ) / ratio,
					std::log( kPaperFramesPerSecond[2] / kPaperFramesPerSecond[0] ) / ratio } } } };
		return { split, exponent, events };
	}

	double duration() const override { return kElephantsDuration; }
	pliant_glue::DrawCamera camera( double ) const override { return { { 1.1f, 1.65f, 4.1f }, { 0, 0.72f, 0 }, 36.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.35f, 0.80f, 0.50f }, { 0, 0.7f, 0 }, 3.0f }; }

private:
	static bool drop( Herd& herd, SoftOrder& order, int count )
	{
		herd.stage->addGround( btScalar( 0.7 ) );
		herd.ball = herd.stage->addSphere( kElephantsBall, btVector3( 0, kBallHeight, 0 ), 0, kPink );
		const pliant_glue::Colour colours[] = { kSlate, kOchre, kTeal, kTerracotta, kPlum };
		std::mt19937 random( herd.stage->options().seed );
		// The numbers of mt19937 are the same on every system; those of the standard distributions are not.
		const auto between = [&]( btScalar low, btScalar high ) {
			return low + ( high - low ) * btScalar( random() ) / btScalar( 4294967296.0 );
		};
		for ( int i = 0; i < count; ++i )
		{
			const int layer = i / kAcross;
			const btScalar angle = SIMD_2_PI * ( btScalar( i % kAcross ) / kAcross ) + btScalar( 0.5 ) * btScalar( layer );
			const btVector3 place( kRing * std::cos( angle ), kFirstLayer + kLayer * btScalar( layer ), kRing * std::sin( angle ) );
			const btVector3 axis = btVector3( between( -1, 1 ), between( 1, 2 ), between( -1, 1 ) ).normalized();
			order.place = btTransform( btQuaternion( axis, between( 0, 6 ) ), place );
			order.colour = colours[i % 5];
			pliant::SoftBody* elephant = herd.stage->addSoft( order );
			if ( elephant == nullptr || !elephant->prepareCracks().ok() )
			{
				return false;
			}
			// As fast as after a fall from the top layer of fifteen, in any layer: each of five has as much energy as each of fifteen. With
			// equal initial velocities the cost of more bodies would be mixed up with the effect of higher falls.
			const btScalar fallen = kLayer * btScalar( kTopLayer - layer );
			mustSucceed(
				elephant->setLinearVelocity( btVector3( 0, -std::sqrt( -2 * herd.stage->world().getGravity().y() * fallen ), 0 ) ) );
		}
		return true;
	}

	/// Pins every node that touches the ball at its present position.
	static void stick( Herd& herd )
	{
		btDispatcher& dispatcher = *herd.stage->world().getDispatcher();
		for ( int i = 0; i < dispatcher.getNumManifolds(); ++i )
		{
			const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal( i );
			const bool isBallFirst = manifold.getBody0() == herd.ball;
			const btCollisionObject* other = isBallFirst ? manifold.getBody1() : manifold.getBody0();
			if ( !isBallFirst && manifold.getBody1() != herd.ball )
			{
				continue;
			}
			auto* soft = pliant::SoftBody::upcast( const_cast<btCollisionObject*>( other ) ); // Bullet returns it as const
			for ( int k = 0; soft != nullptr && k < manifold.getNumContacts(); ++k )
			{
				const btManifoldPoint& point = manifold.getContactPoint( k );
				const int node = isBallFirst ? point.m_index1 : point.m_index0;
				if ( point.getDistance() <= 0 && node >= 0 && node < soft->nodeCount() && !soft->isPinned( node ) &&
					soft->pinNode( node ).ok() )
				{
					++herd.stuck;
				}
			}
		}
	}

	std::vector<std::unique_ptr<Stage>> m_beside;
	std::vector<Herd> m_herds;
};

} // namespace

std::unique_ptr<Scene> makeElephants()
{
	return std::make_unique<Elephants>();
}

} // namespace pliant_demos
