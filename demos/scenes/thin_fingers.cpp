// +-----------------------------------------------------------------------------------------------------------------+
// | thin_fingers: Steinemann et al. 2008, figure 1. A lattice fine enough for thin fingers fills the whole palm with  |
// | cells; levels keep the cells in the fingers and put coarse nodes into the palm. A bar sweeps through the fingers. |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/creatures.h"
#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/skin_distance.h"

#include <algorithm>
#include <cmath>

namespace pliant_demos {

namespace {

constexpr int kThinFingersCoarseLevels = 3;
constexpr float kThinFingersKeepMass = 0.9f; // full blocks only: a finger fills a quarter of each block it runs through
constexpr int kRootCells =
	2; // of the palm above each finger, and one around it, as fine as the finger: big nodes there would hold it elsewhere
constexpr btScalar kPalmBottom = btScalar( 0.75 );      // m above the ground
constexpr btScalar kThinFingersApart = btScalar( 1.3 ); // m from the uniform body to the one with levels
constexpr btScalar kThinFingersAside = btScalar( 1.1 ); // m from a body to the picture of its nodes
constexpr btScalar kBarThickness = btScalar( 0.05 );
constexpr btScalar kBarSpeed = btScalar( 0.55 ); // m/s
constexpr double kBarStart = 0.3;                // s
constexpr pliant_glue::Colour kLevelColours[] = { kTerracotta, kOchre, kMoss, kSlate };

PalmPlan palmPlan()
{
	PalmPlan plan;
	plan.fingers = { { 4, 14 }, { 12, 8 }, { 20, 16 }, { 28, 8 }, { 36, 14 } };
	return plan;
}

/// A body and the bar that sweeps below it, at a position of their own.
struct Hall
{
	Stage* stage = nullptr;
	pliant::SoftBody* body = nullptr;
	btRigidBody* bar = nullptr;
	btScalar x = 0;
	std::vector<std::vector<int>> tips = {}; ///< of each finger: the vertices of its end
	std::vector<btVector3> restOfTip = {};   ///< their centre, before the bar comes
	std::vector<double> deflection = {};     ///< of each tip, at most, m
};

class ThinFingers : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		const pliant_glue::ModelMesh mesh = makePalm( m_plan );
		SoftOrder order;
		order.name = "palm";
		order.mesh = &mesh;
		order.cellSize = m_plan.cell;
		order.material.density = 300.0f;
		order.material.youngsModulus = 7.0e4f;
		order.material.damping = 5.0f;
		order.shape = stage.buildShape( order );
		if ( order.shape == nullptr )
		{
			return false;
		}
		m_beside = std::make_unique<Stage>( stage.options(), "with levels" );
		stage.setName( "uniform lattice" );
		const bool isUniformMade = furnish( m_uniform, stage, order, -kThinFingersApart / 2 );
		order.adaptivity.coarseLevels = kThinFingersCoarseLevels;
		order.adaptivity.keepMass = kThinFingersKeepMass;
		return isUniformMade && furnish( m_levels, *m_beside, order, kThinFingersApart / 2 );
	}

	std::vector<Stage*> sideStages() override { return { m_beside.get() }; }

	void beforeStep( Stage&, double seconds ) override
	{
		refineRoots();
		const btScalar travelled = kBarSpeed * btScalar( std::max( 0.0, seconds - kBarStart ) );
		for ( const Hall& hall : { m_uniform, m_levels } )
		{
			Stage::moveBody( hall.bar, btTransform( btQuaternion::getIdentity(), barStart( hall.x ) + btVector3( travelled, 0, 0 ) ) );
		}
	}

	void afterStep( Stage& stage, double ) override
	{
		stage.skin();
		m_beside->skin();
		const SkinDistance now = skinDistance( *m_levels.body, *m_uniform.body, btVector3( kThinFingersApart, 0, 0 ) );
		if ( m_isFinger.empty() )
		{
			rememberRest();
		}
		for ( Hall* hall : { &m_uniform, &m_levels } )
		{
			for ( std::size_t i = 0; i < hall->tips.size(); ++i )
			{
				hall->deflection[i] = std::max( hall->deflection[i], double( tipOf( *hall, i ).distance( hall->restOfTip[i] ) ) );
			}
		}
		double sum = 0;
		int count = 0;
		for ( std::size_t i = 0; i < m_isFinger.size(); ++i )
		{
			sum += m_isFinger[i] ? double( now.vertex[i] ) : 0;
			count += m_isFinger[i] ? 1 : 0;
		}
		m_meanDifference += sum / count;
		m_largestMean = std::max( m_largestMean, sum / count );
		m_largestDifference = std::max( m_largestDifference, now.largest );
		++m_steps;
	}

