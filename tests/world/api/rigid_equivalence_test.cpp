// Without a soft body a world over one of Bullet's is that world, bit for bit: fourteen kinds of scenes, 1 000 steps each, in both.

#include "support/bullet_worlds.h"
#include "support/rigid_scenes.h"

namespace pliant {
namespace {

using test::Kind;
using test::Scene;

template <class Base, class World>
void record( const Kind& kind, std::vector<btScalar>& track )
{
	test::PartsOf<Base> parts;
	const std::unique_ptr<World> world = parts.template make<World>();
	Scene scene( *world );
	kind.build( scene );
	for ( int frame = 0; frame < 1000; ++frame )
	{
		if ( scene.everyFrame )
		{
			scene.everyFrame( scene, frame );
		}
		world->stepSimulation( test::kFrame, 2, test::kFrame );
		track.push_back( btScalar( parts.dispatcher.getNumManifolds() ) );
		for ( const auto& object : scene.objects )
		{
			const btTransform& now = object->getWorldTransform();
			for ( int k = 0; k < 3; ++k )
			{
				track.insert( track.end(), { now.getOrigin()[k], now.getBasis()[k].x(), now.getBasis()[k].y(), now.getBasis()[k].z() } );
			}
		}
	}
}

template <class Base, class World>
void compare( const Kind& kind )
{
	std::vector<btScalar> theirs, ours;
	record<Base, Base>( kind, theirs );
	record<Base, World>( kind, ours );
	ASSERT_EQ( theirs.size(), ours.size() );
	std::size_t differences = 0;
	for ( std::size_t k = 0; k < ours.size(); ++k )
	{
		differences += theirs[k] == ours[k] ? 0 : 1;
	}
	EXPECT_EQ( differences, 0u ) << "of " << ours.size() << " numbers";
}

class RigidScene : public testing::TestWithParam<Kind>
{};

TEST_P( RigidScene, IsBulletsOwnBitForBit )
{
	compare<btDiscreteDynamicsWorld, SoftBodyWorld>( GetParam() );
}

TEST_P( RigidScene, IsTheMultithreadedWorldsBitForBit )
{
	compare<btDiscreteDynamicsWorldMt, SoftBodyWorldOver<btDiscreteDynamicsWorldMt>>( GetParam() );
}

TEST_P( RigidScene, IsTheMultiBodyWorldsBitForBit )
{
	compare<btMultiBodyDynamicsWorld, SoftBodyWorldOver<btMultiBodyDynamicsWorld>>( GetParam() );
}

TEST_P( RigidScene, IsTheSoftRigidWorldsBitForBit )
{
	compare<btSoftRigidDynamicsWorld, SoftBodyWorldOver<btSoftRigidDynamicsWorld>>( GetParam() );
}

INSTANTIATE_TEST_SUITE_P( All, RigidScene, testing::ValuesIn( test::kRigidKinds ),
	[]( const testing::TestParamInfo<Kind>& kind ) { return std::string( kind.param.name ); } );

} // namespace
} // namespace pliant
