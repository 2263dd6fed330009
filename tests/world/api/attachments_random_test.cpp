// Attachments and frames through random cuts, level changes and removals: no dangling references. A few cases by default; as
// attachments_full_test, with the label `full`, a thousand.

#include "world/test_world.h"

#include <pliant/fracture.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

#if defined( PLIANT_FULL_RUN )
constexpr int kEvents = 1000;
#else
constexpr int kEvents = 30;
#endif
constexpr int kEventsPerWorld = 10;

/// Two bars, with levels or without, attached to each other, to hooks and loads, and by frames with joints.
class RandomScene
{
public:
	explicit RandomScene( unsigned seed ) : m_random( seed )
	{
		Adaptivity adaptivity;
		adaptivity.coarseLevels = int( seed % 2 );
		Material material = test::stiff( 1e5f );
		material.density = 20.0f;
		material.elasticity = seed % 4 == 2 ? Elasticity::Implicit : Elasticity::Explicit;
		for ( const btScalar z : { btScalar( 0 ), btScalar( 0.4 ) } )
		{
			SoftBody* const bar = test.addSoft( block( 12, 4, 4, 0.1f ), at( 0, 3, z ), material, adaptivity );
			for ( int k = 0; k < 3; ++k )
			{
				const btScalar x = btScalar( 0.4 * k - 0.4 );
				hold( *bar, btVector3( x, btScalar( 3.15 ), z ), 0, at( x, btScalar( 3.5 ), z ) );
				hold( *bar, btVector3( x, btScalar( 2.85 ), z ), btScalar( 0.2 ), at( x, btScalar( 2.5 ), z ) );
			}
			addFrame( *bar, btVector3( btScalar( 0.5 ), 3, z ) );
			addFrame( *bar, btVector3( btScalar( -0.5 ), 3, z ) );
		}
		const Result<int> welded = test.world.weld( *test.soft[0], *test.soft[1], btScalar( 0.25 ) );
		EXPECT_TRUE( welded.ok() );
		EXPECT_GT( welded.value, 0 );
	}
	~RandomScene()
	{
		for ( const auto& joint : joints )
		{
			test.world.removeConstraint( joint.get() );
		}
	}

	double between( double low, double high ) { return std::uniform_real_distribution<double>( low, high )( m_random ); }
	SoftBody& anyBody() { return *test.world.softBody( int( between( 0, test.world.softBodyCount() - 1e-6 ) ) ); }

	/// Returns true if attachments may have been removed.
	bool disturb()
	{
		SoftBody& body = anyBody();
		const double kind = between( 0, 10 );
		if ( kind < 6 )
		{
			const int node = int( between( 0, body.nodeCount() - 1e-6 ) );
			const btVector3 normal( btScalar( between( -1, 1 ) ), btScalar( between( -0.4, 0.4 ) ), btScalar( between( -0.4, 0.4 ) ) );
			body.cutPlane( body.nodePosition( node ) + btVector3( btScalar( 0.03 ), 0, 0 ), normal + btVector3( btScalar( 0.01 ), 0, 0 ) );
			return false;
		}
		if ( kind < 8.5 )
		{
			const btVector3 centre = body.massCentre(), half( btScalar( between( 0.1, 0.5 ) ), 1, 1 );
			body.requestRefinement( centre - half, centre + half );
			body.setFinestLevel( int( between( 0, 1.99 ) ) );
			return false;
		}
		if ( kind < 9.3 && test.rigid.size() > 1 )
		{
			const std::size_t k = std::size_t( between( 0, double( test.rigid.size() ) - 1e-6 ) );
			test.world.removeRigidBody( test.rigid[k].get() );
			test.rigid.erase( test.rigid.begin() + std::ptrdiff_t( k ) );
			return true;
		}
		if ( test.world.softBodyCount() > 1 )
		{
			remove( body );
			return true;
		}
		return false;
	}

	void removeAll()
	{
		while ( test.world.softBodyCount() > 0 )
		{
			remove( *test.world.softBody( 0 ) );
		}
	}

	TestWorld test;
	std::vector<btRigidBody*> frames;
	std::vector<std::unique_ptr<btTypedConstraint>> joints;

private:
	void hold( SoftBody& body, const btVector3& point, btScalar mass, const btTransform& where )
	{
		EXPECT_TRUE( test.world.attach( body, point, *test.addBox( mass, btVector3( 0.05f, 0.05f, 0.05f ), where ) ).ok() );
	}
	void addFrame( SoftBody& body, const btVector3& where )
	{
		const Result<btRigidBody*> made = test.world.addFrame( body, where, btScalar( 0.25 ) );
		EXPECT_TRUE( made.ok() ) << made.status.sentence;
		frames.push_back( made.value );
		joints.push_back( std::make_unique<btPoint2PointConstraint>( *made.value, btVector3( 0, 0, 0 ) ) );
		test.world.addConstraint( joints.back().get() );
	}
	void remove( SoftBody& body )
	{
		test.world.removeSoftBody( &body );
		if ( std::none_of( test.soft.begin(), test.soft.end(), [&body]( const auto& own ) { return own.get() == &body; } ) )
		{
			delete &body; // a fragment
		}
	}

	std::mt19937 m_random;
};

TEST( Attachments, NoneDanglesThroughRandomFracturesAndLevels )
{
	int made = 0, pieces = 0, levels = 0;
	for ( unsigned seed = 1; made < kEvents; ++seed )
	{
		RandomScene scene( seed );
		SoftBodyWorld& world = scene.test.world;
		for ( int k = 0; k < kEventsPerWorld; ++k, ++made )
		{
			const int before = world.attachmentCount();
			const bool mayLose = scene.disturb();
			for ( int frame = 0; frame < 3; ++frame )
			{
				scene.test.run( 1 );
				pieces += int( world.fractureEvents().size() );
				levels += world.stepReport().levelChanges;
				ASSERT_EQ( world.stepReport().quarantined, 0 ) << "seed " << seed;
			}
			const int now = world.attachmentCount();
			ASSERT_TRUE( mayLose ? now <= before : now == before ) << "seed " << seed << ": " << before << ", " << now;
			for ( int id = 0; id < 200; ++id )
			{
				ASSERT_TRUE( std::isfinite( world.attachmentForce( id ).length() ) ) << "seed " << seed;
			}
			for ( const btRigidBody* frame : scene.frames )
			{
				SoftBody* const owner = world.frameOwner( frame );
				ASSERT_TRUE( std::isfinite( frame->getWorldTransform().getOrigin().length() ) ) << "seed " << seed;
				if ( owner ) // its object is in the world of its body
				{
					const btVector3 to = frame->getWorldTransform().getOrigin();
					ASSERT_LT( ( owner->nodePosition( owner->nearestNode( to ) ) - to ).length(), 1 ) << "seed " << seed;
				}
			}
		}
		scene.removeAll();
		EXPECT_EQ( world.attachmentCount(), 0 );
		for ( const btRigidBody* frame : scene.frames )
		{
			EXPECT_EQ( world.frameOwner( frame ), nullptr );
		}
		scene.test.run( 2 );
	}
	EXPECT_GT( pieces, kEvents / 10 );
	EXPECT_GT( levels, kEvents / 20 );
}

} // namespace
} // namespace pliant
