// +-----------------------------------------------------------------------------------------------------------------+
// | ice_floe: a floe floats on water and carries a crate. An iron ball falls on it: it cracks, its pieces float, the  |
// | crate floats between them, and the ball sinks to the bottom. The library's water acts on soft bodies; an action   |
// | of the scene gives buoyancy to rigid ones.                                                                        |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/must_succeed.h"
#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"
#include "demos/shard_count.h"

#include <algorithm>
#include <cmath>

namespace pliant_demos {

namespace {

constexpr float kIceCell = 0.15f;                                                     // m
constexpr float kFloeLength = 3.3f, kFloeWidth = 2.7f, kFloeThickness = 2 * kIceCell; // m
constexpr float kIceDensity = 850.0f;                                                 // kg/m^3: with air in it
constexpr btScalar kWaterDensity = 1000;                                              // kg/m^3
constexpr btScalar kWaterLevel = btScalar( 1.6 );                                     // m
constexpr btScalar kIron = btScalar( 0.55 ), kIronMass = 320;                         // m, kg: hollow
constexpr double kThrownAt = 2.0;                                                     // s
constexpr btScalar kFall = btScalar( 3 );                                             // m, over the water
constexpr btScalar kCrateSize = btScalar( 0.4 ), kCrateMass = 30;                     // m, kg
constexpr int kIceCrumb = 3;                                                          // cells

/// Buoyancy and drag of rigid bodies, at the centres of equal parts of each.
class RigidBuoyancy : public btActionInterface
{
public:
	/// `volume`: m^3, spread evenly over the box `size` around the body's middle.
	void add( btRigidBody* body, const btVector3& size, btScalar volume ) { m_floaters.push_back( { body, size, volume } ); }

	/// Impulses, because Bullet runs actions at the end of a step and would clear forces before the next one.
	void updateAction( btCollisionWorld*, btScalar step ) override
	{
		for ( const Floater& floater : m_floaters )
		{
			for ( int part = 0; part < kParts * kParts * kParts; ++part )
			{
				push( floater, part, step );
			}
		}
	}
	void debugDraw( btIDebugDraw* ) override {}

private:
	static constexpr int kParts = 4;                   ///< along each axis
	static constexpr btScalar kDrag = btScalar( 1.5 ); ///< 1/s, of the displaced water
	struct Floater
	{
		btRigidBody* body;
		btVector3 size;
		btScalar volume;
	};

	static void push( const Floater& floater, int part, btScalar step )
	{
		const btVector3 cell = floater.size / kParts;
		const btVector3 index( btScalar( part % kParts ), btScalar( part / kParts % kParts ), btScalar( part / ( kParts * kParts ) ) );
		const btVector3 at = floater.body->getWorldTransform().getBasis() *
			( ( index + btVector3( 1, 1, 1 ) / 2 ) * cell - floater.size / 2 );
		const btScalar depth = kWaterLevel - floater.body->getWorldTransform().getOrigin().y() - at.y();
		const btScalar submerged = btClamped( depth / cell.y() + btScalar( 0.5 ), btScalar( 0 ), btScalar( 1 ) );
		const btScalar mass = submerged * kWaterDensity * floater.volume / btScalar( kParts * kParts * kParts );
		const btVector3 drag = floater.body->getVelocityInLocalPoint( at ) * -kDrag;
		floater.body->applyImpulse( step * mass * ( drag - floater.body->getGravity() ), at );
	}

	std::vector<Floater> m_floaters;
};

/// A slab with a wavy outline.
pliant_glue::ModelMesh makeFloe()
{
	pliant_glue::ModelMesh mesh = makeBox( { 2, kFloeThickness, 2 }, { 22, 2, 18 } );
	for ( std::size_t v = 0; v < mesh.vertexCount(); ++v )
	{
		float &x = mesh.positions[3 * v], &z = mesh.positions[3 * v + 2];
		const float angle = std::atan2( z, x ), wave = 0.92f + 0.05f * std::sin( 3 * angle + 0.5f ) + 0.03f * std::sin( 7 * angle );
		const float disc = std::max( std::abs( x ), std::abs( z ) ) / std::max( 1e-6f, std::hypot( x, z ) ); // from the square to the disc
		const float scale = wave * ( 0.35f + 0.65f * disc ) * 1.08f;
		x *= scale * kFloeLength / 2;
		z *= scale * kFloeWidth / 2;
	}
	mesh.name = "floe";
	return mesh;
}

class IceFloe : public ShardScene
{
public:
	IceFloe() : ShardScene( "floe", kIceCrumb ) {}
	bool init( Stage& stage ) override
	{
		m_stage = &stage;
		stage.addGround( btScalar( 0.6 ) );
		pliant::WaterSettings water;
		water.surface.setY( kWaterLevel );
		water.density = kWaterDensity;
		mustSucceed( m_water.set( water ) );
		mustSucceed( stage.world().addForceField( m_water ) );
		stage.world().addAction( &m_rigidWater );
		const pliant_glue::ModelMesh mesh = makeFloe();
		SoftOrder order;
		order.name = "floe";
		order.mesh = &mesh;
		order.cellSize = kIceCell;
		order.place.setOrigin( btVector3( 0, kWaterLevel - btScalar( ( kIceDensity / 1000.0f - 0.5f ) * kFloeThickness ), 0 ) );
		order.material.density = kIceDensity;
		order.material.youngsModulus = 5.0e6f;
		order.material.damping = 40.0f;
		order.fracture.rule = pliant::BreakRule::Shards;
		order.fracture.breakStrain = 0.005f;
		order.fracture.shardSize = 0.55f;
		order.fracture.crumbFraction = 0.03f;
		order.fracture.smallCells = kIceCrumb;
		order.fracture.smallPieces = pliant::SmallPieces::Rigid;
		order.friction = btScalar( 0.3 );
		order.colour = { 0.72f, 0.80f, 0.84f };
		order.insideColour = { 0.30f, 0.58f, 0.70f };
		m_floe = stage.addSoft( order );
		if ( m_floe == nullptr )
		{
			return false;
		}
		const btScalar top = m_floe->massCentre().y() + btScalar( kFloeThickness ) / 2;
		const btVector3 crate( kCrateSize, kCrateSize, kCrateSize );
		m_crate = stage.addBox( crate,
			btTransform( btQuaternion::getIdentity(), btVector3( btScalar( 0.55 ), top + kCrateSize / 2, btScalar( 0.35 ) ) ), kCrateMass,
			kOak );
		m_crate->setActivationState( DISABLE_DEACTIVATION ); // the scene's water does not wake bodies
		m_rigidWater.add( m_crate, crate, crate.x() * crate.y() * crate.z() );
		m_ball = stage.addSphere( kIron, btVector3( btScalar( -0.3 ), kWaterLevel + kFall, btScalar( -0.1 ) ), kIronMass, kSlate );
		m_ball->setGravity( btVector3( 0, 0, 0 ) ); // it hangs
		m_ball->setActivationState( DISABLE_DEACTIVATION );
		m_rigidWater.add( m_ball, btVector3( kIron, kIron, kIron ), kIron * kIron * kIron * SIMD_PI / 6 );
		return true;
	}
	~IceFloe() override
	{
		if ( m_stage != nullptr )
		{
			m_stage->world().removeAction( &m_rigidWater );
		}
	}

