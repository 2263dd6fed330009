// +-----------------------------------------------------------------------------------------------------------------+
// | table: a laden wooden table stands until iron balls shoot two of its legs away, one after the other; then it      |
// | falls with its load. It is one body of wood that splits along the grain of its legs and of its top.               |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"
#include "demos/shard_count.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pliant_demos {

namespace {

constexpr float kTableCell = 0.05f;                                              // m
constexpr float kTopLength = 1.4f, kTopWidth = 0.8f, kTopThickness = kTableCell; // m
constexpr float kLeg = 2 * kTableCell, kTableHeight = 0.7f;                      // m
constexpr float kInset = 0.002f;                                                 // m, of the legs
constexpr int kTableCrumb = 3;                                                   // cells
constexpr btScalar kShotMass = 8, kShotSpeed = 16;                               // kg, m/s
constexpr btScalar kShotSize = btScalar( 0.14 ), kShotHeight = btScalar( 0.3 );  // m
constexpr double kShots[2] = { 0.7, 1.5 };                                       // s
constexpr double kStandsUntil = 0.6;                                             // s
constexpr btScalar kPlateMass = 12;                                              // kg

void append( pliant_glue::ModelMesh& to, const std::array<float, 3>& edges, const std::array<float, 3>& at )
{
	std::array<int, 3> cuts;
	std::transform(
		edges.begin(), edges.end(), cuts.begin(), []( float edge ) { return std::max( 1, int( std::lround( edge / kTableCell ) ) ); } );
	const pliant_glue::ModelMesh box = makeBox( edges, cuts );
	const std::uint32_t first = std::uint32_t( to.vertexCount() );
	for ( std::size_t i = 0; i < box.positions.size(); ++i )
	{
		to.positions.push_back( box.positions[i] + at[i % 3] );
	}
	for ( const std::uint32_t index : box.indices )
	{
		to.indices.push_back( first + index );
	}
}

/// On the ground, its centre at the origin. The legs reach into the top, a little inside of its sides, so that no two faces coincide.
pliant_glue::ModelMesh makeTableMesh()
{
	pliant_glue::ModelMesh mesh;
	mesh.name = "table";
	append( mesh, { kTopLength, kTopThickness, kTopWidth }, { 0, kTableHeight - kTopThickness / 2, 0 } );
	const float height = kTableHeight - kTopThickness / 2, x = ( kTopLength - kLeg ) / 2 - kInset, z = ( kTopWidth - kLeg ) / 2 - kInset;
	for ( const float side : { -1.0f, 1.0f } )
	{
		append( mesh, { kLeg, height, kLeg }, { side * x, height / 2, z } );
		append( mesh, { kLeg, height, kLeg }, { side * x, height / 2, -z } );
	}
	return mesh;
}

/// Wood is stronger along its grain: upwards in the legs, along x in the top.
float tableToughness( const float* point, const float* direction, void* )
{
	const float along = direction[point[1] < kTableHeight - kTopThickness ? 1 : 0];
	return 0.5f + 0.5f * along * along;
}

class Table : public ShardScene
{
public:
	Table() : ShardScene( "table", kTableCrumb ) {}
	bool init( Stage& stage ) override
	{
		stage.addGround( btScalar( 0.7 ) );
		const pliant_glue::ModelMesh mesh = makeTableMesh();
		SoftOrder order;
		order.name = "table";
		order.mesh = &mesh;
		order.cellSize = kTableCell;
		order.material.density = 600.0f;
		order.material.youngsModulus = 2.0e7f;
		order.material.elasticity = pliant::Elasticity::Implicit; // it carries a load
		order.material.damping = 30.0f;
		order.material.rigidStrain = 0.01f;
		order.fracture.rule = pliant::BreakRule::Shards;
		order.fracture.breakStrain = 0.04f;
		order.fracture.shardSize = 0.12f;
		order.fracture.grain[0] = 1.0f;
		order.fracture.grainLength = 3.0f;
		order.fracture.smallCells = kTableCrumb;
		order.fracture.smallPieces = pliant::SmallPieces::Rigid;
		order.toughness.fraction = tableToughness;
		order.friction = btScalar( 0.6 );
		order.colour = kOak;
		order.insideColour = { 0.75f, 0.55f, 0.30f };
		m_table = stage.addSoft( order );
		for ( int k = 0; k < 2; ++k ) // they lie behind the viewer until they are shot
		{
			m_ball[k] = stage.addSphere( kShotSize, btVector3( btScalar( k ), kShotSize / 2, 6 ), kShotMass, kSlate );
			m_ball[k]->setCcdMotionThreshold( kShotSize / 2 );
			m_ball[k]->setCcdSweptSphereRadius( kShotSize / 4 );
		}
		return m_table != nullptr && addLoad( stage );
	}

