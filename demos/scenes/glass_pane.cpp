// +-----------------------------------------------------------------------------------------------------------------+
// | glass_pane: a steel ball flies through a pane of glass. The shards lie in rings around the point of impact           |
// | (ShardPattern::Rings); those at the edge stay in the frame.                                                          |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"
#include "demos/shard_count.h"

namespace pliant_demos {

namespace {

constexpr float kGlassPaneWidth = 1.2f, kHeight = 0.9f, kGlassPaneThickness = 0.02f; // m
constexpr float kGlassPaneCell = 0.02f;                                              // m
constexpr btScalar kFoot = btScalar( 0.25 );                                         // m, under the pane
constexpr btScalar kFrame = btScalar( 0.06 );                                        // m thick
constexpr btScalar kHold = btScalar( 0.04 );                                         // m of the pane in the frame: two cells
constexpr btScalar kBall = btScalar( 0.09 );                                         // m across
constexpr btScalar kGlassPaneBallMass = btScalar( 3 );                               // kg
constexpr btScalar kGlassPaneSpeed = btScalar( 14 );                                 // m/s
constexpr int kGlassPaneSubsteps = 6;                                                // more are not seen: glass is stiff in any case
constexpr int kGlassPaneCrumb = 6;                                                   // cells

class GlassPane : public ShardScene
{
public:
	GlassPane() : ShardScene( "pane", kGlassPaneCrumb ) {}
	bool init( Stage& stage ) override
	{
		stage.world().setMaxSoftSubsteps( kGlassPaneSubsteps );
		stage.addGround( btScalar( 0.6 ) );
		const btScalar middle = kFoot + btScalar( kHeight ) / 2;
		addFrame( stage, middle );
		const pliant_glue::ModelMesh mesh = makeBox( { kGlassPaneWidth, kHeight, kGlassPaneThickness }, { 60, 45, 1 } );
		SoftOrder order;
		order.name = "pane";
		order.mesh = &mesh;
		order.cellSize = kGlassPaneCell;
		order.place.setOrigin( btVector3( 0, middle, 0 ) );
		order.material.density = 2500.0f;
		order.material.youngsModulus = 8.0e6f;
		order.material.damping = 100.0f;
		order.material.rigidStrain = 0.1f;
		order.fracture.rule = pliant::BreakRule::Shards;
		order.fracture.breakStrain = 0.02f;
		order.fracture.shardSize = 0.09f;
		order.fracture.toughness = 2.0f; // cracks run far beyond the hole of the ball
		order.fracture.shardPattern = pliant::ShardPattern::Rings;
		order.fracture.crumbFraction = 0.03f;
		order.fracture.smallCells = kGlassPaneCrumb;
		order.fracture.smallPieces = pliant::SmallPieces::Rigid;
		order.friction = btScalar( 0.4 );
		order.colour = { 0.25f, 0.55f, 0.50f };
		order.insideColour = { 0.10f, 0.40f, 0.30f };
		pliant::SoftBody* const pane = stage.addSoft( order );
		if ( !pane )
		{
			return false;
		}
		const btScalar half = btScalar( kGlassPaneWidth ) / 2, top = kFoot + btScalar( kHeight );
		pane->pinNodesInside( btVector3( -half - 1, 0, -1 ), btVector3( -half + kHold, 9, 1 ) );
		pane->pinNodesInside( btVector3( half - kHold, 0, -1 ), btVector3( half + 1, 9, 1 ) );
		pane->pinNodesInside( btVector3( -9, 0, -1 ), btVector3( 9, kFoot + kHold, 1 ) );
		pane->pinNodesInside( btVector3( -9, top - kHold, -1 ), btVector3( 9, 9, 1 ) );
		btRigidBody* const ball = stage.addSphere(
			kBall, btVector3( btScalar( -0.15 ), middle + btScalar( 0.06 ), 1 ), kGlassPaneBallMass, kSlate );
		ball->setLinearVelocity( btVector3( 0, 1, -kGlassPaneSpeed ) );
		return true;
	}

	double duration() const override { return 1.5; }
	int slowness() const override { return 4; }
	pliant_glue::DrawCamera camera( double ) const override { return { { 0.9f, 1.05f, 2.4f }, { 0.0f, 0.62f, 0 }, 36.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.45f, 0.75f, 0.50f }, { 0.0f, 0.5f, 0 }, 2.2f }; }

private:
	static void addFrame( Stage& stage, btScalar middle )
	{
		const btScalar across = btScalar( kGlassPaneWidth ) + 2 * kFrame, depth = btScalar( 0.1 );
		const auto at = []( btScalar x, btScalar y ) { return btTransform( btQuaternion::getIdentity(), btVector3( x, y, 0 ) ); };
		const btScalar side = ( btScalar( kGlassPaneWidth ) + kFrame ) / 2, rise = ( btScalar( kHeight ) + kFrame ) / 2;
		stage.addBox( btVector3( across, kFrame, depth ), at( 0, middle - rise ), 0, kOak );
		stage.addBox( btVector3( across, kFrame, depth ), at( 0, middle + rise ), 0, kOak );
		stage.addBox( btVector3( kFrame, btScalar( kHeight ), depth ), at( -side, middle ), 0, kOak );
		stage.addBox( btVector3( kFrame, btScalar( kHeight ), depth ), at( side, middle ), 0, kOak );
	}
};

} // namespace

std::unique_ptr<Scene> makeGlassPane()
{
	return std::make_unique<GlassPane>();
}

} // namespace pliant_demos
