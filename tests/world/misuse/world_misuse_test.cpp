// Misuse of worlds: bodies of other worlds and of none, contact proxies, bad numbers, ids, settings.

#include "world/bodies/soft_body_impl.h"
#include "world/misuse/misuse.h"

#include <pliant/game/queries.h>
#include <pliant/vehicle_raycaster.h>

#include <BulletCollision/CollisionDispatch/btGhostObject.h>

namespace pliant::test {
namespace {

const AttachmentSettings kBadAttachments[] = {
	{ kNan, 1 }, { btScalar( -1 ), 1 }, { kInf, 1 }, { 0, 0 }, { 0, btScalar( -1 ) }, { 0, kNan } };

/// Calls `call` with each bad setting.
template <class Call>
Answers forBadAttachments( const Call& call )
{
	Answers all;
	for ( const AttachmentSettings& bad : kBadAttachments )
	{
		all.push_back( statusOf( call( bad ) ) );
	}
	return all;
}

const Misuse kMembers[] = {
	{ "SoftBodyHost::addSoftBody", ResultCode::Ok,
		[]( Scene& s ) {
			s.home.world.addSoftBody( nullptr );
			s.home.world.addSoftBody( s.other );
			s.elsewhere.world.addSoftBody( s.other );
			return Answers{ answers( true ) };
		} },
	{ "SoftBodyHost::removeSoftBody", ResultCode::Ok,
		[]( Scene& s ) {
			s.home.world.removeSoftBody( nullptr );
			s.elsewhere.world.removeSoftBody( s.other );
			return Answers{ answers( true ) };
		} },
	{ "SoftBodyWorldOver::addCollisionObject", ResultCode::Ok,
		[]( Scene& s ) {
			s.home.world.addCollisionObject( s.other );
			s.home.world.addCollisionObject( s.proxy() );
			s.elsewhere.world.addCollisionObject( s.proxy() );
			return Answers{ answers( s.proxy() != nullptr ) };
		} },
	{ "SoftBodyWorldOver::removeCollisionObject", ResultCode::Ok,
		[]( Scene& s ) {
			s.elsewhere.world.removeCollisionObject( s.other );
			s.elsewhere.world.removeCollisionObject( s.proxy() );
			return Answers{ answers( true ) };
		} },
	{ "SoftBodyWorldOver::addRigidBody", ResultCode::Ok,
		[]( Scene& s ) {
			s.home.world.addRigidBody( btRigidBody::upcast( s.proxy() ) );
			return Answers{ answers( btRigidBody::upcast( s.proxy() ) != nullptr ) };
		} },
	{ "SoftBodyWorldOver::addRigidBody", ResultCode::Ok,
		[]( Scene& s ) {
			s.elsewhere.world.addRigidBody( btRigidBody::upcast( s.proxy() ), 1, -1 );
			return Answers{ answers( true ) };
		} },
	{ "SoftBodyWorldOver::removeRigidBody", ResultCode::Ok,
		[]( Scene& s ) {
			s.home.world.removeRigidBody( s.loose.get() );
			s.elsewhere.world.removeRigidBody( btRigidBody::upcast( s.proxy() ) );
			return Answers{ answers( true ) };
		} },
	{ "SoftBodyWorldOver::removeConstraint", ResultCode::Ok,
		[]( Scene& s ) {
			btPoint2PointConstraint joint( *s.loose, btVector3( 0, 0, 0 ) );
			s.home.world.removeConstraint( &joint ); // has never been added
			return Answers{ answers( true ) };
		} },
	{ "SoftBodyWorldOver::stepSimulation", ResultCode::Ok,
		[]( Scene& s ) {
			Answers all;
			for ( const btScalar bad : { kNan, kInf, -kInf, btScalar( -1 ) } )
			{
				all.push_back( answers( s.home.world.stepSimulation( bad, 0 ) == 0 ) );
				all.push_back( answers( s.home.world.stepSimulation( kFrame, 4, bad ) == 0 ) );
			}
			return all;
		} },
	{ "SoftBodyHost::softBody", ResultCode::Ok,
		[]( Scene& s ) {
			return forBadIndices( s.home.world.softBodyCount(), [&]( int i ) { return answers( s.home.world.softBody( i ) == nullptr ); } );
		} },
	{ "SoftBodyHost::releaseFragment", ResultCode::Ok,
		[]( Scene& s ) {
			return Answers{ answers( !s.home.world.releaseFragment( nullptr ) ), answers( !s.home.world.releaseFragment( s.other ) ),
				answers( !s.elsewhere.world.releaseFragment( s.other ) ) };
		} },
};

const Misuse kSettings[] = {
	{ "SoftBodyHost::setDebrisBudget", ResultCode::BadSettings,
		[]( Scene& s ) {
			Answers all;
			for ( const DebrisBudget& bad : { DebrisBudget{ -1, 0, 1, 0 }, DebrisBudget{ 0, -1, 1, 0 }, DebrisBudget{ 0, 0, NAN, 0 },
					  DebrisBudget{ 0, 0, 0, 0 }, DebrisBudget{ 0, 0, 1, -1 } } )
			{
				all.push_back( s.home.world.setDebrisBudget( bad ) );
			}
			return all;
		},
		"DebrisBudget::" },
	{ "SoftBodyHost::setInterpolationFraction", ResultCode::Ok,
		[]( Scene& s ) {
			const btScalar before = s.home.world.interpolationFraction();
			Answers all;
			for ( const auto& [bad, taken] : { std::pair( kNan, 1 ), std::pair( kInf, 1 ), std::pair( -kInf, 0 ) } )
			{
				s.home.world.setInterpolationFraction( bad );
				all.push_back( answers( s.home.world.interpolationFraction() == btScalar( taken ) ) );
			}
			s.home.world.setInterpolationFraction( before );
			return all;
		} },
	{ "SoftBodyHost::setSoftSubsteps", ResultCode::Ok,
		[]( Scene& s ) {
			const int before = s.home.world.softSubsteps();
			s.home.world.setSoftSubsteps( INT_MIN );
			const int least = s.home.world.softSubsteps();
			s.home.world.setSoftSubsteps( INT_MAX );
			const int most = s.home.world.softSubsteps();
			s.home.world.setSoftSubsteps( before );
			return Answers{ answers( least == 1 ), answers( most == 64 ) };
		} },
	{ "SoftBodyHost::setMaxSoftSubsteps", ResultCode::Ok,
		[]( Scene& s ) {
			const int before = s.home.world.maxSoftSubsteps();
			s.home.world.setMaxSoftSubsteps( INT_MIN );
			const int least = s.home.world.maxSoftSubsteps();
			s.home.world.setMaxSoftSubsteps( INT_MAX );
			const int most = s.home.world.maxSoftSubsteps();
			s.home.world.setMaxSoftSubsteps( before );
			return Answers{ answers( least == 1 ), answers( most == 64 ) };
		} },
	{ "SoftBodyHost::setThreadCount", ResultCode::Ok,
		[]( Scene& s ) {
			Answers all;
			for ( const int bad : { 0, -5, INT_MIN } )
			{
				s.home.world.setThreadCount( bad );
				all.push_back( answers( s.home.world.threadCount() == 1 ) );
			}
			return all;
		} },
	{ "SoftBodyHost::setTaskRunner", ResultCode::Ok,
		[]( Scene& s ) {
			s.home.world.setTaskRunner( nullptr );
			return Answers{ answers( s.home.world.threadCount() == 1 ) };
		} },
	{ "SoftBodyHost::setDebugDrawing", ResultCode::Ok,
		[]( Scene& s ) {
			DebugDrawing bad;
			bad.fullStrain = bad.metresPerNewton = kNan;
			bad.metresPerImpulse = kInf;
			s.home.world.setDebugDrawing( bad );
			const DebugDrawing taken = s.home.world.debugDrawing(), usual;
			s.home.world.setDebugDrawing( usual );
			return Answers{ answers( taken.fullStrain == usual.fullStrain ), answers( taken.metresPerNewton == usual.metresPerNewton ),
				answers( taken.metresPerImpulse == usual.metresPerImpulse ) };
		} },
};

const Misuse kJoints[] = {
	{ "SoftBodyHost::attach", kBad,
		[]( Scene& s ) {
			btGhostObject ghost;
			SoftBodyHost& world = s.home.world;
			Answers all = forBadIndices( s.body->nodeCount(), [&]( int i ) { return world.attach( *s.body, i, *s.box ).status; } );
			for ( btCollisionObject* const to :
				{ static_cast<btCollisionObject*>( s.farBox ), static_cast<btCollisionObject*>( s.loose.get() ),
					static_cast<btCollisionObject*>( &ghost ), static_cast<btCollisionObject*>( s.body ), s.proxy() } )
			{
				all.push_back( world.attach( *s.body, 0, *to ).status );
				all.push_back( world.attach( *s.other, 0, *to ).status );
			}
			all.push_back( s.elsewhere.world.attach( *s.other, 0, *s.farBox ).status );
			return all;
		} },
	{ "SoftBodyHost::attach", ResultCode::BadSettings,
		[]( Scene& s ) {
			return forBadAttachments( [&]( const AttachmentSettings& bad ) { return s.home.world.attach( *s.other, 0, *s.box, bad ); } );
		} },
	{ "SoftBodyHost::attach", kBad,
		[]( Scene& s ) {
			Answers all = forBadVectors( [&]( const btVector3& v ) { return s.home.world.attach( *s.other, v, *s.box ).status; } );
			all.push_back( s.home.world.attach( *s.other, btVector3( btScalar( 1e30 ), 0, 0 ), *s.box ).status );
			return all;
		} },
	{ "SoftBodyHost::attach", kBad,
		[]( Scene& s ) {
			SoftBodyHost& world = s.home.world;
			const btVector3 middle = s.other->massCentre();
			Answers all = forBadVectors( [&]( const btVector3& v ) { return world.attach( *s.body, *s.other, v ).status; } );
			all.push_back( world.attach( *s.other, *s.other, middle ).status );
			all.push_back( s.elsewhere.world.attach( *s.body, *s.other, middle ).status );
			all.push_back( world.attach( *s.body, *s.other, btVector3( 0, btScalar( 1e30 ), 0 ) ).status );
			return all;
		} },
	{ "SoftBodyHost::weld", kBad,
		[]( Scene& s ) {
			SoftBodyHost& world = s.home.world;
			Answers all{ world.weld( *s.other, *s.other, 1 ).status, s.elsewhere.world.weld( *s.body, *s.other, 1 ).status };
			for ( const btScalar bad : { kNan, kInf, btScalar( -1 ) } )
			{
				all.push_back( world.weld( *s.body, *s.other, bad ).status );
			}
			return all;
		} },
	{ "SoftBodyHost::detach", ResultCode::Ok,
		[]( Scene& s ) {
			return Answers{ answers( !s.home.world.detach( -1 ) ), answers( !s.home.world.detach( INT_MAX ) ),
				answers( !s.elsewhere.world.detach( s.attachment ) ) };
		} },
	{ "SoftBodyHost::attachmentForce", ResultCode::Ok,
		[]( Scene& s ) {
			return Answers{ answers( s.home.world.attachmentForce( -1 ).isZero() ),
				answers( s.home.world.attachmentForce( INT_MAX ).isZero() ),
				answers( s.elsewhere.world.attachmentForce( s.attachment ).isZero() ) };
		} },
	{ "SoftBodyHost::addFrame", kBad,
		[]( Scene& s ) {
			SoftBodyHost& world = s.home.world;
			Answers all = forBadVectors( [&]( const btVector3& v ) { return world.addFrame( *s.other, v, 1 ).status; } );
			for ( const btScalar radius : { kNan, kInf, btScalar( 0 ), btScalar( -1 ), btScalar( 1e-6 ) } )
			{
				all.push_back( world.addFrame( *s.other, s.other->massCentre(), radius ).status );
			}
			all.push_back( world.addFrame( *s.other, btVector3( 99, 0, 0 ), 1 ).status );
			all.push_back( s.elsewhere.world.addFrame( *s.other, s.other->massCentre(), 1 ).status );
			return all;
		} },
	{ "SoftBodyHost::removeFrame", ResultCode::Ok,
		[]( Scene& s ) {
			return Answers{ answers( !s.home.world.removeFrame( nullptr ) ), answers( !s.home.world.removeFrame( s.box ) ),
				answers( !s.elsewhere.world.removeFrame( s.frame ) ) };
		} },
	{ "SoftBodyHost::frameOwner", ResultCode::Ok,
		[]( Scene& s ) {
			return Answers{ answers( !s.home.world.frameOwner( nullptr ) ), answers( !s.home.world.frameOwner( s.box ) ),
				answers( !s.elsewhere.world.frameOwner( s.frame ) ) };
		} },
};

const Misuse kForces[] = {
	{ "SoftBodyHost::addForceField", kBad,
		[]( Scene& s ) {
			return Answers{ s.home.world.addForceField( s.field ), s.elsewhere.world.addForceField( s.field ) };
		} },
	{ "SoftBodyHost::removeForceField", ResultCode::Ok,
		[]( Scene& s ) {
			Wind free;
			return Answers{ answers( !s.home.world.removeForceField( free ) ), answers( !s.home.world.removeForceField( s.field ) ) };
		} },
	{ "SoftBodyHost::explode", ResultCode::BadSettings,
		[]( Scene& s ) {
			const btVector3 at( 0, 0, 0 );
			Answers all;
			for ( const Explosion& bad : { Explosion{ btVector3( kNan, 0, 0 ) }, Explosion{ at, 0 }, Explosion{ at, kNan },
					  Explosion{ at, kInf }, Explosion{ at, 5, -1 }, Explosion{ at, 5, kNan }, Explosion{ at, 5, kInf },
					  Explosion{ at, 5, 1, 11 }, Explosion{ at, 5, 1, -1 }, Explosion{ at, 5, 1, kNan } } )
			{
				all.push_back( s.home.world.explode( bad ).status );
			}
			return all;
		} },
	{ "SoftBodyHost::explode", kBad,
		[]( Scene& s ) {
			return Answers{ s.home.world.explode( Explosion{ btVector3( -1, 1, 0 ), 5, btScalar( 1e30 ) } ).status,
				s.elsewhere.world.explode( Explosion{ btVector3( 1, 2, 0 ), btScalar( 1.5 ), btScalar( 1e30 ) } ).status };
		} },
	{ "SoftBodyHost::shiftOrigin", kBad,
		[]( Scene& s ) {
			Answers all = forBadVectors( [&]( const btVector3& v ) { return s.home.world.shiftOrigin( v ); } );
			all.push_back( s.home.world.shiftOrigin( btVector3( btScalar( 2e9 ), 0, 0 ) ) );
			return all;
		} },
	{ "Wind::Wind", ResultCode::Ok,
		[]( Scene& ) {
			const Wind wind( WindSettings{ btVector3( kNan, 0, 0 ), 1, 1, 0 } );
			return Answers{ answers( wind.settings().velocity.isZero() ) };
		} },
	{ "Wind::set", ResultCode::BadSettings,
		[]( Scene& s ) {
			const btVector3 still( 0, 0, 0 );
			Answers all = forBadVectors( [&]( const btVector3& v ) { return s.field.set( WindSettings{ v, 1, 1, 0 } ); } );
			for ( const WindSettings& bad : { WindSettings{ btVector3( 1001, 0, 0 ), 1, 1, 0 }, WindSettings{ still, -1, 1, 0 },
					  WindSettings{ still, kNan, 1, 0 }, WindSettings{ still, 1, 101, 0 }, WindSettings{ still, 1, 1, -1 } } )
			{
				all.push_back( s.field.set( bad ) );
			}
			return all;
		},
		"Wind" },
	{ "Water::Water", ResultCode::Ok,
		[]( Scene& ) {
			const Water water( WaterSettings{ btVector3( 0, kNan, 0 ), btVector3( 0, 0, 0 ), -1, 1, btVector3( 0, 0, 0 ) } );
			return Answers{ answers( water.settings().density == 1000 ), answers( water.settings().surface.isZero() ) };
		} },
	{ "Water::set", ResultCode::BadSettings,
		[]( Scene& ) {
			Water water;
			const btVector3 still( 0, 0, 0 ), up( 0, 1, 0 );
			Answers all = forBadVectors( [&]( const btVector3& v ) { return water.set( WaterSettings{ v, up, 1000, 1, still } ); } );
			for ( const WaterSettings& bad : { WaterSettings{ still, still, 1000, 1, still }, WaterSettings{ still, up, -1, 1, still },
					  WaterSettings{ still, up, kNan, 1, still }, WaterSettings{ still, up, 1000, 101, still },
					  WaterSettings{ still, up, 1000, 1, btVector3( 1001, 0, 0 ) } } )
			{
				all.push_back( water.set( bad ) );
			}
			return all;
		},
		"Water" },
	{ "Planet::Planet", ResultCode::Ok,
		[]( Scene& ) {
			const btVector3 at( 0, 0, 0 ), here( 0, 3, 0 );
			return Answers{ answers( Planet( btVector3( kNan, 0, 0 ), 1, 1 ).acceleration( here ).isZero() ),
				answers( Planet( at, 0, 1 ).acceleration( here ).isZero() ), answers( Planet( at, -1, 1 ).acceleration( here ).isZero() ),
				answers( Planet( at, kInf, 1 ).acceleration( here ).isZero() ),
				answers( Planet( at, 1, kNan ).acceleration( here ).isZero() ) };
		} },
};

const Misuse kQueries[] = {
	{ "SurfaceQuery::SurfaceQuery", ResultCode::Ok,
		[]( Scene& s ) {
			const SurfaceQuery query( *s.body );
			return Answers{ answers( std::isfinite( query.volume() ) && std::isfinite( query.area() ) ) };
		} },
	{ "SurfaceQuery::nearest", ResultCode::Ok,
		[]( Scene& s ) {
			const SurfaceQuery query( *s.body );
			return forBadVectors( [&]( const btVector3& v ) {
				const NearestPoint found = query.nearest( v );
				return answers( found.node == -1 && found.triangle == -1 && found.distance == 0 && found.point.isZero() );
			} );
		} },
	{ "SurfaceQuery::isInside", ResultCode::Ok,
		[]( Scene& s ) {
			const SurfaceQuery query( *s.body );
			return forBadVectors( [&]( const btVector3& v ) { return answers( !query.isInside( v ) ); } );
		} },
	{ "SurfaceQuery::touchesSphere", ResultCode::Ok,
		[]( Scene& s ) {
			const SurfaceQuery query( *s.body );
			Answers all = forBadVectors( [&]( const btVector3& v ) { return answers( !query.touchesSphere( v, 99 ) ); } );
			for ( const btScalar bad : { kNan, kInf, btScalar( -1 ) } )
			{
				all.push_back( answers( !query.touchesSphere( s.body->massCentre(), bad ) ) );
			}
			return all;
		} },
	{ "VehicleRaycaster::castRay", ResultCode::Ok,
		[]( Scene& s ) {
			VehicleRaycaster caster( s.home.world );
			btVehicleRaycaster::btVehicleRaycasterResult hit;
			hit.m_distFraction = 7;
			const btVector3 good( 0, 9, 0 );
			Answers all = forBadVectors( [&]( const btVector3& v ) {
				return answers( !caster.castRay( v, good, hit ) && !caster.castRay( good, v, hit ) && hit.m_distFraction == 7 );
			} );
			all.push_back( answers( !caster.castRay( good, good, hit ) && hit.m_distFraction == 7 ) );
			return all;
		} },
	{ "VehicleRaycaster::softBodyAt", ResultCode::Ok,
		[]( Scene& s ) {
			VehicleRaycaster caster( s.home.world );
			const btVector3 good( 0, 9, 0 );
			return forBadVectors(
				[&]( const btVector3& v ) { return answers( !caster.softBodyAt( v, good ) && !caster.softBodyAt( good, v ) ); } );
		} },
	{ "VehicleRaycaster::setVehicle", ResultCode::Ok,
		[]( Scene& s ) {
			VehicleRaycaster caster( s.home.world );
			caster.setVehicle( nullptr );
			return Answers{ answers( caster.vehicle() == nullptr ) };
		} },
	{ "VehicleRaycaster::updateAction", ResultCode::Ok,
		[]( Scene& s ) {
			VehicleRaycaster caster( s.home.world );
			for ( const btScalar step : { kNan, kInf, btScalar( -1 ), kFrame } )
			{
				caster.updateAction( nullptr, step ); // without a vehicle
			}
			return Answers{ answers( true ) };
		} },
};

class MisuseOfWorld : public testing::TestWithParam<BodyState>
{};

TEST_P( MisuseOfWorld, IsRefusedAndChangesNothing )
{
	expectNothingChanges( GetParam(), kMembers );
	expectNothingChanges( GetParam(), kSettings );
	expectNothingChanges( GetParam(), kJoints );
	expectNothingChanges( GetParam(), kForces );
	expectNothingChanges( GetParam(), kQueries );
}

INSTANTIATE_TEST_SUITE_P( States, MisuseOfWorld, testing::ValuesIn( kBodyStates ) );

} // namespace
} // namespace pliant::test
