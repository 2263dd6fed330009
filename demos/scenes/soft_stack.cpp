// +-----------------------------------------------------------------------------------------------------------------+
// | soft_stack: two, four and eight soft cubes on each other, and four with rigid boxes between them, at one step of  |
// | 1/60 s a frame; the time at which each tower sleeps, and its lean (docs/design/implicit.md).                      |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"

#include <cmath>
#include <string>

namespace pliant_demos {

namespace {

constexpr btScalar kSoftStackEdge = btScalar( 0.4 );
constexpr int kSoftStackCells = 6;
constexpr btScalar kSoftStackBoxHeight = btScalar( 0.12 );
constexpr btScalar kSoftStackGap = btScalar( 0.005 );
constexpr btScalar kSoftStackApart = btScalar( 0.9 );
constexpr float kModulus =
	4.0e6f; // Pa; at a quarter of it eight cubes are higher than Euler's limit for a column under its own weight, 2.2 m

struct Tower
{
	std::string name;
	btScalar x = btScalar( 0 );
	double height = 0.0; ///< initial height of the top cube's centre, m
	std::vector<pliant::SoftBody*> cubes = {};
	double sleepsAt = -1.0; ///< s; -1: never
};

class SoftStack : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		stage.addGround( btScalar( 0.8 ) );
		return addTower( stage, { "2 soft cubes", btScalar( -1.5 ) * kSoftStackApart }, 2, false, kTeal ) &&
			addTower( stage, { "4 soft cubes", btScalar( -0.5 ) * kSoftStackApart }, 4, false, kOchre ) &&
			addTower( stage, { "8 soft cubes", btScalar( 0.5 ) * kSoftStackApart }, 8, false, kTerracotta ) &&
			addTower( stage, { "4 soft cubes, boxes between", btScalar( 1.5 ) * kSoftStackApart }, 4, true, kPlum );
	}

	void afterStep( Stage&, double seconds ) override
	{
		for ( Tower& tower : m_towers )
		{
			const bool sleeps = !tower.cubes.back()->isActive();
			tower.sleepsAt = !sleeps ? -1.0 : tower.sleepsAt < 0.0 ? seconds : tower.sleepsAt;
		}
	}

	std::vector<FindingTable> findings( const Stage& ) const override
	{
		FindingTable table;
		table.caption = "Towers of soft cubes; a sleeping time of -1: it does not sleep yet";
		table.columns = { "top's height, m", "sunk, m", "aside, m", "sleeps at, s" };
		for ( const Tower& tower : m_towers )
		{
			const btVector3 top = tower.cubes.back()->massCentre();
			const double aside = std::hypot( double( top.x() - tower.x ), double( top.z() ) );
			table.rows.push_back( { tower.name, { double( top.y() ), tower.height - double( top.y() ), aside, tower.sleepsAt } } );
		}
		return { table };
	}

	double duration() const override { return 5.0; }
	pliant_glue::DrawCamera camera( double ) const override { return { { 1.6f, 2.3f, 6.4f }, { 0, 1.45f, 0 }, 36.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.5f, 0.75f, 0.5f }, { 0, 1.4f, 0 }, 4.5f }; }

private:
	bool addTower( Stage& stage, Tower tower, int count, bool hasBoxes, const pliant_glue::Colour& colour )
	{
		const pliant_glue::ModelMesh cube = makeCube( float( kSoftStackEdge ), 12 );
		btScalar y = kSoftStackGap;
		for ( int k = 0; k < count; ++k )
		{
			// Not quite straight: offset by a hundredth of the edge to alternating sides.
			const btScalar aside = ( k % 2 == 0 ? 1 : -1 ) * kSoftStackEdge / 100;
			SoftOrder order;
			order.name = tower.name;
			order.mesh = &cube;
			order.cellSize = float( kSoftStackEdge ) / kSoftStackCells;
			order.place = btTransform( btQuaternion::getIdentity(), btVector3( tower.x + aside, y + kSoftStackEdge / 2, aside ) );
			order.material.youngsModulus = kModulus;
			order.material.elasticity = pliant::Elasticity::Implicit;
			order.friction = btScalar( 0.8 );
			order.colour = colour;
			tower.height = double( y + kSoftStackEdge / 2 );
			tower.cubes.push_back( stage.addSoft( order ) );
			if ( tower.cubes.back() == nullptr )
			{
				return false;
			}
			y += kSoftStackEdge + kSoftStackGap;
			if ( hasBoxes )
			{
				const btVector3 size( kSoftStackEdge, kSoftStackBoxHeight, kSoftStackEdge ),
					place( tower.x, y + kSoftStackBoxHeight / 2, 0 );
				stage.addBox( size, btTransform( btQuaternion::getIdentity(), place ), tower.cubes.back()->mass(), kSlate );
				y += kSoftStackBoxHeight + kSoftStackGap;
			}
		}
		m_towers.push_back( tower );
		return true;
	}

	std::vector<Tower> m_towers;
};

} // namespace

std::unique_ptr<Scene> makeSoftStack()
{
	return std::make_unique<SoftStack>();
}

} // namespace pliant_demos
