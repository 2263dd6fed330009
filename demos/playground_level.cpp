// +-----------------------------------------------------------------------------------------------------------------+
// | The level of game_playground. Two lanes along x: the walker's, nearer to the viewer, and the car's.               |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/playground_level.h"

#include "demos/must_succeed.h"
#include "demos/palette.h"
#include "demos/shapes.h"

#include <algorithm>
#include <cmath>

namespace pliant_demos {

namespace {

constexpr btScalar kGateAt = btScalar( -3.6 ), kGateWidth = btScalar( 2.4 );       // m
constexpr btScalar kDoorAt = btScalar( 3.9 ), kDoorMiddle = btScalar( 2.7 );       // m, x and z
constexpr float kDoorWidth = 1.1f, kDoorHeight = 1.7f, kDoorThickness = 0.1f;      // m
constexpr btScalar kDoorFrame = btScalar( 0.28 );                                  // m, width of the part of the panel that a hinge holds
constexpr btScalar kDoorOpens = btScalar( 1.7 ), kDoorFriction = btScalar( 0.05 ); // rad; N m s a step, of each hinge
constexpr btScalar kBallAt = btScalar( 2.6 ), kGallows = btScalar( 2.7 );          // m, x and height
constexpr float kPlaygroundBall = 0.5f;                                            // m
constexpr int kLinks = 4;                                                          // of the chain
constexpr btScalar kChainHolds = 500;                                              // N; the ball weighs 130 N
constexpr float kPlaygroundBrick[3] = { 0.12f, 0.12f, 0.24f };                     // m
constexpr int kPlaygroundBricks = 9, kPlaygroundCourses = 8;                       // along the wall and up
constexpr btScalar kWallAt = 5, kCratesAt = btScalar( 6.5 ), kCrateEdge = btScalar( 0.5 );          // m
constexpr btScalar kFanAt = btScalar( 4.9 ), kFlagAt = btScalar( 6 ), kFanHeight = btScalar( 1.3 ); // m
constexpr btScalar kFlagTop = btScalar( 1.9 );                                                      // m
constexpr btScalar kJet = btScalar( 0.7 ), kFanSpeed = 9;                                           // m, its radius; m/s

btTransform placeAt( btScalar x, btScalar y, btScalar z )
{
	return btTransform( btQuaternion::getIdentity(), btVector3( x, y, z ) );
}

/// A hinge's frame in the world: its axis, z, points up.
btTransform uprightHinge( btScalar x, btScalar y, btScalar z )
{
	return btTransform( btQuaternion( btVector3( 1, 0, 0 ), -SIMD_HALF_PI ), btVector3( x, y, z ) );
}

/// .2 m high, 2.4 m long at its foot and .6 m on its top.
pliant_glue::ModelMesh makeHump()
{
	pliant_glue::ModelMesh mesh = makeBox( { 2.4f, 0.2f, 2.2f }, { 12, 2, 11 } );
	for ( std::size_t v = 0; v < mesh.vertexCount(); ++v )
	{
		mesh.positions[3 * v] *= 1.0f - 0.75f * ( mesh.positions[3 * v + 1] / 0.2f + 0.5f );
	}
	mesh.name = "hump";
	return mesh;
}

pliant_glue::ModelMesh makeFlag()
{
	return makeBox( { 0.05f, 0.8f, 0.7f }, { 1, 16, 14 } );
}

SoftOrder soft( const char* name, float cellSize, float density, float youngsModulus, const pliant_glue::Colour& colour )
{
	SoftOrder order;
	order.name = name;
	order.cellSize = cellSize;
	order.material.density = density;
	order.material.youngsModulus = youngsModulus;
	order.friction = btScalar( 0.8 );
	order.colour = colour;
	return order;
}

/// Breaks into shards.
void makeBrittle( SoftOrder& order, float breakStrain, float shardSize )
{
	order.material.damping = 60.0f;
	order.fracture.rule = pliant::BreakRule::Shards;
	order.fracture.breakStrain = breakStrain;
	order.fracture.shardSize = shardSize;
	order.fracture.smallCells = 4;
	order.fracture.smallPieces = pliant::SmallPieces::Rigid;
}

} // namespace

PlaygroundThing thingOf( const btCollisionObject& object )
{
	return PlaygroundThing( object.getUserIndex() );
}

bool FanWind::actsOn( const btCollisionObject& object ) const
{
	return thingOf( object ) == PlaygroundThing::Flag;
}

btVector3 FanWind::velocityAt( const btVector3& position ) const
{
	const btScalar aside = std::hypot( position.y() - kFanHeight, position.z() - kWalkersLane + btScalar( 1.1 ) );
	return position.x() < kFanAt ? btVector3( 0, 0, 0 ) : settings().velocity * btMax( btScalar( 0 ), 1 - aside * aside / ( kJet * kJet ) );
}

void FanWind::switchOn()
{
	pliant::WindSettings wind;
	wind.velocity = btVector3( kFanSpeed, 0, 0 );
	mustSucceed( set( wind ) );
	wake();
}

bool PlaygroundLevel::build( Stage& stage )
{
	m_stage = &stage;
	stage.addGround( btScalar( 0.8 ) );
	stage.world().getPairCache()->setInternalGhostPairCallback( &m_pairs );
	pliant::DebrisBudget debris;
	debris.maxPieces = kMostPlaygroundPieces;
	debris.piecesPerStep = 10;
	mustSucceed( stage.world().setDebrisBudget( debris ) );
	addTrigger();
	return addGrounds() && addDoors() && addBallOnChain() && addBreakables() && addWall() && addFlag();
}

PlaygroundLevel::~PlaygroundLevel()
{
	if ( m_stage != nullptr )
	{
		m_stage->world().removeCollisionObject( &trigger );
		m_stage->world().getPairCache()->setInternalGhostPairCallback( nullptr );
	}
}

pliant::SoftBody* PlaygroundLevel::addThing(
	SoftOrder order, const pliant_glue::ModelMesh& mesh, PlaygroundThing thing, const btVector3& at )
{
	order.mesh = &mesh;
	order.place.setOrigin( at );
	pliant::SoftBody* const body = m_stage->addSoft( order );
	if ( body != nullptr )
	{
		body->setUserIndex( int( thing ) );
		body->setContactEvents( thing != PlaygroundThing::Ground && thing != PlaygroundThing::Flag );
	}
	return body;
}

bool PlaygroundLevel::addGrounds()
{
	mat = addThing( soft( "mat", 0.125f, 600, 1.0e5f, kMoss ), makeBox( { 2, 0.25f, 1.75f }, { 16, 2, 14 } ), PlaygroundThing::Ground,
		btVector3( btScalar( -3.6 ), btScalar( 0.125 ), kWalkersLane ) );
	const pliant::SoftBody* const crate = addThing( soft( "soft crate", 0.125f, 300, 2.0e5f, kOchre ),
		makeBox( { 1, 0.5f, 1 }, { 8, 4, 8 } ), PlaygroundThing::Ground, btVector3( btScalar( -0.7 ), btScalar( 0.25 ), kWalkersLane ) );
	const pliant::SoftBody* const hump = addThing( soft( "hump", 0.125f, 800, 4.0e5f, kMoss ), makeHump(), PlaygroundThing::Ground,
		btVector3( btScalar( 0.4 ), btScalar( 0.1 ), kCarsLane ) );
	pushBlock = addThing( soft( "block", 0.125f, 120, 1.0e5f, kTerracotta ), makeCube( 0.5f, 4 ), PlaygroundThing::PushBlock,
		btVector3( btScalar( 1.1 ), btScalar( 0.25 ), kWalkersLane ) );
	return mat != nullptr && crate != nullptr && hump != nullptr && pushBlock != nullptr;
}

void PlaygroundLevel::addTrigger()
{
	trigger.setCollisionShape( &m_triggerShape );
	trigger.setCollisionFlags( trigger.getCollisionFlags() | btCollisionObject::CF_NO_CONTACT_RESPONSE );
	trigger.setWorldTransform( placeAt( btScalar( 2.6 ), btScalar( 0.3 ), kWalkersLane ) );
	m_stage->world().addCollisionObject( &trigger, btBroadphaseProxy::SensorTrigger, btBroadphaseProxy::DefaultFilter );
}

bool PlaygroundLevel::addDoors()
{
	// The gate across the car's lane: a rigid door that a motor opens.
	const btScalar hingeZ = kCarsLane + kGateWidth / 2 + btScalar( 0.05 );
	m_stage->addBox( btVector3( btScalar( 0.14 ), btScalar( 1.3 ), btScalar( 0.14 ) ),
		placeAt( kGateAt, btScalar( 0.65 ), hingeZ + btScalar( 0.1 ) ), 0, kStone );
	btRigidBody* const gate = m_stage->addBox(
		btVector3( btScalar( 0.1 ), 1, kGateWidth ), placeAt( kGateAt, btScalar( 0.62 ), kCarsLane ), 25, kOak );
	gate->setActivationState( DISABLE_DEACTIVATION );
	const btTransform joint = uprightHinge( kGateAt, btScalar( 0.62 ), hingeZ );
	auto hinge = std::make_unique<btHingeConstraint>( *gate, gate->getWorldTransform().inverse() * joint );
	hinge->setLimit( btScalar( -1.7 ), btScalar( 1.7 ) );
	hinge->enableAngularMotor( true, 0, 20 );
	m_gate = hinge.get();
	m_stage->addConstraint( std::move( hinge ), false );

	// The walker's: a soft panel that swings freely on two frames.
	const btScalar edge = kDoorMiddle - btScalar( kDoorWidth ) / 2, bottom = btScalar( 0.06 );
	btRigidBody* const post = m_stage->addBox( btVector3( btScalar( 0.16 ), btScalar( 1.9 ), btScalar( 0.16 ) ),
		placeAt( kDoorAt, btScalar( 0.95 ), edge - btScalar( 0.12 ) ), 0, kStone );
	m_stage->addBox( btVector3( btScalar( 0.16 ), btScalar( 1.9 ), btScalar( 0.16 ) ),
		placeAt( kDoorAt, btScalar( 0.95 ), edge + btScalar( kDoorWidth ) + btScalar( 0.12 ) ), 0, kStone );
	door = addThing( soft( "door", kDoorThickness, 80, 1.2e5f, kPlum ),
		makeBox( { kDoorThickness, kDoorHeight, kDoorWidth }, { 1, 17, 11 } ), PlaygroundThing::Door,
		btVector3( kDoorAt, bottom + btScalar( kDoorHeight ) / 2, kDoorMiddle ) );
	if ( door == nullptr )
	{
		return false;
	}
	door->setIgnoreCollisionCheck( post, true ); // objects connected by a joint must not collide
	for ( const btScalar y : { bottom + btScalar( 0.3 ), bottom + btScalar( kDoorHeight ) - btScalar( 0.3 ) } )
	{
		const pliant::Result<btRigidBody*> frame = m_stage->world().addFrame(
			*door, btVector3( kDoorAt, y, edge + btScalar( 0.05 ) ), kDoorFrame );
		if ( !frame )
		{
			mustSucceed( frame.status );
			return false;
		}
		const btTransform at = uprightHinge( kDoorAt, y, edge - btScalar( 0.03 ) );
		auto pivot = std::make_unique<btHingeConstraint>(
			*frame.value, *post, frame.value->getWorldTransform().inverse() * at, post->getWorldTransform().inverse() * at );
		pivot->setLimit( -kDoorOpens, kDoorOpens );
		pivot->enableAngularMotor( true, 0, kDoorFriction );
		m_stage->addConstraint( std::move( pivot ), false );
	}
	return true;
}

double PlaygroundLevel::gateAngle() const
{
	return std::abs( double( m_gate->getHingeAngle() ) );
}

double PlaygroundLevel::doorAngle() const
{
	const btVector3 arm = door->massCentre() - btVector3( kDoorAt, 0, kDoorMiddle - btScalar( kDoorWidth ) / 2 );
	return std::abs( std::atan2( double( arm.x() ), double( arm.z() ) ) );
}

void PlaygroundLevel::openGate()
{
	m_gate->enableAngularMotor( true, gateAngle() < 1.5 ? btScalar( -1.6 ) : 0, 20 );
}

void PlaygroundLevel::restore( const Switches& switches )
{
	m_gate->setMotorTargetVelocity( switches.gateMotor );
	mustSucceed( fan.set( switches.wind ) );
}

bool PlaygroundLevel::addBallOnChain()
{
	const btScalar length = btScalar( 0.46 );
	btRigidBody* const beam = m_stage->addBox(
		btVector3( btScalar( 0.14 ), btScalar( 0.14 ), btScalar( 3.2 ) ), placeAt( kBallAt, kGallows, kCarsLane ), 0, kOak );
	for ( const btScalar side : { btScalar( -1.5 ), btScalar( 1.5 ) } )
	{
		m_stage->addBox(
			btVector3( btScalar( 0.14 ), kGallows, btScalar( 0.14 ) ), placeAt( kBallAt, kGallows / 2, kCarsLane + side ), 0, kOak );
	}
	btRigidBody* above = beam;
	btScalar y = kGallows - btScalar( 0.07 );
	for ( int k = 0; k < kLinks; ++k, y -= length )
	{
		btRigidBody* const link = m_stage->addBox( btVector3( btScalar( 0.05 ), length - btScalar( 0.04 ), btScalar( 0.05 ) ),
			placeAt( kBallAt, y - length / 2, kCarsLane ), 2, kStone );
		link->setActivationState( DISABLE_DEACTIVATION );
		link->setDamping( btScalar( 0.1 ), btScalar( 0.3 ) );
		m_stage->addConstraint(
			std::make_unique<btPoint2PointConstraint>(
				*above, *link, above->getWorldTransform().inverse() * btVector3( kBallAt, y, kCarsLane ), btVector3( 0, length / 2, 0 ) ),
			false );
		above = link;
	}
	ball = addThing( soft( "ball", 0.1f, 200, 1.0e5f, kBrick ), makeSphere( kPlaygroundBall, 3 ), PlaygroundThing::Ball,
		btVector3( kBallAt, y - btScalar( kPlaygroundBall ) / 2 - btScalar( 0.02 ), kCarsLane ) );
	if ( ball == nullptr )
	{
		return false;
	}
	pliant::AttachmentSettings weak;
	weak.breakingForce = kChainHolds;
	const pliant::Result<int> made = m_stage->world().attach( *ball, btVector3( kBallAt, y, kCarsLane ), *above, weak );
	mustSucceed( made.status );
	chain = made.value;
	return made.ok();
}

bool PlaygroundLevel::addWall()
{
	const float width = kPlaygroundBricks * kPlaygroundBrick[2], height = kPlaygroundCourses * kPlaygroundBrick[1];
	SoftOrder order = soft( "wall", 0.12f, 500, 1.0e6f, kTerracotta );
	order.material.damping = 60.0f;
	order.insideColour = kStone; // mortar
	pliant::SoftBody* const wall = addThing( order,
		makeBox( { kPlaygroundBrick[0], height, width }, { 1, 2 * kPlaygroundCourses, 4 * kPlaygroundBricks } ), PlaygroundThing::Wall,
		btVector3( kWallAt, btScalar( height ) / 2, kCarsLane ) );
	if ( wall == nullptr )
	{
		return false;
	}
	std::vector<float> centres;
	std::vector<int> bricks;
	for ( int course = 0; course < kPlaygroundCourses; ++course )
	{
		for ( int half = 0; half < 2 * kPlaygroundBricks; ++half ) // running bond: every other course is shifted by half a brick
		{
			centres.insert( centres.end(),
				{ 0, ( float( course ) + 0.5f ) * kPlaygroundBrick[1] - height / 2,
					( float( half ) + 0.5f ) * kPlaygroundBrick[2] / 2 - width / 2 } );
			bricks.push_back( course * ( kPlaygroundBricks + 1 ) + ( half + course % 2 ) / 2 );
		}
	}
	pliant::Fracture fracture;
	fracture.rule = pliant::BreakRule::Shards;
	fracture.breakStrain = 0.01f;
	fracture.smallCells = 2;
	fracture.smallPieces = pliant::SmallPieces::Rigid;
	const pliant::Status status = wall->setFracture( fracture, {}, { centres.data(), int( bricks.size() ), bricks.data() } );
	mustSucceed( status );
	return status.ok();
}

bool PlaygroundLevel::addBreakables()
{
	SoftOrder crate = soft( "crate", 0.125f, 120, 2.8e5f, kOak );
	makeBrittle( crate, 0.02f, 0.25f );
	const pliant_glue::ModelMesh box = makeCube( float( kCrateEdge ), 4 );
	for ( int k = 0; k < 3; ++k )
	{
		const btScalar aside = k == 2 ? 0 : ( btScalar( k ) - btScalar( 0.5 ) ) * btScalar( 0.56 );
		if ( !addThing( crate, box, PlaygroundThing::Crate,
				 btVector3( kCratesAt, kCrateEdge * ( k == 2 ? btScalar( 1.5 ) : btScalar( 0.5 ) ), kCarsLane + aside ) ) )
		{
			return false;
		}
	}
	SoftOrder vase = soft( "vase", 0.045f, 1000, 3.0e5f, kTeal );
	makeBrittle( vase, 0.04f, 0.12f );
	vase.insideColour = kOchre;
	const pliant_glue::ModelMesh mesh = makeVessel(
		{ { 0.13f, 0 }, { 0.18f, 0.13f }, { 0.23f, 0.3f }, { 0.20f, 0.44f }, { 0.13f, 0.56f }, { 0.16f, 0.64f } }, 0.05f, 0.03f, 48 );
	return addThing( vase, mesh, PlaygroundThing::Vase, btVector3( kCratesAt, 2 * kCrateEdge, kCarsLane ) ) != nullptr;
}

bool PlaygroundLevel::addFlag()
{
	const btScalar z = kWalkersLane - btScalar( 1.1 );
	SoftOrder order = soft( "flag", 0.05f, 60, 2.0e4f, kBrick );
	order.material.damping = 5.0f;
	flag = addThing( order, makeFlag(), PlaygroundThing::Flag, btVector3( kFlagAt, kFlagTop - btScalar( 0.4 ), z ) );
	if ( flag == nullptr )
	{
		return false;
	}
	flag->pinNodesInside( btVector3( kFlagAt - 1, kFlagTop - btScalar( 0.06 ), z - 1 ), btVector3( kFlagAt + 1, kFlagTop + 1, z + 1 ) );
	m_stage->addBox(
		btVector3( btScalar( 0.08 ), btScalar( 0.08 ), btScalar( 0.9 ) ), placeAt( kFlagAt, kFlagTop + btScalar( 0.04 ), z ), 0, kStone );
	m_stage->addBox(
		btVector3( btScalar( 0.08 ), kFlagTop, btScalar( 0.08 ) ), placeAt( kFlagAt, kFlagTop / 2, z - btScalar( 0.45 ) ), 0, kStone );
	m_stage->addBox(
		btVector3( btScalar( 0.12 ), kFanHeight, btScalar( 0.12 ) ), placeAt( kFanAt - btScalar( 0.1 ), kFanHeight / 2, z ), 0, kStone );
	const pliant::Status status = m_stage->world().addForceField( fan );
	mustSucceed( status );
	return status.ok();
}

void PlaygroundLevel::draw( pliant_glue::DrawList& list, bool isFired, double seconds ) const
{
	const btVector3 at = trigger.getWorldTransform().getOrigin(), size = 2 * m_triggerShape.getHalfExtentsWithMargin();
	list.boxes.push_back( { { float( size.x() ), 0, 0 }, { 0, 0.03f, 0 }, { 0, 0, float( size.z() ) },
		{ float( at.x() ), 0.015f, float( at.z() ) }, isFired ? kTeal : kBrick } );
	const float turn = fan.isOn() ? float( seconds ) * 9.0f : 0.5f;
	for ( int blade = 0; blade < 3; ++blade )
	{
		const float angle = turn + 2.0944f * float( blade ), c = std::cos( angle ), s = std::sin( angle );
		list.boxes.push_back( { { 0.04f, 0, 0 }, { 0, 0.45f * c, 0.45f * s }, { 0, -0.12f * s, 0.12f * c },
			{ float( kFanAt ), float( kFanHeight ) + 0.25f * c, float( kWalkersLane ) - 1.1f + 0.25f * s }, kSlate } );
	}
}

} // namespace pliant_demos
