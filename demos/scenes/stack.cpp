// +-----------------------------------------------------------------------------------------------------------------+
// | stack: alternating soft cubes and rigid boxes in several towers; later a ball rolls against one of them.          |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"

namespace pliant_demos {

namespace {

constexpr btScalar kSoftEdge = btScalar( 0.4 );
constexpr btScalar kStackBoxHeight = btScalar( 0.12 );
constexpr btScalar kStackGap = btScalar( 0.02 );
constexpr btScalar kBoxMass = btScalar( 20 ); // about a soft cube's own 26 kg
constexpr double kBallTime = 3.0;

class Stack : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		stage.addGround( btScalar( 0.7 ) );
		return addTower( stage, btScalar( -0.9 ), 3.0e4f, kTeal ) && addTower( stage, 0, 8.0e4f, kTerracotta ) &&
			addTower( stage, btScalar( 0.9 ), 2.0e5f, kPlum );
	}

	void beforeStep( Stage& stage, double seconds ) override
	{
		if ( !m_ballIsOut && seconds >= kBallTime )
		{
			m_ballIsOut = true;
			stage.addSphere( btScalar( 0.24 ), btVector3( -3, btScalar( 0.35 ), btScalar( 0.05 ) ), 3, kOchre )
				->setLinearVelocity( btVector3( 5, btScalar( 1.5 ), 0 ) );
		}
	}

	double duration() const override { return 5.0; }
	pliant_glue::DrawCamera camera( double ) const override { return { { 1.3f, 1.25f, 3.1f }, { 0, 0.53f, 0 }, 36.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.5f, 0.75f, 0.5f }, { 0, 0.6f, 0 }, 3.4f }; }

private:
	/// Two soft cubes with a rigid box on each, with a different stiffness in each tower.
	static bool addTower( Stage& stage, btScalar x, float youngsModulus, const pliant_glue::Colour& colour )
	{
		const pliant_glue::ModelMesh cube = makeCube( float( kSoftEdge ), 12 );
		btScalar y = kStackGap;
		for ( int floor = 0; floor < 2; ++floor )
		{
			SoftOrder order;
			order.name = "cube";
			order.mesh = &cube;
			order.cells = 216;
			order.place = btTransform( btQuaternion::getIdentity(), btVector3( x, y + kSoftEdge / 2, 0 ) );
			order.material.youngsModulus = youngsModulus;
			order.material.density = 400.0f;
			order.friction = btScalar( 0.7 );
			order.colour = colour;
			if ( stage.addSoft( order ) == nullptr )
			{
				return false;
			}
			y += kSoftEdge + kStackGap;
			stage.addBox( btVector3( kSoftEdge, kStackBoxHeight, kSoftEdge ),
				btTransform( btQuaternion::getIdentity(), btVector3( x, y + kStackBoxHeight / 2, 0 ) ), kBoxMass, kSlate );
			y += kStackBoxHeight + kStackGap;
		}
		return true;
	}

	bool m_ballIsOut = false;
};

} // namespace

std::unique_ptr<Scene> makeStack()
{
	return std::make_unique<Stack>();
}

} // namespace pliant_demos
