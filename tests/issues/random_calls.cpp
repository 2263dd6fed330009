#include "issues/random_calls.h"

#include <cmath>
#include <limits>

namespace pliant::test {

namespace {

RandomCalls* g_listening = nullptr;

bool isSoftPair( const btCollisionObject* a, const btCollisionObject* b )
{
	return SoftBody::upcast( a ) || SoftBody::upcast( b );
}
bool onAdded( btManifoldPoint&, const btCollisionObjectWrapper* a, int, int, const btCollisionObjectWrapper* b, int, int )
{
	if ( isSoftPair( a->getCollisionObject(), b->getCollisionObject() ) )
	{
		g_listening->contact( a->getCollisionObject(), b->getCollisionObject() );
	}
	return false;
}
bool onProcessed( btManifoldPoint&, void* a, void* b )
{
	if ( isSoftPair( static_cast<btCollisionObject*>( a ), static_cast<btCollisionObject*>( b ) ) )
	{
		g_listening->contact( static_cast<btCollisionObject*>( a ), static_cast<btCollisionObject*>( b ) );
	}
	return false;
}
void onStarted( btPersistentManifold* const& manifold )
{
	if ( isSoftPair( manifold->getBody0(), manifold->getBody1() ) )
	{
		g_listening->contact( manifold->getBody0(), manifold->getBody1() );
	}
}
void onEnded( btPersistentManifold* const& manifold )
{
	// Bullet's pair cache does not support removing pairs while a pair is being removed, for rigid bodies either.
	if ( SoftBody* const soft = SoftBody::upcast( const_cast<btCollisionObject*>( manifold->getBody0() ) ) )
	{
		soft->activate();
	}
}

void forgetCallbacks()
{
	gContactAddedCallback = nullptr;
	gContactProcessedCallback = nullptr;
	gContactStartedCallback = nullptr;
	gContactEndedCallback = nullptr;
}

const btScalar kBad[] = { std::numeric_limits<btScalar>::quiet_NaN(), std::numeric_limits<btScalar>::infinity(),
	-std::numeric_limits<btScalar>::infinity(), std::numeric_limits<btScalar>::max() };

} // namespace

btDefaultCollisionConstructionInfo SmallParts::info()
{
	btDefaultCollisionConstructionInfo info;
	info.m_defaultMaxPersistentManifoldPoolSize = 1;
	info.m_defaultMaxCollisionAlgorithmPoolSize = 1;
	return info;
}

SmallParts::SmallParts() : configuration( info() ), dispatcher( &configuration ) {}

template <class World>
Bystanders<World>::Bystanders( World& to ) :
	world( to ), floor( btRigidBody::btRigidBodyConstructionInfo( 0, nullptr, &floorShape ) ),
	box(
		btRigidBody::btRigidBodyConstructionInfo( 2, nullptr, &boxShape, btVector3( btScalar( 0.2 ), btScalar( 0.2 ), btScalar( 0.1 ) ) ) ),
	bob(
		btRigidBody::btRigidBodyConstructionInfo( 1, nullptr, &boxShape, btVector3( btScalar( 0.1 ), btScalar( 0.1 ), btScalar( 0.1 ) ) ) ),
	joint( bob, btVector3( 1, 0, 0 ) )
{
	floor.setWorldTransform( at( 100, -1, 0 ) );
	box.setWorldTransform( btTransform( btQuaternion( btVector3( 1, 2, 3 ).normalized(), 1 ), btVector3( 100, 1, 0 ) ) );
	bob.setWorldTransform( at( 110, 3, 0 ) );
	for ( btRigidBody* body : { &floor, &box, &bob } )
	{
		body->setInterpolationWorldTransform( body->getWorldTransform() );
		world.addRigidBody( body );
	}
	joint.setPivotB( bob.getWorldTransform() * btVector3( 1, 0, 0 ) );
	world.addConstraint( &joint );
}

template <class World>
Bystanders<World>::~Bystanders()
{
	world.removeConstraint( &joint );
	for ( btRigidBody* body : { &floor, &box, &bob } )
	{
		world.removeRigidBody( body );
	}
}

RandomCalls::RandomCalls( unsigned seed ) : m_random( seed ), m_isPlain( seed % 4 == 0 )
{
	const int worlds = m_isPlain ? 1 : 1 + below( 2 ), partsCount = worlds == 2 && oneIn( 2 ) ? 2 : 1;
	for ( int k = 0; k < worlds; ++k )
	{
		if ( k < partsCount )
		{
			m_parts[k] = std::make_unique<SmallParts>();
		}
		SmallParts& parts = *m_parts[std::min( k, partsCount - 1 )];
		m_broadphases[k] = std::make_unique<btDbvtBroadphase>();
		m_solvers[k] = std::make_unique<btSequentialImpulseConstraintSolver>();
		m_worlds.push_back(
			std::make_unique<SoftBodyWorld>( &parts.dispatcher, m_broadphases[k].get(), m_solvers[k].get(), &parts.configuration ) );
	}
	if ( m_isPlain )
	{
		m_bystanders = std::make_unique<Bystanders<SoftBodyWorld>>( *m_worlds[0] );
		m_twinParts = std::make_unique<SmallParts>();
		m_twinBroadphase = std::make_unique<btDbvtBroadphase>();
		m_twinSolver = std::make_unique<btSequentialImpulseConstraintSolver>();
		m_twinWorld = std::make_unique<btDiscreteDynamicsWorld>(
			&m_twinParts->dispatcher, m_twinBroadphase.get(), m_twinSolver.get(), &m_twinParts->configuration );
		m_twin = std::make_unique<Bystanders<btDiscreteDynamicsWorld>>( *m_twinWorld );
	}
	g_listening = this;
}

RandomCalls::~RandomCalls()
{
	forgetCallbacks();
	oneIn( 2 ) ? m_soft.clear() : void();
	for ( const Rigid& rigid : m_rigid )
	{
		rigid.world ? rigid.world->removeRigidBody( rigid.body.get() ) : void();
	}
	m_bystanders.reset();
	m_worlds.clear();
	m_twin.reset();
}

void RandomCalls::run()
{
	static const Call often[] = { &RandomCalls::step, &RandomCalls::step, &RandomCalls::create, &RandomCalls::add, &RandomCalls::pins,
		&RandomCalls::attach, &RandomCalls::game, &RandomCalls::rigid, &RandomCalls::place, &RandomCalls::push };
	static const Call seldom[] = { &RandomCalls::remove, &RandomCalls::removeByManifold, &RandomCalls::destroy, &RandomCalls::flags,
		&RandomCalls::ignore, &RandomCalls::cuts, &RandomCalls::breaking, &RandomCalls::material, &RandomCalls::callbacks,
		&RandomCalls::features, &RandomCalls::activation, &RandomCalls::queries, &RandomCalls::output, &RandomCalls::fragments,
		&RandomCalls::settings, &RandomCalls::badNodes };
	static const Call rare[] = { &RandomCalls::destroyWorld, &RandomCalls::forgetObjects, &RandomCalls::oddStep };
	create();
	rigid();
	add();
	const int count = 10 + below( 40 );
	for ( int k = 0; k < count; ++k )
	{
		const int kind = below( 20 );
		const Call call = kind < 11  ? often[below( int( std::size( often ) ) )]
			: kind < 19 || m_isPlain ? seldom[below( int( std::size( seldom ) ) )]
									 : rare[below( int( std::size( rare ) ) )];
		( this->*call )();
		++m_calls;
	}
	stepAll( kFrame, 0 );
	check();
}

btVector3 RandomCalls::someVector( btScalar size )
{
	btVector3 vector( some( -size, size ), some( -size, size ), some( -size, size ) );
	if ( oneIn( 12 ) )
	{
		vector[below( 3 )] = kBad[below( 4 )];
	}
	return vector;
}

btTransform RandomCalls::someTransform()
{
	btTransform t( btQuaternion( btVector3( 1, 2, some( 0, 3 ) ).normalized(), some( 0, 6 ) ), someVector( 1 ) );
	if ( oneIn( 12 ) )
	{
		t.getBasis()[below( 3 )][below( 3 )] = oneIn( 2 ) ? kBad[below( 4 )] : btScalar( 2 );
	}
	return t;
}

Material RandomCalls::someMaterial()
{
	Material material = stiff( std::pow( 10.0f, float( some( 3, 7 ) ) ) );
	material.elasticity = m_isPlain || oneIn( 3 ) ? Elasticity::Implicit : oneIn( 3 ) ? Elasticity::Automatic : Elasticity::Explicit;
	material.rigidStrain = oneIn( 3 ) ? 0.05f : 0.0f;
	if ( oneIn( 10 ) )
	{
		material.youngsModulus = oneIn( 2 ) ? -1.0f : std::numeric_limits<float>::quiet_NaN();
	}
	return material;
}

int RandomCalls::someNode( const SoftBody& body )
{
	return oneIn( 10 ) ? ( oneIn( 2 ) ? -1 - below( 3 ) : body.nodeCount() + below( 1000000 ) ) : below( body.nodeCount() );
}

SoftBody* RandomCalls::someSoft()
{
	SoftBodyWorld& world = someWorld();
	if ( oneIn( 3 ) && world.softBodyCount() > 0 )
	{
		return world.softBody( below( world.softBodyCount() ) ); // fragments too
	}
	return m_soft.empty() ? nullptr : m_soft[std::size_t( below( int( m_soft.size() ) ) )].get();
}

btRigidBody* RandomCalls::someRigid()
{
	return m_rigid.empty() ? nullptr : m_rigid[std::size_t( below( int( m_rigid.size() ) ) )].body.get();
}

void RandomCalls::removeRigid( btRigidBody* body )
{
	for ( Rigid& rigid : m_rigid )
	{
		if ( rigid.body.get() == body && rigid.world )
		{
			oneIn( 2 ) ? rigid.world->removeRigidBody( body ) : rigid.world->removeCollisionObject( body );
			rigid.world = nullptr;
		}
	}
}

// Removes or changes one of the touching bodies, or another one.
void RandomCalls::contact( const btCollisionObject* a, const btCollisionObject* b )
{
	SoftBody* const soft = SoftBody::upcast( const_cast<btCollisionObject*>( SoftBody::upcast( a ) ? a : b ) );
	const btCollisionObject* const other = SoftBody::upcast( a ) ? b : a;
	if ( !oneIn( 20 ) )
	{
		return;
	}
	SoftBody* const meant = oneIn( 3 ) ? someSoft() : soft;
	// Contacts of a body in its rigid state are Bullet's, which reads both objects after the callback.
	const bool isBullets = a == static_cast<const btCollisionObject*>( soft ) || b == static_cast<const btCollisionObject*>( soft );
	switch ( isBullets ? 3 + below( 2 ) : below( 5 ) )
	{
		case 0:
			if ( meant )
			{
				someWorld().removeSoftBody( meant );
				takeIfLeft( meant );
				++m_removed;
			}
			break;
		case 1:
			m_removed += int( std::erase_if( m_soft, [meant]( const std::unique_ptr<SoftBody>& body ) { return body.get() == meant; } ) );
			break;
		case 2:
			removeRigid( const_cast<btRigidBody*>( btRigidBody::upcast( other ) ) );
			std::erase_if( m_rigid, [other]( const Rigid& rigid ) { return rigid.body.get() == other && !rigid.world; } );
			break;
		case 3: static_cast<void>( soft->setSelfCollision( oneIn( 2 ) ) ); break;
		default:
			static_cast<void>( soft->applyImpulse( someVector( 1 ), someNode( *soft ) ) );
			static_cast<void>( soft->teleport( someTransform() ) );
	}
}

void RandomCalls::check()
{
	for ( const auto& world : m_worlds )
	{
		for ( int k = 0; k < world->softBodyCount(); ++k )
		{
			const SoftBody& body = *world->softBody( k );
			for ( int node = 0; node < body.nodeCount(); ++node )
			{
				ASSERT_TRUE( std::isfinite( body.nodePosition( node ).dot( btVector3( 1, 1, 1 ) ) ) );
			}
			ASSERT_EQ( world->getCollisionObjectArray()[body.getWorldArrayIndex()], &body );
		}
	}
	if ( m_isPlain )
	{
		for ( const auto& [ours, twin] : { std::pair( &m_bystanders->box, &m_twin->box ), std::pair( &m_bystanders->bob, &m_twin->bob ) } )
		{
			ASSERT_TRUE( ours->getWorldTransform() == twin->getWorldTransform() );
			ASSERT_EQ( ( ours->getLinearVelocity() - twin->getLinearVelocity() ).length() +
					( ours->getAngularVelocity() - twin->getAngularVelocity() ).length(),
				0 );
		}
	}
}

void RandomCalls::callbacks()
{
	forgetCallbacks();
	if ( !oneIn( 3 ) && !m_isPlain )
	{
		gContactAddedCallback = oneIn( 2 ) ? onAdded : nullptr;
		gContactProcessedCallback = oneIn( 2 ) ? onProcessed : nullptr;
		gContactStartedCallback = oneIn( 2 ) ? onStarted : nullptr;
		gContactEndedCallback = oneIn( 2 ) ? onEnded : nullptr;
	}
}

void RandomCalls::step()
{
	const btScalar times[] = { kFrame, kFrame, 2 * kFrame, kFrame / 4, 0 };
	const btScalar time = times[below( 5 )];
	const int most = below( 3 ), count = 1 + below( 6 );
	for ( int k = 0; k < count; ++k )
	{
		stepAll( time, most );
	}
}

void RandomCalls::stepAll( btScalar time, int most )
{
	for ( const auto& world : m_worlds )
	{
		world->stepSimulation( time, most );
		m_isPlain = m_isPlain && world->stepReport().substeps <= 1;
	}
	m_twinWorld ? void( m_twinWorld->stepSimulation( time, most ) ) : void();
}

template struct Bystanders<SoftBodyWorld>;
template struct Bystanders<btDiscreteDynamicsWorld>;

} // namespace pliant::test
