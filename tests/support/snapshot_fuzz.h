#pragma once

// Damaged snapshots: random bytes, lengths and numbers, with a corrected checksum or without. A load must refuse them and change nothing,
// or produce a world that can be stepped.

#include "support/random_impacts.h"
#include "support/snapshots.h"
#include "world/io/snapshot_format.h"
#include "world/test_world.h"

#include <BulletCollision/CollisionDispatch/btGhostObject.h>

namespace pliant::test {

/// A small world with everything that a snapshot can hold.
inline void buildSmallWorld( TestWorld& world )
{
	static const std::shared_ptr<const BodyTemplate> shape = block( 4, 3, 3, 0.05f );
	world.addFloor();
	btRigidBody* const ball = world.add( 1, new btSphereShape( 0.05f ), at( 0, 0.5f, 0 ) );
	for ( int k = 0; k < 4; ++k )
	{
		Material material = stiff( 3e4f );
		material.elasticity = k == 1 ? Elasticity::Implicit : Elasticity::Explicit;
		material.yieldStrain = k == 2 ? 0.02f : 0.0f;
		Adaptivity levels;
		levels.coarseLevels = k == 3 ? 1 : 0;
		SoftBody* const body = world.addSoft( shape, at( 0.25f * float( k - 1 ), 0.15f, 0.02f * float( k ) ), material, levels );
		static_cast<void>( body->setLinearVelocity( btVector3( 0, -4, 0 ) ) );
		Fracture fracture;
		fracture.rule = k < 2 ? BreakRule::Plane : BreakRule::Distance;
		fracture.breakStrain = 0.15f;
		static_cast<void>( body->setFracture( fracture ) );
		static_cast<void>( body->setSelfCollision( k == 0 ) );
	}
	SoftBody& first = *world.soft[0];
	static_cast<void>( first.cutPlane( btVector3( -0.25f, 0.15f, 0 ), btVector3( 1, 0.1f, 0 ), SIMD_INFINITY ) );
	static_cast<void>( world.world.attach( *world.soft[1], btVector3( 0, 0.2f, 0 ), *ball ) );
	static_cast<void>( world.soft[2]->pinNodeToBody( 0, ball ) );
	world.run( 6 );
	world.soft[3]->requestRefinement( btVector3( -9, -9, -9 ), btVector3( 9, 9, 9 ) ); // waits for the next step
}

/// A character's ghost among the bodies, with contacts in its own pairs.
struct GhostAmongBodies
{
	btGhostPairCallback callback;
	btSphereShape shape = btSphereShape( btScalar( 0.2 ) );
	btPairCachingGhostObject ghost;

	void join( TestWorld& to )
	{
		to.world.getPairCache()->setInternalGhostPairCallback( &callback );
		ghost.setCollisionShape( &shape );
		ghost.setCollisionFlags( btCollisionObject::CF_CHARACTER_OBJECT );
		ghost.setWorldTransform( at( 0.3f, 0.25f, 0 ) );
		to.world.addCollisionObject( &ghost, btBroadphaseProxy::CharacterFilter, btBroadphaseProxy::AllFilter );
	}
	void look( TestWorld& in )
	{
		in.parts.dispatcher.dispatchAllCollisionPairs( ghost.getOverlappingPairCache(), in.world.getDispatchInfo(), &in.parts.dispatcher );
		EXPECT_GT( ghost.getOverlappingPairCache()->getNumOverlappingPairs(), 2 );
	}
};

class SnapshotFuzz
{
public:
	explicit SnapshotFuzz( unsigned seed ) : m_random( seed )
	{
		m_ghost.join( m_world );
		buildSmallWorld( m_world );
		m_ghost.look( m_world );
		m_whole = savedWorld( m_world.world, true );
		m_state = savedWorld( m_world.world );
		m_then = stateOf( m_world.world );
		m_body = saveBody( *m_world.world.softBody( 0 ) ).value;
		m_template = saveTemplate( m_world.world.softBody( 0 )->bodyTemplate() ).value;
	}

	int accepted = 0, refused = 0;

	/// Damages one snapshot, loads it, and checks the world.
	void once()
	{
		switch ( number( 6 ) )
		{
			case 0: note( loadTemplate( damaged( m_template, SnapshotKind::Template ) ).status ); break;
			case 1: tryBody(); break;
			default: tryWorld( number( 2 ) == 0 ? m_whole : m_state ); break;
		}
	}

private:
	std::size_t number( std::size_t below ) { return std::size_t( m_random.between( 0, 1 ) * btScalar( below ) * btScalar( 0.999999 ) ); }

	void note( const Status& status )
	{
		++( status.ok() ? accepted : refused );
		EXPECT_TRUE( status.ok() || !status.sentence.empty() );
	}

	void change( Bytes& bytes )
	{
		const std::size_t at = number( bytes.size() );
		switch ( number( 6 ) )
		{
			case 0: bytes.resize( at ); break;
			case 1: bytes[at] ^= std::byte( 1u << number( 8 ) ); break;
			case 2: {
				static const std::uint32_t values[] = {
					0, 1, 2, 0xffffffffu, 0x7fffffffu, 0x80000000u, 0x7fc00000u, 0x7f800000u, 0x7149f2cau };
				const std::uint32_t value = values[number( std::size( values ) )];
				std::memcpy( bytes.data() + at, &value, std::min( sizeof( value ), bytes.size() - at ) );
				break;
			}
			case 3:
				bytes.erase(
					bytes.begin() + std::ptrdiff_t( at ), bytes.begin() + std::ptrdiff_t( std::min( bytes.size(), at + number( 64 ) ) ) );
				break;
			case 4: bytes.insert( bytes.begin() + std::ptrdiff_t( at ), number( 64 ), std::byte( number( 256 ) ) ); break;
			default: {
				const std::size_t from = number( m_state.size() ),
								  count = std::min( { number( 256 ), bytes.size() - at, m_state.size() - from } );
				std::copy_n( m_state.begin() + std::ptrdiff_t( from ), count, bytes.begin() + std::ptrdiff_t( at ) );
			}
		}
	}

	Bytes damaged( Bytes bytes, SnapshotKind kind )
	{
		constexpr std::size_t kHeader = 40;
		for ( std::size_t k = 1 + number( 3 ); k-- > 0 && !bytes.empty(); )
		{
			change( bytes );
		}
		if ( number( 4 ) != 0 && bytes.size() > kHeader )
		{
			endSnapshot( bytes, kind );
			bytes = foreign( std::move( bytes ) );
		}
		return bytes;
	}

	void tryBody()
	{
		SoftBodyResult made = loadBody( damaged( m_body, SnapshotKind::Body ) );
		note( made.status );
		if ( made.ok() )
		{
			m_world.world.addSoftBody( made.value.get() );
			m_world.run( 1 );
			made.value.reset();
			reset();
		}
	}

	void tryWorld( const Bytes& snapshot )
	{
		const auto restored = restoreWorld( m_world.world, damaged( snapshot, SnapshotKind::World ) );
		note( restored.status );
		if ( restored.ok() )
		{
			m_world.run( 1 );
			reset();
		}
		else
		{
			EXPECT_TRUE( areEqual( stateOf( m_world.world ), m_then ) ) << restored.status.sentence;
		}
	}

	void reset()
	{
		const auto restored = restoreWorld( m_world.world, m_state );
		ASSERT_TRUE( restored.ok() ) << restored.status.sentence;
	}

	Random m_random;
	GhostAmongBodies m_ghost; // outlives the world
	TestWorld m_world;
	Bytes m_whole, m_state, m_then, m_body, m_template;
};

} // namespace pliant::test
