// +-----------------------------------------------------------------------------------------------------------------+
// | hand: Steinemann et al. 2008, figure 4. One hand, its little finger soft and its thumb hard; the same force pulls |
// | at the tip of every finger. A second hand of uniform stiffness is not drawn: the ratio of the two deflections is  |
// | the effect of the stiffness alone.                                                                                |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/creatures.h"
#include "demos/must_succeed.h"
#include "demos/palette.h"
#include "demos/scene.h"

#include <algorithm>
#include <cmath>

namespace pliant_demos {

namespace {

constexpr int kHandCells = 4000;
constexpr int kHandCoarseLevels = 2;
constexpr float kHandKeepMass = 0.95f;         // full blocks only: a coarse node across a finger would mix its stiffness with the palm's
constexpr btScalar kHeldTo = btScalar( 0.30 ); // m: wrist and palm are held, so that only the fingers deform
constexpr btScalar kThumbSide = btScalar( -0.12 );
constexpr btScalar kHandPull = btScalar( 0.6 );                        // N at each tip
constexpr btScalar kHandGrip = btScalar( 0.07 );                       // m around a tip that is pulled
constexpr double kPullFrom = 0.4, kPullFullAt = 1.0, kPullUntil = 2.4; // s
constexpr float kYoungsModulus = 8.0e4f; // Pa, of the thumb; the rest has a fraction of it. About the reach of 16 substeps
constexpr float kPalmFraction = 0.8f;
constexpr float kDigitFraction[] = { 1.0f, 0.8f, 0.8f, 0.8f, 0.15f };
constexpr const char* kDigitNames[] = { "thumb", "index finger", "middle finger", "ring finger", "little finger" };

/// From the palm's stiffness at a digit's root to the digit's own a radius further on.
float stiffnessAt( const float* point, void* )
{
	const DigitFraction at = digitAt( point );
	return kPalmFraction + ( kDigitFraction[at.digit] - kPalmFraction ) * at.fraction;
}

/// Soft is plum, the palm ochre, hard slate.
pliant_glue::Colour colourOf( float stiffness )
{
	const auto tone = []( float fraction ) {
		return std::log( fraction / kDigitFraction[4] ) / std::log( kDigitFraction[0] / kDigitFraction[4] );
	};
	const float t = std::clamp( tone( stiffness ), 0.0f, 1.0f ), palmTone = tone( kPalmFraction );
	pliant_glue::Colour colour;
	for ( std::size_t k = 0; k < 3; ++k )
	{
		const float middle = kOchre[k], end = t < palmTone ? kPlum[k] : kSlate[k];
		const float away = t < palmTone ? ( palmTone - t ) / palmTone : ( t - palmTone ) / ( 1 - palmTone );
		colour[k] = middle + ( end - middle ) * away;
	}
	return colour;
}

class Hand : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		const pliant_glue::ModelMesh mesh = makeHand();
		SoftOrder order;
		order.name = "hand";
		order.mesh = &mesh;
		order.cells = kHandCells;
		order.adaptivity.coarseLevels = kHandCoarseLevels;
		order.adaptivity.keepMass = kHandKeepMass;
		order.material.density = 300.0f;
		order.material.youngsModulus = kYoungsModulus;
		order.stiffness.fraction = stiffnessAt;
		order.material.damping = 10.0f;
		order.colour = kOchre;
		order.shape = stage.buildShape( order );
		if ( order.shape == nullptr )
		{
			return false;
		}
		m_beside = std::make_unique<Stage>( stage.options(), "one stiffness" );
		m_beside->hide();
		stage.setName( "soft and hard" );
		if ( !take( stage, order, m_hand ) )
		{
			return false;
		}
		stage.addGround( btScalar( 0.5 ) );
		std::vector<float> colours;
		for ( std::size_t i = 0; i < mesh.positions.size(); i += 3 )
		{
			const pliant_glue::Colour colour = colourOf( stiffnessAt( &mesh.positions[i], nullptr ) );
			colours.insert( colours.end(), colour.begin(), colour.end() );
		}
		stage.colourVertices( m_hand.body, std::move( colours ) );
		order.stiffness.fraction = []( const float*, void* ) { return kPalmFraction; };
		return take( *m_beside, order, m_plain );
	}

	std::vector<Stage*> sideStages() override { return { m_beside.get() }; }

	void beforeStep( Stage&, double seconds ) override
	{
		m_pull = seconds < kPullFrom || seconds > kPullUntil
			? btScalar( 0 )
			: kHandPull * btScalar( std::min( 1.0, ( seconds - kPullFrom ) / ( kPullFullAt - kPullFrom ) ) );
		for ( const Held* hand : { &m_hand, &m_plain } )
		{
			for ( const Tip& tip : hand->tips )
			{
				for ( const int node : tip.nodes )
				{
					mustSucceed( hand->body->applyForce( btVector3( 0, 0, m_pull * hand->body->nodeMass( node ) / tip.mass ), node ) );
				}
			}
		}
	}