	void beforeStep( Stage& stage, double seconds ) override
	{
		if ( !m_falls && seconds >= kThrownAt )
		{
			m_falls = true;
			m_ball->setGravity( stage.world().getGravity() );
		}
	}

	std::any ownState() const override { return m_ball->getGravity(); }
	void restoreOwnState( const std::any& state ) override { m_ball->setGravity( std::any_cast<const btVector3&>( state ) ); }

	void afterStep( Stage& stage, double seconds ) override
	{
		ShardScene::afterStep( stage, seconds );
		if ( seconds < kThrownAt )
		{
			m_brokenBefore += stage.world().stepReport().brokenLinks;
			m_heightBefore = double( m_floe->massCentre().y() - kWaterLevel );
		}
	}

	void beforePicture( Stage&, pliant_glue::DrawList& list ) override
	{
		constexpr float kSea = 30.0f;
		list.boxes.push_back( { { kSea, 0, 0 }, { 0, float( kWaterLevel ), 0 }, { 0, 0, kSea }, { 0, float( kWaterLevel ) / 2, 0 },
			{ 0.02f, 0.10f, 0.16f } } );
		if ( !m_falls )
		{
			const btVector3& at = m_ball->getWorldTransform().getOrigin();
			list.lines.push_back(
				{ { float( at.x() ), float( at.y() ), float( at.z() ) }, { float( at.x() ), 20, float( at.z() ) }, kStone } );
		}
	}

	Story story( const Stage& stage ) const override
	{
		double mass = 0, afloat = 0;
		for ( int i = 0; i < stage.world().softBodyCount(); ++i )
		{
			const pliant::SoftBody& piece = *stage.world().softBody( i );
			const double height = double( piece.massCentre().y() - kWaterLevel );
			mass += double( piece.mass() );
			afloat += height > -2 * double( kFloeThickness ) ? double( piece.mass() ) : 0;
		}
		const double draught = -( double( kIceDensity ) / double( kWaterDensity ) - 0.5 ) * double( kFloeThickness ),
					 sunk = double( kCrateMass ) / ( double( kWaterDensity ) * mass / double( kIceDensity ) / double( kFloeThickness ) );
		Story story;
		story.atMost( "broken under the crate", m_brokenBefore, 0 );
		story.atMost( "floats aside by, m", std::abs( m_heightBefore - ( draught - sunk ) ), 0.02 );
		story.atLeast( "pieces", stage.counts().fragments, 4 );
		story.atMost( "pieces, at most", stage.counts().fragments, 80 );
		story.atLeast( "ice afloat", afloat / mass, 0.97 );
		story.atMost( "ball ends at, m", double( m_ball->getWorldTransform().getOrigin().y() ), 0.4 );
		story.atLeast( "crate ends at, m", double( m_crate->getWorldTransform().getOrigin().y() - kWaterLevel ), -0.2 );
		return story;
	}

	double duration() const override { return 8.0; }
	pliant_glue::DrawCamera camera( double ) const override { return { { 2.1f, 4.2f, 4.5f }, { 0.1f, 1.5f, 0.1f }, 40.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.45f, 0.75f, 0.40f }, { 0.0f, 1.6f, 0 }, 3.6f }; }

private:
	pliant::Water m_water;
	RigidBuoyancy m_rigidWater;
	Stage* m_stage = nullptr;
	pliant::SoftBody* m_floe = nullptr;
	btRigidBody *m_crate = nullptr, *m_ball = nullptr;
	bool m_falls = false;
	int m_brokenBefore = 0;
	double m_heightBefore = 0;
};

} // namespace

std::unique_ptr<Scene> makeIceFloe()
{
	return std::make_unique<IceFloe>();
}

} // namespace pliant_demos
