// Bullet's own soft bodies on the same block, in the same run: pose matching and clusters. In free fall, so that only the deformation
// models have a cost. Counter ns_per_node as in bench_step.cpp.

#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <memory>
#include <set>
#include <utility>
#include <vector>

namespace {

enum class Peer
{
	PoseMatching,
	Clusters
};

struct PeerWorld
{
	btSoftBodyRigidBodyCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher{ &configuration };
	btDbvtBroadphase broadphase;
	btSequentialImpulseConstraintSolver solver;
	btSoftRigidDynamicsWorld world{ &dispatcher, &broadphase, &solver, &configuration };
};

/// A grid of n^3 nodes, six tetrahedra a cell, an edge a link.
btSoftBody* makeGrid( btSoftBodyWorldInfo& info, int n )
{
	std::vector<btVector3> points;
	std::vector<btScalar> masses( std::size_t( n ) * n * n, btScalar( 1 ) / ( n * n * n ) );
	const auto id = [n]( int x, int y, int z ) { return ( z * n + y ) * n + x; };
	for ( int i = 0; i < n * n * n; ++i )
	{
		points.emplace_back( btScalar( i % n ) / n, btScalar( i / n % n ) / n, btScalar( i / n / n ) / n );
	}
	btSoftBody* body = new btSoftBody( &info, int( points.size() ), points.data(), masses.data() );
	std::set<std::pair<int, int>> links;
	const std::array<std::array<int, 3>, 6> paths = { { { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 2, 1, 0 } } };
	for ( int z = 0; z + 1 < n; ++z )
	{
		for ( int y = 0; y + 1 < n; ++y )
		{
			for ( int x = 0; x + 1 < n; ++x )
			{
				for ( const auto& path : paths )
				{
					int at[3] = { x, y, z };
					int corner[4] = { id( x, y, z ), 0, 0, 0 };
					for ( int k = 0; k < 3; ++k )
					{
						++at[path[k]];
						corner[k + 1] = id( at[0], at[1], at[2] );
					}
					body->appendTetra( corner[0], corner[1], corner[2], corner[3] );
					for ( int a = 0; a < 4; ++a )
					{
						for ( int b = a + 1; b < 4; ++b )
						{
							links.insert( std::minmax( corner[a], corner[b] ) );
						}
					}
				}
			}
		}
	}
	for ( const auto& link : links )
	{
		body->appendLink( link.first, link.second );
	}
	return body;
}

void bulletSoftBody( benchmark::State& state )
{
	const int n = int( state.range( 0 ) );
	const Peer peer = Peer( state.range( 1 ) );
	state.SetLabel( peer == Peer::PoseMatching ? "pose matching" : "clusters" );
	PeerWorld peerWorld;
	btSoftBody* body = makeGrid( peerWorld.world.getWorldInfo(), n );
	body->m_cfg.piterations = peer == Peer::PoseMatching ? 0 : 1;
	body->m_cfg.kMT = peer == Peer::PoseMatching ? btScalar( 0.5 ) : btScalar( 0 );
	body->m_cfg.collisions = 0;
	if ( peer == Peer::PoseMatching )
	{
		body->setPose( false, true );
	}
	else
	{
		body->generateClusters( std::max( 8, n * n * n / 64 ) );
		for ( int k = 0; k < body->clusterCount(); ++k )
		{
			body->m_clusters[k]->m_matching = btScalar( 0.5 );
		}
	}
	peerWorld.world.addSoftBody( body );
	for ( auto _ : state )
	{
		peerWorld.world.stepSimulation( btScalar( 1 ) / 60, 0 );
	}
	state.counters["nodes"] = n * n * n;
	state.counters["ns_per_node"] = benchmark::Counter(
		double( n ) * n * n * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert );
	peerWorld.world.removeSoftBody( body );
	delete body;
}
BENCHMARK( bulletSoftBody )->ArgNames( { "edge", "peer" } )->ArgsProduct( { { 6, 13, 27 }, { 0, 1 } } );

} // namespace