	void afterStep( Stage& stage, double seconds ) override
	{
		stage.skin();
		m_beside->skin();
		for ( Held* hand : { &m_hand, &m_plain } )
		{
			for ( Tip& tip : hand->tips )
			{
				if ( seconds <= kPullFrom )
				{
					tip.rest = placeOf( *hand, tip );
				}
				if ( seconds <= kPullUntil )
				{
					tip.deflection = double(
						( placeOf( *hand, tip ) - tip.rest ).length() ); // the last value is the one under the constant pull
				}
			}
		}
	}

	/// The pull as a rod at each tip.
	void beforePicture( Stage&, pliant_glue::DrawList& list ) override
	{
		const float length = 0.25f * float( m_pull / kHandPull ), thickness = 0.012f;
		for ( std::size_t i = 0; m_pull > 0 && i < m_hand.tips.size(); ++i )
		{
			const btVector3 at = placeOf( m_hand, m_hand.tips[i] );
			list.boxes.push_back( { { thickness, 0, 0 }, { 0, thickness, 0 }, { 0, 0, length },
				{ float( at.x() ), float( at.y() ), float( at.z() ) + length / 2 }, kBrick } );
		}
	}

	std::vector<FindingTable> findings( const Stage& ) const override
	{
		// Less than the stiffness of a single finger predicts: all of them are attached to the palm, which deforms, and have their own
		// stiffness only from a radius beyond it on.
		FindingTable table{
			"the same pull at every tip, held, m", { "deflection", "of the thumb's", "one stiffness", "ratio", "stiffness says" }, {} };
		for ( std::size_t i = 0; i < m_hand.tips.size(); ++i )
		{
			const double here = m_hand.tips[i].deflection, plain = m_plain.tips[i].deflection;
			table.rows.push_back( { kDigitNames[i],
				{ here, here / m_hand.tips[0].deflection, plain, here / plain, double( kPalmFraction / kDigitFraction[i] ) } } );
		}
		return { table };
	}

	double duration() const override { return 4.0; }
	pliant_glue::DrawCamera camera( double ) const override { return { { -1.35f, 0.80f, 1.75f }, { -0.03f, 0.40f, 0.08f }, 28.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.15f, 0.75f, 0.65f }, { 0, 0.4f, 0 }, 1.6f }; }

private:
	struct Tip
	{
		std::vector<int> nodes;
		btScalar mass = 0;
		int vertex = 0;
		btVector3 rest = btVector3( 0, 0, 0 );
		double deflection = 0;
	};

	struct Held
	{
		pliant::SoftBody* body = nullptr;
		std::vector<Tip> tips = {};
	};

	/// A hand that is held, and its tips.
	static bool take( Stage& stage, const SoftOrder& order, Held& hand )
	{
		hand.body = stage.addSoft( order );
		if ( hand.body == nullptr )
		{
			return false;
		}
		mustSucceed( hand.body->setGravity( btVector3(
			0, 0, 0 ) ) ); // upright fingers this soft are close to buckling under their weight, which would hide their stiffness
		hand.body->pinNodesInside( btVector3( kThumbSide, -1, -1 ), btVector3( 1, kHeldTo, 1 ) );
		for ( const Digit& digit : handDigits() )
		{
			hand.tips.push_back( tipOf( *hand.body, digit ) );
		}
		return true;
	}

	static Tip tipOf( const pliant::SoftBody& body, const Digit& digit )
	{
		const btVector3 place( digit.tip[0], digit.tip[1], digit.tip[2] );
		Tip tip;
		for ( int i = 0; i < body.nodeCount(); ++i )
		{
			if ( body.nodePosition( i ).distance( place ) < kHandGrip )
			{
				tip.nodes.push_back( i );
				tip.mass += body.nodeMass( i );
			}
		}
		const pliant::SurfaceView skin = body.surface();
		btScalar nearest = BT_LARGE_FLOAT;
		for ( int i = 0; i < skin.vertexCount; ++i )
		{
			const btScalar away = vertexAt( skin, i ).distance( place + btVector3( 0, 0, btScalar( digit.radius ) ) );
			if ( away < nearest )
			{
				nearest = away;
				tip.vertex = i;
			}
		}
		return tip;
	}

	static btVector3 vertexAt( const pliant::SurfaceView& skin, int i )
	{
		const float* p = skin.positions + std::size_t( i ) * 3;
		return skin.origin + btVector3( btScalar( p[0] ), btScalar( p[1] ), btScalar( p[2] ) );
	}

	static btVector3 placeOf( const Held& hand, const Tip& tip ) { return vertexAt( hand.body->surface(), tip.vertex ); }

	std::unique_ptr<Stage> m_beside;
	Held m_hand, m_plain;
	btScalar m_pull = 0;
};

} // namespace

std::unique_ptr<Scene> makeHandScene()
{
	return std::make_unique<Hand>();
}

} // namespace pliant_demos
