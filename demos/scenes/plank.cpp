// +-----------------------------------------------------------------------------------------------------------------+
// | plank: a plank of wood lies on an edge, and its ends are pressed down until it breaks. Its shards are long in the     |
// | direction of the grain (Fracture::grain), and links across the grain are weaker (ToughnessField): it splinters.     |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"
#include "demos/shard_count.h"

#include <algorithm>

namespace pliant_demos {

namespace {

constexpr float kLength = 1.4f, kPlankThickness = 0.08f, kPlankWidth = 0.2f; // m
constexpr float kPlankCell = 0.02f;                                          // m
constexpr btScalar kEdge = btScalar( 0.5 );                                  // m, height of the edge
constexpr btScalar kPlankRate = btScalar( 0.3 );                             // m/s, of the ends
constexpr btScalar kMostDown = btScalar( 0.38 );                             // m
constexpr btScalar kGap = btScalar( 0.03 );                                  // m, from the hands to the plank at first
constexpr int kPlankCrumb = 4;                                               // cells

float woodToughness( const float*, const float* direction, void* )
{
	const float along = direction[0] * direction[0];
	return 0.4f + 0.6f * along; // wood splits along its grain
}

class Plank : public ShardScene
{
public:
	Plank() : ShardScene( "plank", kPlankCrumb ) {}
	bool init( Stage& stage ) override
	{
		stage.addGround( btScalar( 0.6 ) );
		const pliant_glue::ModelMesh mesh = makeBox( { kLength, kPlankThickness, kPlankWidth }, { 70, 4, 10 } );
		SoftOrder order;
		order.name = "plank";
		order.mesh = &mesh;
		order.cellSize = kPlankCell;
		order.place.setOrigin( btVector3( 0, kEdge + btScalar( kPlankThickness ) / 2, 0 ) );
		order.material.density = 600.0f;
		order.material.youngsModulus = 2.0e7f;
		order.material.elasticity = pliant::Elasticity::Implicit; // it is bent slowly
		order.material.damping = 30.0f;
		order.fracture.rule = pliant::BreakRule::Shards;
		order.fracture.breakStrain = 0.02f;
		order.fracture.shardSize = 0.06f;
		order.fracture.grain[0] = 1.0f;
		order.fracture.grainLength = 4.0f;
		order.fracture.toughness = 8.0f;
		order.fracture.smallCells = kPlankCrumb;
		order.fracture.smallPieces = pliant::SmallPieces::Rigid;
		order.toughness.fraction = woodToughness;
		order.friction = btScalar( 0.6 );
		order.colour = kOak;
		order.insideColour = { 0.75f, 0.55f, 0.30f };
		if ( !stage.addSoft( order ) )
		{
			return false;
		}
		stage.addBox( btVector3( btScalar( 0.08 ), kEdge, btScalar( 0.5 ) ),
			btTransform( btQuaternion::getIdentity(), btVector3( 0, kEdge / 2, 0 ) ), 0, kStone );
		for ( int side = 0; side < 2; ++side )
		{
			m_hand[side] = stage.addBox( kHand, handPlace( side ), 0, kBrick );
		}
		return true;
	}

	void beforeStep( Stage&, double ) override
	{
		m_down = std::min( m_down + kPlankRate / 60, kMostDown );
		for ( int side = 0; side < 2; ++side )
		{
			Stage::moveBody( m_hand[side], handPlace( side ) );
		}
	}

	double duration() const override { return 2.0; }
	int slowness() const override { return 2; }
	pliant_glue::DrawCamera camera( double ) const override { return { { 0.7f, 1.05f, 1.7f }, { 0.0f, 0.42f, 0 }, 38.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.45f, 0.75f, 0.50f }, { 0.0f, 0.4f, 0 }, 2.0f }; }

private:
	btTransform handPlace( int side ) const
	{
		const btScalar x = ( btScalar( kLength ) / 2 - btScalar( 0.08 ) ) * btScalar( side == 0 ? -1 : 1 );
		return btTransform(
			btQuaternion::getIdentity(), btVector3( x, kEdge + btScalar( kPlankThickness ) + kHand.y() / 2 + kGap - m_down, 0 ) );
	}

	const btVector3 kHand = btVector3( btScalar( 0.06 ), btScalar( 0.06 ), btScalar( 0.3 ) );
	btRigidBody* m_hand[2] = {};
	btScalar m_down = 0;
};

} // namespace

std::unique_ptr<Scene> makePlank()
{
	return std::make_unique<Plank>();
}

} // namespace pliant_demos
