// +-----------------------------------------------------------------------------------------------------------------+
// | slope: soft cubes and a rigid box on a slope of 20 degrees, by friction and by stiffness; their acceleration,     |
// | against theory (docs/design/contacts.md).                                                                         |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace pliant_demos {

namespace {

constexpr double kAngle = 20.0 / 180.0 * SIMD_PI;
constexpr btScalar kSlopeEdge = btScalar( 0.4 );
constexpr int kSlopeCells = 6;
constexpr btScalar kSlopeLength = btScalar( 7 );
constexpr btScalar kThick = btScalar( 0.3 );
constexpr btScalar kSlopeApart = btScalar( 0.62 );
constexpr btScalar kSlopeStart = btScalar( -2.8 ); // along the slope from its middle
constexpr double kFrom = 1.0, kTo = 1.8;           // s, between which the velocity is measured: at first soft cubes still sway
constexpr float kSlopeDensity = 100;               // kg/m^3: at 1000 the softest would be pressed flat

struct Slider
{
	std::string name;
	const btCollisionObject* object = nullptr;
	double friction = 0.0;
	double speedFrom = 0.0, speedTo = 0.0; ///< velocities, m/s, down the slope
};

class Slope : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		stage.addGround( btScalar( 0.8 ) );
		m_slope = btTransform( btQuaternion( btVector3( 0, 0, 1 ), btScalar( -kAngle ) ), btVector3( 0, btScalar( 1.4 ), 0 ) );
		stage.addBox( btVector3( kSlopeLength, kThick, btScalar( 5.4 ) ), m_slope, 0, kStone )->setFriction( 1 );
		addRigid( stage, 0, 0.25 );
		const struct
		{
			double friction;
			float modulus;
			pliant::Elasticity elasticity;
			pliant_glue::Colour colour;
		} orders[] = { { 0.25, 3e3f, pliant::Elasticity::Explicit, kTeal }, { 0.25, 1e5f, pliant::Elasticity::Explicit, kTeal },
			{ 0.25, 3e3f, pliant::Elasticity::Implicit, kPlum }, { 0.25, 1e6f, pliant::Elasticity::Implicit, kPlum },
			{ 0.15, 3e4f, pliant::Elasticity::Explicit, kOchre }, { 0.35, 3e4f, pliant::Elasticity::Implicit, kTerracotta },
			{ 0.38, 3e4f, pliant::Elasticity::Explicit, kTerracotta } };
		int place = 1;
		for ( const auto& order : orders )
		{
			SoftOrder soft;
			const bool isImplicit = order.elasticity == pliant::Elasticity::Implicit;
			soft.name = std::string( isImplicit ? "implicit, " : "explicit, " ) + std::to_string( int( order.modulus / 1000 ) ) + " kPa";
			soft.material.youngsModulus = order.modulus;
			soft.material.density = kSlopeDensity;
			soft.material.elasticity = order.elasticity;
			soft.friction = btScalar( order.friction );
			soft.colour = order.colour;
			if ( !addSoft( stage, place++, soft ) )
			{
				return false;
			}
		}
		return true;
	}

	void afterStep( Stage&, double seconds ) override
	{
		for ( Slider& slider : m_sliders )
		{
			const double speed = speedOf( slider );
			slider.speedFrom = seconds <= kFrom ? speed : slider.speedFrom;
			slider.speedTo = seconds <= kTo ? speed : slider.speedTo;
		}
	}

	std::vector<FindingTable> findings( const Stage& stage ) const override
	{
		FindingTable table;
		table.caption = "Acceleration down a slope of 20 degrees, m/s^2";
		table.columns = { "friction", "measured", "theory", "off, % of g" };
		const double g = double( -stage.world().getGravity().y() );
		for ( const Slider& slider : m_sliders )
		{
			const double got = ( slider.speedTo - slider.speedFrom ) / ( kTo - kFrom );
			const double theory = std::max( 0.0, g * ( std::sin( kAngle ) - slider.friction * std::cos( kAngle ) ) );
			table.rows.push_back( { slider.name, { slider.friction, got, theory, 100.0 * ( got - theory ) / g } } );
		}
		return { table };
	}

	double duration() const override { return 2.2; }
	pliant_glue::DrawCamera camera( double ) const override { return { { 5.2f, 4.6f, 7.0f }, { 0.4f, 1.0f, 0 }, 38.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.4f, 0.8f, 0.45f }, { 0, 1.4f, 0 }, 7.0f }; }

private:
	btTransform placeOf( int lane ) const
	{
		return m_slope *
			btTransform( btQuaternion::getIdentity(),
				btVector3( kSlopeStart, ( kThick + kSlopeEdge ) / 2, kSlopeApart * ( btScalar( 3.5 ) - btScalar( lane ) ) ) );
	}

	void addRigid( Stage& stage, int lane, double friction )
	{
		btRigidBody* box = stage.addBox( btVector3( kSlopeEdge, kSlopeEdge, kSlopeEdge ), placeOf( lane ),
			kSlopeDensity * kSlopeEdge * kSlopeEdge * kSlopeEdge, kSlate );
		box->setFriction( btScalar( friction ) );
		m_sliders.push_back( { "rigid box", box, friction } );
	}

	bool addSoft( Stage& stage, int lane, SoftOrder& order )
	{
		const pliant_glue::ModelMesh cube = makeCube( float( kSlopeEdge ), 12 );
		order.mesh = &cube;
		order.cellSize = float( kSlopeEdge ) / kSlopeCells;
		order.place = placeOf( lane );
		const pliant::SoftBody* body = stage.addSoft( order );
		m_sliders.push_back( { order.name, body, double( order.friction ) } );
		return body != nullptr;
	}

	double speedOf( const Slider& slider ) const
	{
		const pliant::SoftBody* soft = pliant::SoftBody::upcast( slider.object );
		const btVector3 speed = soft ? soft->linearVelocity() : btRigidBody::upcast( slider.object )->getLinearVelocity();
		return double( speed.dot( m_slope.getBasis().getColumn( 0 ) ) );
	}

	btTransform m_slope;
	std::vector<Slider> m_sliders;
};

} // namespace

std::unique_ptr<Scene> makeSlope()
{
	return std::make_unique<Slope>();
}

} // namespace pliant_demos
