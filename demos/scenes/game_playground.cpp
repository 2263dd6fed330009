// +-----------------------------------------------------------------------------------------------------------------+
// | game_playground: a small level of a game. A character walks over soft ground, jumps onto a soft crate and pushes  |
// | a soft block onto a plate, which opens a gate and starts a fan; it leaves through a door with a soft panel. A car |
// | drives through the gate, over a soft hump, tears a soft ball off its chain, and breaks a wall and the boxes       |
// | behind it. All this follows a script; in a window the first key starts manual control.                            |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/actors.h"
#include "demos/palette.h"
#include "demos/playground_level.h"
#include "demos/scene.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pliant_demos {

namespace {

constexpr btScalar kWalkSpeed = btScalar( 1.8 ), kJumpSpeed = btScalar( 4.5 ); // m/s
constexpr btScalar kEngine = 1000, kCarBrake = 30;                             // N; N s a step, each wheel
constexpr btScalar kSteer = btScalar( 0.35 );                                  // rad, of a player's
constexpr btScalar kCarStopsAt = btScalar( 6.2 );                              // m
constexpr double kGateIsOpen = 1.2;                                            // rad
constexpr btScalar kHard = 2;                                                  // N s: a larger impulse counts as a hit of the car
constexpr double kHitsShown = 15;                                              // turn the lamp red

/// Targets of the walker, in order.
struct Waypoint
{
	btScalar x, z;
	bool jumps;          ///< there
	bool untilTriggered; ///< or until the plate is pressed
};

constexpr Waypoint kWay[] = {
	{ btScalar( -2.0 ), kWalkersLane, true, false },
	{ btScalar( 3.0 ), kWalkersLane, false, true },
	{ btScalar( 1.2 ), btScalar( 2.7 ), false, false },
	{ btScalar( 6.2 ), btScalar( 2.7 ), false, false },
};

class GamePlayground : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		if ( !m_level.build( stage ) )
		{
			return false;
		}
		m_walker = std::make_unique<Walker>( stage.world(), btVector3( btScalar( -6 ), 0, kWalkersLane ) );
		m_car = std::make_unique<Car>(
			stage, btTransform( btQuaternion( btVector3( 0, 1, 0 ), SIMD_HALF_PI ), btVector3( btScalar( -5.6 ), 0, kCarsLane ) ), kSlate );
		m_carStart = m_car->position();
		m_blockStart = m_level.pushBlock->massCentre();
		m_flagStart = m_level.flag->massCentre();
		m_walkerBefore = m_walker->foot();
		return true;
	}

	bool takeKeys( const PlayerKeys& keys ) override
	{
		m_isPlayed = m_isPlayed || keys.isAny();
		m_drivesCar = m_drivesCar != ( keys.change && !m_keys.change );
		m_keys = keys;
		return true;
	}

	void beforeStep( Stage&, double ) override
	{
		if ( m_isPlayed )
		{
			m_walker->walk(
				m_drivesCar ? btVector3( 0, 0, 0 ) : kWalkSpeed * btVector3( btScalar( m_keys.aside ), 0, btScalar( -m_keys.ahead ) ) );
			if ( m_keys.jump && !m_drivesCar )
			{
				m_walker->jump( kJumpSpeed );
			}
			m_drivesCar
				? m_car->drive( kEngine * btScalar( m_keys.ahead ), m_keys.jump ? kCarBrake : 0, -kSteer * btScalar( m_keys.aside ) )
				: m_car->drive( 0, kCarBrake, 0 );
		}
		else
		{
			followScript();
		}
		if ( m_triggeredAt >= 0 )
		{
			m_level.openGate();
		}
	}

	void afterStep( Stage& stage, double seconds ) override
	{
		watchWalker();
		m_carLift = std::max( m_carLift, double( m_car->position().y() - m_carStart.y() ) );
		m_gateAngle = std::max( m_gateAngle, m_level.gateAngle() );
		m_doorAngle = std::max( m_doorAngle, m_level.doorAngle() );
		m_flagBlown = std::max( m_flagBlown, double( m_level.flag->massCentre().x() - m_flagStart.x() ) );
		for ( const pliant::AttachmentEvent& event : stage.world().attachmentEvents() )
		{
			m_tornAt = event.id == m_level.chain ? double( m_car->position().x() ) : m_tornAt;
		}
		for ( const pliant::FractureEvent& event : stage.world().fractureEvents() )
		{
			const int pieces = int( event.fragments.size() );
			m_wallPieces += thingOf( *event.parent ) == PlaygroundThing::Wall ? pieces : 0;
			m_cratePieces += thingOf( *event.parent ) == PlaygroundThing::Crate ? pieces : 0;
			m_vasePieces += thingOf( *event.parent ) == PlaygroundThing::Vase ? pieces : 0;
		}
		m_faded += stage.world().stepReport().debrisFading;
		for ( const pliant::ContactEvent& event : stage.world().contactEvents() )
		{
			m_hits += event.began && event.other == m_car->chassis() && event.impulse > kHard ? 1 : 0;
			if ( event.began && event.other == &m_level.trigger && event.body == m_level.pushBlock && m_triggeredAt < 0 )
			{
				m_triggeredAt = seconds;
				m_level.fan.switchOn();
			}
		}
		moveCamera();
	}

	void beforePicture( Stage&, pliant_glue::DrawList& list ) override
	{
		m_walker->draw( list );
		m_car->draw( list );
		m_level.draw( list, m_triggeredAt >= 0, m_seconds );
		const btVector3 lamp = m_car->chassis()->getWorldTransform() * btVector3( 0, btScalar( 0.62 ), btScalar( -0.25 ) );
		list.spheres.push_back( { { 0.22f, 0, 0 }, { 0, 0.22f, 0 }, { 0, 0, 0.22f },
			{ float( lamp.x() ), float( lamp.y() ), float( lamp.z() ) }, heat( float( m_hits / kHitsShown ) ) } );
	}

	Story story( const Stage& stage ) const override
	{
		Story story;
		story.atLeast( "walked, m", m_walked, 11 );
		story.atLeast( "foot on the mat, m", m_onMat, 0.18 );
		story.atLeast( "stood on the crate, m", m_onCrate, 0.4 );
		story.atLeast( "jumped, m", m_highest, 0.9 );
		story.atLeast( "pushed the block, m", double( ( m_level.pushBlock->massCentre() - m_blockStart ).length() ), 0.6 );
		story.atLeast( "plate pressed at, s", m_triggeredAt, 1 );
		story.atLeast( "gate, rad", m_gateAngle, kGateIsOpen );
		story.atLeast( "soft door, rad", m_doorAngle, 0.6 );
		story.atLeast( "behind the door, m", double( m_walker->foot().x() ), 5 );
		story.atLeast( "flag blown, m", m_flagBlown, 0.15 );
		story.atLeast( "car drove, m", double( m_car->position().x() - m_carStart.x() ), 10.5 );
		story.atLeast( "hump lifts car, m", m_carLift, 0.1 );
		story.atLeast( "ball torn off at x, m", m_tornAt, 1 );
		story.atLeast( "pieces of the wall", m_wallPieces, 8 );
		story.atLeast( "of the crates", m_cratePieces, 1 );
		story.atLeast( "of the vase", m_vasePieces, 5 );
		story.atLeast( "over the budget", m_faded, 1 );
		story.atLeast( "hits of the car", m_hits, 5 );
		story.atMost( "pieces at the end", stage.world().fragmentCount(), kMostPlaygroundPieces );
		return story;
	}

	std::any ownState() const override { return Own{ m_level.switches(), m_walker->state(), m_car->wheels() }; }
	void restoreOwnState( const std::any& state ) override
	{
		const Own& own = std::any_cast<const Own&>( state );
		m_level.restore( own.switches );
		m_walker->restore( own.walker );
		m_car->restore( own.wheels );
	}

	double duration() const override { return 14.0; }
	pliant_glue::DrawCamera camera( double ) const override { return { { m_look + 1.2f, 4.4f, 8.4f }, { m_look, 0.7f, -0.3f }, 42.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.40f, 0.80f, 0.45f }, { 0.5f, 0.0f, 0 }, 8.5f }; }

