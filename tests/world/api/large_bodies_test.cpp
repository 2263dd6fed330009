// A body with more nodes than one task's range is divided among the threads: its nodes into ranges, its tree into branches. The results
// must not depend on the number of threads.

#include "pliant/task_runner.h"
#include "world/levels/adaptive_bodies.h"
#include "world/step/soft_body_system.h"

#include <limits>
#include <memory>
#include <random>
#include <vector>

namespace pliant::test {
namespace {

/// Returns bit-exact positions of the nodes and the skin of a large body that falls on a small one and is hit.
std::vector<float> fall( int threads )
{
	TestWorld test;
	test.world.setThreadCount( threads );
	test.addFloor();
	SoftBody* const large = test.addSoft( block( 16, 16, 16, 0.1f ), at( 0, btScalar( 1.3 ), 0 ), stiff( 2e4f ) );
	test.addSoft( block( 3, 3, 3, 0.1f ), at( btScalar( 0.3 ), btScalar( 0.16 ), 0 ) );
	test.addBox( 20, btVector3( 0.2f, 0.2f, 0.2f ), at( btScalar( 0.3 ), btScalar( 2.5 ), 0 ) );
	EXPECT_TRUE( large->applyCentralForce( btVector3( 0, 0, 200 ) ).ok() );
	std::vector<float> state;
	for ( int frame = 0; frame < 30; ++frame )
	{
		test.run( 1 );
		const SurfaceView skin = large->surface();
		state.insert( state.end(), skin.positions, skin.positions + 3 * skin.vertexCount );
		state.push_back( float( large->massCentre().y() ) );
		state.push_back( float( large->impl().meanSquareSpeed ) );
	}
	for ( const auto& body : test.soft )
	{
		const NodeState& nodes = body->impl().body->nodes();
		for ( const AlignedArray<float>* of : { &nodes.x.x, &nodes.x.y, &nodes.x.z, &nodes.v.x, &nodes.v.y, &nodes.v.z } )
		{
			state.insert( state.end(), of->begin(), of->end() );
		}
	}
	return state;
}

TEST( LargeBodies, AreTheSameForAnyNumberOfThreads )
{
	const std::vector<float> one = fall( 1 );
	EXPECT_EQ( fall( 2 ), one );
	EXPECT_EQ( fall( 5 ), one );
}

TEST( LargeBodies, StopAtABadNumberInAnyNode )
{
	for ( const int node : { 0, 1500, 4095 } )
	{
		TestWorld test;
		test.world.setThreadCount( 2 );
		SoftBody* const large = test.addSoft( block( 16, 16, 16, 0.1f ), at( 0, 0, 0 ) );
		SoftBody* const small = test.addSoft( block( 3, 3, 3, 0.1f ), at( 9, 0, 0 ) );
		test.run( 3 );
		large->impl().body->nodes().v.y[std::size_t( node )] = std::numeric_limits<float>::infinity();
		test.run( 3 );
		EXPECT_FALSE( large->isHealthy() ) << "node " << node;
		EXPECT_TRUE( small->isHealthy() );
		EXPECT_EQ( test.world.stepReport().quarantined, 1 );
	}
}

// The bad number may be in any range of nodes: the body stops before an invalid box reaches the broadphase and affects other bodies.
TEST( LargeBodies, StopBeforeABadNumberReachesBullet )
{
	for ( const int node : { 0, 1500, 4095 } )
	{
		TestWorld test;
		test.world.setThreadCount( 2 );
		SoftBody* const large = test.addSoft( block( 16, 16, 16, 0.1f ), at( 0, 0, 0 ) );
		test.run( 1 );
		large->impl().body->nodes().v.y[std::size_t( node )] = std::numeric_limits<float>::quiet_NaN();
		SoftBodySystem& system = *large->impl().system;
		system.beginStep( kFrame, 1 );
		system.accelerate( kFrame, 0 );
		EXPECT_FALSE( large->isHealthy() ) << "node " << node;
		EXPECT_EQ( system.report.quarantined, 1 );
	}
}

/// Expects every inner box to be the union of its children's, to the bit.
void expectTight( const NodeShape& shape, int& inner )
{
	std::vector<const btDbvtNode*> stack( 1, shape.tree().m_root );
	for ( inner = 0; !stack.empty(); )
	{
		const btDbvtNode* const node = stack.back();
		stack.pop_back();
		if ( node->isinternal() )
		{
			btDbvtVolume both;
			Merge( node->childs[0]->volume, node->childs[1]->volume, both );
			ASSERT_EQ( ( both.Mins() - node->volume.Mins() ).length2(), 0 );
			ASSERT_EQ( ( both.Maxs() - node->volume.Maxs() ).length2(), 0 );
			stack.push_back( node->childs[0] );
			stack.push_back( node->childs[1] );
			++inner;
		}
	}
}

// Also where trees replaced leaves, and where spheres were removed.
TEST( LargeBodies, TreesFollowTheirNodesOnAllThreads )
{
	const std::unique_ptr<TaskRunner> threads = createThreadPool( 3 );
	TestWorld test;
	SoftBody* const soft = test.addSoft( block( 20, 20, 20, 0.1f ), at( 0, 0, 0 ), stiff( 1e5f ), levels( 2 ) );
	std::mt19937 random( 3 );
	int most = 0;
	std::vector<std::vector<std::uint32_t>> splits;
	for ( int round = 0; round < 6; ++round )
	{
		if ( round < 4 )
		{
			splits.push_back( coarseNodes( *soft, anyNode ) );
			if ( round < 2 )
			{
				splits.back().resize( splits.back().size() / 2 );
			}
			changeLevels( *soft, splits.back(), {} );
		}
		else
		{
			changeLevels( *soft, {}, splits.back() );
			splits.pop_back();
		}
		NodeState& nodes = soft->impl().body->nodes();
		for ( int i = 0; i < nodes.count; ++i )
		{
			nodes.x.y[std::size_t( i )] += float( random() % 1000 ) * 1e-4f;
		}
		soft->impl().shape->place( nodes, soft->impl().shapeShift, threads.get() );
		soft->impl().shape->freshen();
		int inner = 0;
		expectTight( *soft->impl().shape, inner );
		most = std::max( most, inner );
	}
	EXPECT_GT( most, 2048 ) << "too few nodes to divide among threads";
}

} // namespace
} // namespace pliant::test
