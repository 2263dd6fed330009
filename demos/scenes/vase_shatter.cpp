// +-----------------------------------------------------------------------------------------------------------------+
// | vase_shatter: a brittle vase on a plinth, and a rigid ball that flies into it.                                   |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"

#include <algorithm>

namespace pliant_demos {

namespace {

constexpr float kWall = 0.036f;                    // m thick: two cells
constexpr float kCell = 0.018f;
constexpr int kAround = 72;                        // corners of each ring
constexpr btScalar kPlinth = btScalar( 0.35 );     // m high
constexpr btScalar kBall = btScalar( 0.14 );       // m across
constexpr btScalar kBallMass = btScalar( 5 );
constexpr btScalar kSpeed = btScalar( 9 );         // m/s
constexpr btScalar kHitHeight = btScalar( 0.24 );  // m above the foot
constexpr double kHitAt = 0.35;                    // s

/// Outer line from the foot up to the lip: radius and height, m.
const std::vector<std::array<float, 2>>& vaseLine()
{
	static const std::vector<std::array<float, 2>> kLine = { { 0.085f, 0 }, { 0.092f, 0.03f }, { 0.120f, 0.10f }, { 0.152f, 0.18f }, { 0.165f, 0.26f },
		{ 0.150f, 0.34f }, { 0.112f, 0.41f }, { 0.082f, 0.46f }, { 0.080f, 0.50f }, { 0.105f, 0.54f } };
	return kLine;
}

class VaseShatter : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		stage.addGround( btScalar( 0.6 ) );
		stage.addBox( btVector3( btScalar( 0.4 ), kPlinth, btScalar( 0.4 ) ), btTransform( btQuaternion::getIdentity(), btVector3( 0, kPlinth / 2, 0 ) ), 0, kStone );
		const pliant_glue::ModelMesh mesh = makeVessel( vaseLine(), kWall, kCell * 0.7f, kAround );
		SoftOrder order;
		order.name = "vase";
		order.mesh = &mesh;
		order.cellSize = kCell;
		order.place = btTransform( btQuaternion::getIdentity(), btVector3( 0, kPlinth, 0 ) );
		order.material.density = 400.0f;
		order.material.youngsModulus = 3.0e6f; // what is out of reach is made as stiff as the substeps allow
		order.material.damping = 20.0f;
		order.fracture.rule = pliant::BreakRule::Plane;
		order.fracture.breakStrain = 0.012f;
		order.fracture.coolDown = 0.004f; // cracks run on while it is still being hit
		order.friction = btScalar( 0.6 );
		order.colour = kTeal;
		m_vase = stage.addSoft( order );
		// Its way is straight enough: it falls by 6 cm before it hits.
		const btScalar seconds = btScalar( kHitAt );
		const btVector3 start( -btScalar( 0.16 ) - kBall / 2 - kSpeed * seconds, kPlinth + kHitHeight + btScalar( 4.905 ) * seconds * seconds, btScalar( 0.03 ) );
		btRigidBody* ball = stage.addSphere( kBall, start, kBallMass, kBrick );
		ball->setLinearVelocity( btVector3( kSpeed, 0, 0 ) );
		return m_vase != nullptr;
	}

	void afterStep( Stage& stage, double seconds ) override
	{
		const pliant::StepReport& report = stage.world().stepReport();
		m_links += report.brokenLinks;
		m_pieces += report.fragments;
		m_firstCrack = m_firstCrack == 0 && m_links > 0 ? seconds : m_firstCrack;
		m_longestFracture = std::max( m_longestFracture, report.fracture );
		for( const pliant::FractureEvent& event : stage.world().fractureEvents() )
		{
			m_area += event.area;
			m_energy += event.energy;
		}
	}

	std::vector<FindingTable> findings( const Stage& stage ) const override
	{
		double mass = 0;
		for( int i = 0; i < stage.world().softBodyCount(); ++i )
		{
			mass += double( const_cast<pliant::SoftBodyWorld&>( stage.world() ).softBody( i )->mass() );
		}
		return { { "what became of the vase", { "bodies", "broken links", "crack, m^2", "energy, J", "first crack, s", "mass, kg", "worst frame, ms" },
			{ { "vase", { double( m_pieces + 1 ), double( m_links ), m_area, m_energy, m_firstCrack, mass, 1e3 * m_longestFracture } } } } };
	}

	double duration() const override { return 2.2; }
	int slowness() const override { return 2; }
	pliant_glue::DrawCamera camera( double ) const override { return { { 0.95f, 1.05f, 2.5f }, { 0.42f, 0.36f, 0 }, 38.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.45f, 0.75f, 0.50f }, { 0.2f, 0.4f, 0 }, 1.6f }; }

private:
	pliant::SoftBody* m_vase = nullptr;
	int m_links = 0, m_pieces = 0;
	double m_area = 0, m_energy = 0, m_firstCrack = 0, m_longestFracture = 0;
};

} // namespace

std::unique_ptr<Scene> makeVaseShatter()
{
	return std::make_unique<VaseShatter>();
}

} // namespace pliant_demos