	void beforePicture( Stage&, pliant_glue::DrawList& list ) override
	{
		drawNodes( m_uniform, -kThinFingersAside, list );
		drawNodes( m_levels, kThinFingersAside, list );
	}

	std::vector<FindingTable> findings( const Stage& stage ) const override
	{
		const double fraction = 100 / m_diagonal;
		FindingTable tips{
			"largest deflection of each tip, % of the bounding-box diagonal", { "uniform", "with levels", "difference" }, {} };
		double most = 0;
		for ( std::size_t i = 0; i < m_uniform.deflection.size(); ++i )
		{
			const double a = m_uniform.deflection[i] * fraction, b = m_levels.deflection[i] * fraction;
			tips.rows.push_back( { "finger " + std::to_string( i + 1 ), { a, b, b - a } } );
			most = std::max( most, std::abs( b - a ) );
		}
		tips.rows.push_back( { "worst (goal 1)", { 0, 0, most } } );
		FindingTable difference{ "all vertices of the fingers, at the same instants, % of the bounding-box diagonal",
			{ "mean diff.", "worst mean", "worst vertex" },
			{ { "fingers", { m_meanDifference / m_steps * fraction, m_largestMean * fraction, m_largestDifference * fraction } } } };
		const StepLog &slow = stage.log(), &fast = m_beside->log();
		FindingTable speed{ "uniform over levels", { "nodes", "matching", "whole step", "skin" },
			{ { "times",
				{ double( m_uniform.body->nodeCount() ) / m_levels.body->nodeCount(), slow.medianMatching() / fast.medianMatching(),
					slow.medianStep() / fast.medianStep(), slow.medianSkinning() / fast.medianSkinning() } } } };
		return { tips, difference, speed };
	}

	double duration() const override { return 2.8; }
	pliant_glue::DrawCamera camera( double ) const override { return { { 0.3f, 0.85f, 6.4f }, { 0.02f, 0.74f, 0 }, 25.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.35f, 0.75f, 0.6f }, { 0, 0.6f, 0 }, 3.2f }; }

