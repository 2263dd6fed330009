// +-----------------------------------------------------------------------------------------------------------------+
// | bullet_hit: a ball at 60 m/s hits a soft block, another sinks into foam and rebounds, and a soft ball at 60 m/s |
// | meets a wall of a millimetre; slowed down in the film. The momentum that each passed on and kept:               |
// | docs/design/contacts.md.                                                                                        |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/must_succeed.h"
#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"

#include <algorithm>

namespace pliant_demos {

namespace {

constexpr btScalar kLane = btScalar( 1.3 );
constexpr btScalar kSpeed = btScalar( 60 );
constexpr btScalar kBulletHitStart = btScalar( -4.1 );
constexpr btScalar kBulletHitHeight = btScalar( 0.6 );
constexpr btScalar kWallX = btScalar( 0.6 );
constexpr btScalar kWallThick = btScalar( 1e-3 );

class BulletHit : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		stage.addGround( btScalar( 0.7 ) );
		const pliant_glue::ModelMesh cube = makeCube( 0.8f, 16 ), ball = makeSphere( 0.5f, 4 );
		SoftOrder block;
		block.name = "block";
		block.mesh = &cube;
		block.cells = 512;
		block.material.youngsModulus = 2.0e5f;
		block.place = btTransform( btQuaternion::getIdentity(), btVector3( 0, btScalar( 0.4 ), -kLane ) );
		block.colour = kTeal;
		m_block = stage.addSoft( block );

		SoftOrder foam = block;
		foam.name = "foam";
		foam.material.youngsModulus = 4.0e4f;
		foam.material.density = 60.0f;
		foam.material.damping = 300.0f;
		foam.material.wobbleDamping = 1.0f;
		foam.place.setOrigin( btVector3( 0, btScalar( 0.4 ), 0 ) );
		foam.colour = kPlum;
		m_foam = stage.addSoft( foam );

		SoftOrder flying;
		flying.name = "soft ball";
		flying.mesh = &ball;
		flying.cells = 500;
		flying.material.youngsModulus = 6.0e4f;
		flying.place = btTransform( btQuaternion::getIdentity(), btVector3( kBulletHitStart, kBulletHitHeight, kLane ) );
		flying.colour = kTerracotta;
		m_softBall = stage.addSoft( flying );
		if ( !m_block || !m_foam || !m_softBall )
		{
			return false;
		}
		mustSucceed( m_softBall->setVelocities( btVector3( kSpeed, 1, 0 ), btVector3( 0, 5, -10 ) ) );
		stage.addBox( btVector3( kWallThick, btScalar( 1.4 ), btScalar( 1.2 ) ), at( kWallX, btScalar( 0.7 ), kLane ), 0, kSlate )
			->setRestitution( btScalar( 0.4 ) );

		m_ball = addShot( stage, -kLane, 6, kSlate );
		m_slow = addShot( stage, 0, 1, kOchre );
		m_momentum = double( kSpeed ) / double( m_ball->getInvMass() );
		return true;
	}

	void afterStep( Stage&, double ) override
	{
		m_deepest = std::max( m_deepest, double( m_slow->getWorldTransform().getOrigin().x() - m_foam->massCentre().x() ) + 0.4 );
		for ( int i = 0; i < m_softBall->nodeCount(); ++i )
		{
			m_farthest = std::max( m_farthest, double( m_softBall->nodePosition( i ).x() - kWallX ) );
		}
		m_given = std::max( m_given, double( m_block->linearVelocity().x() * m_block->mass() ) / m_momentum );
	}

	std::vector<FindingTable> findings( const Stage& ) const override
	{
		FindingTable table;
		table.caption = "Balls of 60 m/s";
		table.columns = { "measured" };
		table.rows.push_back( { "momentum that went over to the block, of the ball's", { m_given } } );
		table.rows.push_back( { "how deep the ball goes into the foam of 0.8 m, m", { m_deepest } } );
		table.rows.push_back( { "the ball's speed against the foam at the end, m/s",
			{ double( ( m_slow->getLinearVelocity() - m_foam->linearVelocity() ).length() ) } } );
		table.rows.push_back( { "farthest node of the soft ball, m in front of (-) or behind the thin wall's middle", { m_farthest } } );
		return { table };
	}

	double duration() const override { return 1.5; }
	int slowness() const override { return 4; }
	pliant_glue::DrawCamera camera( double ) const override { return { { -2.6f, 2.7f, 4.9f }, { -0.6f, 0.4f, 0 }, 40.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.5f, 0.75f, 0.5f }, { -0.5f, 0.6f, 0 }, 4.5f }; }

private:
	static btTransform at( btScalar x, btScalar y, btScalar z ) { return btTransform( btQuaternion::getIdentity(), btVector3( x, y, z ) ); }

	static btRigidBody* addShot( Stage& stage, btScalar z, btScalar mass, const pliant_glue::Colour& colour )
	{
		btRigidBody* ball = stage.addSphere( btScalar( 0.24 ), btVector3( kBulletHitStart, btScalar( 0.45 ), z ), mass, colour );
		ball->setLinearVelocity( btVector3( kSpeed, 0, 0 ) );
		return ball;
	}

	pliant::SoftBody *m_block = nullptr, *m_foam = nullptr, *m_softBall = nullptr;
	btRigidBody *m_ball = nullptr, *m_slow = nullptr;
	double m_momentum = 1.0, m_given = 0.0, m_deepest = 0.0, m_farthest = -1e9;
};

} // namespace

std::unique_ptr<Scene> makeBulletHit()
{
	return std::make_unique<BulletHit>();
}

} // namespace pliant_demos