private:
	struct Own
	{
		PlaygroundLevel::Switches switches;
		Character::State walker;
		Car::Wheels wheels;
	};

	void followScript()
	{
		const btVector3 foot = m_walker->foot();
		if ( m_next < std::size( kWay ) )
		{
			const Waypoint& to = kWay[m_next];
			const btVector3 way( to.x - foot.x(), 0, to.z - foot.z() );
			if ( way.length() < kWalkSpeed / 60 || ( to.untilTriggered && m_triggeredAt >= 0 ) )
			{
				if ( to.jumps )
				{
					m_walker->jump( kJumpSpeed );
				}
				++m_next;
			}
			m_walker->walk( way.normalized() * kWalkSpeed );
		}
		else
		{
			m_walker->walk( btVector3( 0, 0, 0 ) );
		}
		const bool drives = m_level.gateAngle() > kGateIsOpen, stops = m_car->position().x() > kCarStopsAt;
		m_car->drive( drives && !stops ? kEngine : 0, drives && !stops ? 0 : kCarBrake, 0 );
	}

	void watchWalker()
	{
		const btVector3 foot = m_walker->foot();
		m_walked += double( btVector3( foot.x() - m_walkerBefore.x(), 0, foot.z() - m_walkerBefore.z() ).length() );
		m_walkerBefore = foot;
		m_highest = std::max( m_highest, double( foot.y() ) );
		if ( m_walker->isOnGround() )
		{
			double& on = foot.x() < btScalar( -2.6 ) ? m_onMat : m_onCrate;
			on = std::max( on, double( foot.y() ) );
		}
	}

	void moveCamera()
	{
		const double walker = double( m_walker->foot().x() ), car = double( m_car->position().x() );
		const double wanted = m_isPlayed ? ( m_drivesCar ? car : walker ) : m_triggeredAt < 0 ? walker : 0.5 * ( walker + car );
		m_look += 0.03f * ( float( wanted ) - m_look );
		m_seconds += 1.0 / 60.0;
	}

	PlaygroundLevel m_level;
	std::unique_ptr<Walker> m_walker;
	std::unique_ptr<Car> m_car;
	PlayerKeys m_keys;
	bool m_isPlayed = false, m_drivesCar = false;
	std::size_t m_next = 0; ///< waypoint
	btVector3 m_carStart, m_blockStart, m_flagStart, m_walkerBefore;
	double m_walked = 0, m_highest = 0, m_onMat = 0, m_onCrate = 0, m_triggeredAt = -1, m_gateAngle = 0, m_doorAngle = 0, m_flagBlown = 0,
		   m_carLift = 0, m_tornAt = -100;
	int m_wallPieces = 0, m_cratePieces = 0, m_vasePieces = 0, m_faded = 0, m_hits = 0;
	float m_look = -5;
	double m_seconds = 0;
};

} // namespace

std::unique_ptr<Scene> makeGamePlayground()
{
	return std::make_unique<GamePlayground>();
}

} // namespace pliant_demos