private:
	btVector3 barStart( btScalar x ) const
	{
		const btScalar tips = kPalmBottom - m_plan.cell * btScalar( m_plan.fingerCells );
		return btVector3( x - btScalar( m_plan.width( 0 ) ) / 2 - btScalar( 0.1 ), tips + btScalar( 0.1 ), 0 );
	}

	bool furnish( Hall& hall, Stage& stage, SoftOrder order, btScalar x ) const
	{
		const btScalar width = btScalar( m_plan.width( 0 ) ), height = btScalar( m_plan.width( 1 ) ), depth = btScalar( m_plan.width( 2 ) );
		const btScalar top = kPalmBottom + height, plate = btScalar( 0.06 ), block = btScalar( 8 * m_plan.cell );
		order.colour = kTerracotta;
		order.place = btTransform( btQuaternion::getIdentity(), btVector3( x - width / 2, kPalmBottom, -depth / 2 ) );
		hall.stage = &stage;
		hall.x = x;
		hall.body = stage.addSoft( order );
		if ( hall.body == nullptr )
		{
			return false;
		}
		// Held from above: the nodes of the topmost blocks, of any size.
		hall.body->pinNodesInside( btVector3( x - width, top - block, -depth ), btVector3( x + width, top, depth ) );
		stage.addBox(
			btVector3( width, plate, depth ), btTransform( btQuaternion::getIdentity(), btVector3( x, top + plate / 2, 0 ) ), 0, kStone );
		hall.bar = stage.addBox( btVector3( kBarThickness, kBarThickness, depth * btScalar( 1.3 ) ),
			btTransform( btQuaternion::getIdentity(), barStart( x ) ), 0, kOak );
		return true;
	}

	/// Number of finest cells whose material a node represents.
	double cellsIn( const pliant::SoftBody& body, int node ) const
	{
		return double( body.nodeMass( node ) ) / ( double( body.material().density ) * std::pow( double( m_plan.cell ), 3 ) );
	}

	/// Requested again in each step: nodes without a request are merged.
	void refineRoots() const
	{
		const btVector3 corner( m_levels.x - btScalar( m_plan.width( 0 ) ) / 2, kPalmBottom, -btScalar( m_plan.width( 2 ) ) / 2 );
		const btScalar cell = btScalar( m_plan.cell ), inside = cell / 4;
		for ( const std::array<int, 2>& finger : m_plan.fingers )
		{
			const btVector3 low = corner + btVector3( cell * btScalar( finger[0] ), 0, cell * btScalar( finger[1] ) );
			m_levels.body->requestRefinement( low - btVector3( cell - inside, -inside, cell - inside ),
				low + btVector3( 3 * cell - inside, kRootCells * cell - inside, 3 * cell - inside ) );
		}
	}

	/// Whether a node can be seen from outside: it is within half its own edge, with a tolerance, of a face of the palm; or it is in a
	/// finger.
	bool isOutside( const Hall& hall, int node ) const
	{
		const btScalar width = btScalar( m_plan.width( 0 ) ), height = btScalar( m_plan.width( 1 ) ), depth = btScalar( m_plan.width( 2 ) );
		const btVector3 at = hall.body->nodePosition( node ) - btVector3( hall.x, kPalmBottom + height / 2, 0 );
		const btScalar near = btScalar( 0.6 * m_plan.cell * std::cbrt( cellsIn( *hall.body, node ) ) );
		return std::abs( at.x() ) > width / 2 - near || std::abs( at.y() ) > height / 2 - near || std::abs( at.z() ) > depth / 2 - near;
	}

	/// Nodes as cubes of the material that they represent, coloured by level.
	void drawNodes( const Hall& hall, btScalar aside, pliant_glue::DrawList& list ) const
	{
		for ( int i = 0; i < hall.body->nodeCount(); ++i )
		{
			if ( !isOutside( hall, i ) )
			{
				continue;
			}
			const int level = hall.body->nodeLevel( i );
			const float edge = 0.94f * m_plan.cell * float( 1 << level );
			const btVector3 at = hall.body->nodePosition( i ) + btVector3( aside, 0, 0 );
			list.boxes.push_back( { { edge, 0, 0 }, { 0, edge, 0 }, { 0, 0, edge }, { float( at.x() ), float( at.y() ), float( at.z() ) },
				kLevelColours[level] } );
		}
	}

	void rememberRest()
	{
		const pliant::SurfaceView skin = m_uniform.body->surface();
		const btScalar end = kPalmBottom - m_plan.cell * btScalar( m_plan.fingerCells - 0.5 );
		m_uniform.tips.resize( m_plan.fingers.size() );
		for ( int i = 0; i < skin.vertexCount; ++i )
		{
			const btVector3 at = vertexAt( skin, i );
			m_isFinger.push_back( at.y() < kPalmBottom - m_plan.cell );
			if ( at.y() < end )
			{
				// Eight cells from one finger to the next.
				const double column = double( at.x() - m_uniform.x ) / double( m_plan.cell ) + 4.0 * m_plan.blocks[0];
				m_uniform.tips[std::size_t( column ) / 8].push_back( i );
			}
		}
		m_levels.tips = m_uniform.tips;
		for ( Hall* hall : { &m_uniform, &m_levels } )
		{
			hall->deflection.assign( hall->tips.size(), 0 );
			for ( std::size_t i = 0; i < hall->tips.size(); ++i )
			{
				hall->restOfTip.push_back( tipOf( *hall, i ) );
			}
		}
		m_diagonal = boxDiagonal( *m_uniform.body );
	}

	static btVector3 vertexAt( const pliant::SurfaceView& skin, int i )
	{
		const float* p = skin.positions + std::size_t( i ) * 3;
		return skin.origin + btVector3( btScalar( p[0] ), btScalar( p[1] ), btScalar( p[2] ) );
	}

	static btVector3 tipOf( const Hall& hall, std::size_t finger )
	{
		const pliant::SurfaceView skin = hall.body->surface();
		btVector3 sum( 0, 0, 0 );
		for ( const int i : hall.tips[finger] )
		{
			sum += vertexAt( skin, i );
		}
		return sum / btScalar( hall.tips[finger].size() );
	}

	const PalmPlan m_plan = palmPlan();
	std::unique_ptr<Stage> m_beside;
	Hall m_uniform, m_levels;
	std::vector<bool> m_isFinger;
	double m_diagonal = 1, m_meanDifference = 0, m_largestMean = 0, m_largestDifference = 0;
	int m_steps = 0;
};

} // namespace

std::unique_ptr<Scene> makeThinFingers()
{
	return std::make_unique<ThinFingers>();
}

} // namespace pliant_demos