	void beforeStep( Stage&, double seconds ) override
	{
		if ( m_shots < 2 && seconds >= kShots[m_shots] )
		{
			const btScalar side = m_shots == 0 ? -1 : 1, x = side * btScalar( kTopLength - kLeg ) / 2;
			btRigidBody* const ball = m_ball[m_shots];
			ball->setWorldTransform(
				btTransform( btQuaternion::getIdentity(), btVector3( x - side * btScalar( 0.25 ), kShotHeight, btScalar( 1.6 ) ) ) );
			ball->setLinearVelocity( btVector3( side * btScalar( 0.19 ), btScalar( 0.03 ), -1 ) * kShotSpeed );
			ball->activate();
			++m_shots;
		}
	}

	void afterStep( Stage& stage, double seconds ) override
	{
		ShardScene::afterStep( stage, seconds );
		if ( seconds < kStandsUntil )
		{
			m_lowestBefore = std::min( m_lowestBefore, lowestOfLoad() );
			m_brokenBefore += stage.world().stepReport().brokenLinks;
		}
	}

	Story story( const Stage& stage ) const override
	{
		Story story;
		story.atMost( "broken under its load", m_brokenBefore, 0 );
		story.atLeast( "load stands at, m", m_lowestBefore, double( kTableHeight ) );
		story.atLeast( "pieces", stage.counts().fragments, 3 );
		story.atMost( "highest of table, m", highestOf( *m_table ), 0.9 );
		story.atMost( "load ends at, m", lowestOfLoad(), 0.35 );
		story.atMost( "heavy box ends at, m", double( m_box->getWorldTransform().getOrigin().y() ), 0.45 );
		return story;
	}

	double duration() const override { return 4.0; }
	pliant_glue::DrawCamera camera( double ) const override { return { { 1.3f, 1.35f, 2.6f }, { 0.0f, 0.42f, 0 }, 38.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.45f, 0.75f, 0.50f }, { 0.0f, 0.4f, 0 }, 2.2f }; }

private:
	bool addLoad( Stage& stage )
	{
		const auto at = []( btScalar x, btScalar y, btScalar z ) {
			return btTransform( btQuaternion::getIdentity(), btVector3( x, btScalar( kTableHeight ) + y, z ) );
		};
		m_box = stage.addBox( btVector3( btScalar( 0.3 ), btScalar( 0.2 ), btScalar( 0.3 ) ),
			at( btScalar( -0.35 ), btScalar( 0.1 ), btScalar( 0.1 ) ), kPlateMass, kStone );
		m_upper = stage.addBox( btVector3( btScalar( 0.2 ), btScalar( 0.16 ), btScalar( 0.2 ) ),
			at( btScalar( -0.35 ), btScalar( 0.28 ), btScalar( 0.1 ) ), 3, kBrick );
		const pliant_glue::ModelMesh mesh = makeSphere( 0.3f, 3 );
		SoftOrder order;
		order.name = "jelly";
		order.mesh = &mesh;
		order.cells = 150;
		order.place = at( btScalar( 0.35 ), btScalar( 0.15 ), btScalar( 0.05 ) );
		order.material.density = 500.0f;
		order.material.youngsModulus = 1.5e4f;
		order.friction = btScalar( 0.7 );
		order.colour = kPlum;
		m_jelly = stage.addSoft( order );
		return m_jelly != nullptr;
	}

	/// m, of the centre of the lowest object on the table.
	double lowestOfLoad() const
	{
		return double( std::min(
			{ m_box->getWorldTransform().getOrigin().y(), m_upper->getWorldTransform().getOrigin().y(), m_jelly->massCentre().y() } ) );
	}
	static double highestOf( const pliant::SoftBody& body )
	{
		btScalar high = 0;
		for ( int i = 0; i < body.nodeCount(); ++i )
		{
			high = std::max( high, body.nodePosition( i ).y() );
		}
		return double( high );
	}

	pliant::SoftBody *m_table = nullptr, *m_jelly = nullptr;
	btRigidBody *m_box = nullptr, *m_upper = nullptr, *m_ball[2] = {};
	int m_shots = 0, m_brokenBefore = 0;
	double m_lowestBefore = 10;
};

} // namespace

std::unique_ptr<Scene> makeTable()
{
	return std::make_unique<Table>();
}

} // namespace pliant_demos
