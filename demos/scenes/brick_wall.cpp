// +-----------------------------------------------------------------------------------------------------------------+
// | brick_wall: a heavy box drives through a wall. Its shards are bricks that the scene gives (ShardCentres), each of     |
// | four centres in a row, so that the wall breaks along its joints.                                                    |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"
#include "demos/shard_count.h"

namespace pliant_demos {

namespace {

constexpr float kBrickEdges[3] = { 0.24f, 0.12f, 0.12f }; // m
constexpr int kAlong = 8, kCourses = 9;
constexpr int kParts = 4; // centres a brick
constexpr float kBrickWallCell = 0.06f;
constexpr btScalar kBrickWallSpeed = btScalar( 12 ); // m/s
constexpr btScalar kMass = btScalar( 400 );          // kg
constexpr int kBrickWallCrumb = 4;                   // cells

class BrickWall : public ShardScene
{
public:
	BrickWall() : ShardScene( "wall", kBrickWallCrumb ) {}
	bool init( Stage& stage ) override
	{
		stage.addGround( btScalar( 0.7 ) );
		const std::array<float, 3> edges = { kAlong * kBrickEdges[0], kCourses * kBrickEdges[1], kBrickEdges[2] };
		const pliant_glue::ModelMesh mesh = makeBox( edges, { 2 * kAlong, 2 * kCourses, 2 } );
		SoftOrder order;
		order.name = "wall";
		order.mesh = &mesh;
		order.cellSize = kBrickWallCell;
		order.place.setOrigin( btVector3( 0, btScalar( edges[1] ) / 2, 0 ) );
		order.material.density = 1800.0f;
		order.material.youngsModulus = 2.0e6f;
		order.material.damping = 100.0f;
		order.material.rigidStrain = 0.1f;
		order.friction = btScalar( 0.7 );
		order.colour = kTerracotta;
		order.insideColour = kStone; // mortar
		pliant::SoftBody* const wall = stage.addSoft( order );
		if ( !wall )
		{
			return false;
		}
		pliant::Fracture fracture;
		fracture.rule = pliant::BreakRule::Shards;
		fracture.breakStrain = 0.02f;
		fracture.smallCells = kBrickWallCrumb;
		fracture.smallPieces = pliant::SmallPieces::Rigid;
		const std::vector<float> points = brickCentres( edges );
		const pliant::ShardCentres bricks{ points.data(), int( points.size() / 3 ), m_brick.data() };
		if ( !wall->setFracture( fracture, {}, bricks ).ok() )
		{
			return false;
		}
		btRigidBody* const truck = stage.addBox( btVector3( btScalar( 0.7 ), btScalar( 0.6 ), btScalar( 0.9 ) ),
			btTransform( btQuaternion::getIdentity(), btVector3( btScalar( 0.1 ), btScalar( 0.34 ), btScalar( 1.6 ) ) ), kMass, kSlate );
		truck->setLinearVelocity( btVector3( 0, 0, -kBrickWallSpeed ) );
		return true;
	}

	double duration() const override { return 2.0; }
	int slowness() const override { return 2; }
	pliant_glue::DrawCamera camera( double ) const override { return { { 1.9f, 1.5f, 3.4f }, { 0.0f, 0.5f, -0.3f }, 36.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.45f, 0.75f, 0.50f }, { 0.0f, 0.5f, 0 }, 2.8f }; }

private:
	/// Bricks in a running bond: every other course is shifted by half a brick.
	std::vector<float> brickCentres( const std::array<float, 3>& edges )
	{
		std::vector<float> points;
		for ( int course = 0; course < kCourses; ++course )
		{
			for ( int part = 0; part < kAlong * kParts; ++part )
			{
				const int brick = ( part + ( course % 2 ) * kParts / 2 ) / kParts;
				points.push_back( ( float( part ) + 0.5f ) * kBrickEdges[0] / kParts - 0.5f * edges[0] );
				points.push_back( ( float( course ) + 0.5f ) * kBrickEdges[1] - 0.5f * edges[1] );
				points.push_back( 0.0f );
				m_brick.push_back( course * ( kAlong + 1 ) + brick );
			}
		}
		return points;
	}

	std::vector<int> m_brick; ///< of each centre
};

} // namespace

std::unique_ptr<Scene> makeBrickWall()
{
	return std::make_unique<BrickWall>();
}

} // namespace pliant_demos
