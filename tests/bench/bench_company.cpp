// Scenes as in Bullet's own benchmark demo, in Bullet's world with a rigid box among the others and in ours with a soft cube of 216 nodes
// and of the same mass in its place. Counters: mean frame of both worlds, ms, and their ratio.

#include "bench_heap.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

namespace pliant {
namespace {

constexpr int kCompanyFrames = 300;
constexpr btScalar kCubeEdge = btScalar( 0.6 ); // m
constexpr btScalar kCubeMass = 216;             // kg

/// A world and the joints in it.
template <class World>
struct CompanyScene : World
{
	std::vector<std::unique_ptr<btTypedConstraint>> joints;
	btVector3 top = btVector3( 0, 0, 0 ); ///< where the cube is dropped from, m

	~CompanyScene()
	{
		for ( auto& joint : joints )
		{
			this->world.removeConstraint( joint.get() );
		}
	}
	void join( btTypedConstraint* joint )
	{
		joints.emplace_back( joint );
		this->world.addConstraint( joint, true );
	}
	static btBoxShape* box( double x, double y, double z )
	{
		return new btBoxShape( btVector3( btScalar( x ), btScalar( y ), btScalar( z ) ) );
	}
	static btVector3 at( double x, double y, double z ) { return { btScalar( x ), btScalar( y ), btScalar( z ) }; }

	/// 1 000 boxes that fall as a block.
	void addBoxes()
	{
		test::addBoxes( *this, 1000, 8, 8 );
		top = at( 1.5, 8.0, 1.4 );
	}
	/// A wall of 240 boxes, and a pyramid of 285.
	void addStacks()
	{
		for ( int k = 0; k < 240; ++k )
		{
			this->add( 8, box( 0.2, 0.1, 0.1 ), at( 0.41 * ( k % 20 ) + 0.2 * ( k / 20 % 2 ), 0.1 + 0.2 * ( k / 20 ), 3 ) );
		}
		for ( int layer = 0; layer < 9; ++layer )
		{
			const int edge = 9 - layer;
			for ( int k = 0; k < edge * edge; ++k )
			{
				this->add( 8, box( 0.2, 0.2, 0.2 ),
					at( 0.42 * ( k % edge ) + 0.21 * layer, 0.2 + 0.4 * layer, 0.42 * ( k / edge ) + 0.21 * layer - 2 ) );
			}
		}
		top = at( 1.7, 4.4, -0.3 );
	}
	/// One of 60 figures: ten limbs at hinges and cone-twist joints.
	void addFigure( const btVector3& centre )
	{
		struct Limb
		{
			double radius, height, x, y;
			int parent; ///< -1: none
			double jointX, jointY;
		};
		static const std::array<Limb, 10> limbs = { { { 0.15, 0.2, 0, 1.0, -1, 0, 0 }, { 0.15, 0.28, 0, 1.2, 0, 0, 1.15 },
			{ 0.1, 0.05, 0, 1.6, 1, 0, 1.5 }, { 0.07, 0.45, -0.18, 0.65, 0, -0.18, 0.9 }, { 0.05, 0.37, -0.18, 0.2, 3, -0.18, 0.42 },
			{ 0.07, 0.45, 0.18, 0.65, 0, 0.18, 0.9 }, { 0.05, 0.37, 0.18, 0.2, 5, 0.18, 0.42 }, { 0.05, 0.33, -0.35, 1.25, 1, -0.2, 1.4 },
			{ 0.04, 0.25, -0.35, 0.9, 7, -0.35, 1.08 }, { 0.05, 0.33, 0.35, 1.25, 1, 0.2, 1.4 } } };
		std::array<btRigidBody*, 10> body{};
		for ( std::size_t k = 0; k < limbs.size(); ++k )
		{
			const Limb& limb = limbs[k];
			body[k] = this->add(
				5, new btCapsuleShape( btScalar( limb.radius ), btScalar( limb.height ) ), centre + at( limb.x, limb.y, 0 ) );
			body[k]->setDamping( btScalar( 0.05 ), btScalar( 0.85 ) );
			if ( limb.parent >= 0 )
			{
				const Limb& parent = limbs[std::size_t( limb.parent )];
				btTransform a = btTransform::getIdentity(), b = btTransform::getIdentity();
				a.setOrigin( at( limb.jointX - parent.x, limb.jointY - parent.y, 0 ) );
				b.setOrigin( at( limb.jointX - limb.x, limb.jointY - limb.y, 0 ) );
				auto* const joint = new btConeTwistConstraint( *body[std::size_t( limb.parent )], *body[k], a, b );
				joint->setLimit( btScalar( 0.8 ), btScalar( 0.8 ), btScalar( 0.3 ) );
				this->join( joint );
			}
		}
	}
	void addFigures()
	{
		for ( int k = 0; k < 60; ++k )
		{
			addFigure( at( 0.9 * ( k % 4 ) + 0.2 * ( k / 16 % 2 ), 0.2 + 2.0 * ( k / 16 ), 0.6 * ( k / 4 % 4 ) ) );
		}
		top = at( 1.4, 9.0, 0.9 );
	}
	/// 500 convex hulls on a hilly mesh.
	void addHulls()
	{
		for ( int k = 0; k < 500; ++k )
		{
			auto* const hull = new btConvexHullShape;
			for ( int i = 0; i < 20; ++i )
			{
				const double turn = 2.4 * i, up = 1 - 2 * ( i + 0.5 ) / 20, flat = std::sqrt( 1 - up * up );
				hull->addPoint( at( 0.22 * flat * std::cos( turn ), 0.2 * up, 0.25 * flat * std::sin( turn ) ), i == 19 );
			}
			this->add( 8, hull, at( 0.55 * ( k % 8 ), 0.6 + 0.55 * ( k / 64 ), 0.6 * ( k / 8 % 8 ) ) );
		}
		top = at( 1.9, 6.0, 2.1 );
	}
};

struct HillyGround
{
	btTriangleMesh mesh;

	HillyGround()
	{
		const auto at = []( int x, int z ) {
			return btVector3( btScalar( x ), btScalar( 0.3 * std::sin( 0.9 * x ) * std::cos( 0.7 * z ) ), btScalar( z ) );
		};
		for ( int x = -15; x < 15; ++x )
		{
			for ( int z = -15; z < 15; ++z )
			{
				mesh.addTriangle( at( x, z ), at( x, z + 1 ), at( x + 1, z ) );
				mesh.addTriangle( at( x + 1, z ), at( x, z + 1 ), at( x + 1, z + 1 ) );
			}
		}
	}
};

template <class Scene>
void fill( Scene& scene, HillyGround& hills, int kind )
{
	if ( kind == 3 )
	{
		scene.add( 0, new btBvhTriangleMeshShape( &hills.mesh, true ), btVector3( 0, 0, 0 ) );
		scene.addHulls();
		return;
	}
	scene.addBoxFloor();
	kind == 0 ? scene.addBoxes() : kind == 1 ? scene.addStacks() : scene.addFigures();
}

/// kind: 0 boxes, 1 wall and pyramid, 2 figures, 3 hulls on a mesh. kPa: Young's modulus; 0: the default. Frame by frame in turn.
void company( benchmark::State& state )
{
	const int kind = int( state.range( 0 ) );
	const auto cube = test::cubeTemplate( float( kCubeEdge ), 6 );
	Material material;
	material.youngsModulus = 1e3f * float( state.range( 1 ) );
	for ( auto _ : state )
	{
		HillyGround hills;
		CompanyScene<test::WorldOf<btDiscreteDynamicsWorld>> rigid;
		CompanyScene<test::SoftWorld> soft;
		fill( rigid, hills, kind );
		fill( soft, hills, kind );
		const btScalar half = kCubeEdge / 2;
		rigid.add( kCubeMass, new btBoxShape( btVector3( half, half, half ) ), rigid.top )->setActivationState( DISABLE_DEACTIVATION );
		SoftBody* const body = soft.add( cube, soft.top, material );
		body->setActivationState( DISABLE_DEACTIVATION );
		double rigidSum = 0, softSum = 0, rigidWorst = 0, softWorst = 0;
		for ( int k = 0; k < kCompanyFrames; ++k )
		{
			const double ofRigid = test::timeOfFrame( rigid ), ofSoft = test::timeOfFrame( soft );
			rigidSum += ofRigid;
			softSum += ofSoft;
			rigidWorst = std::max( rigidWorst, ofRigid );
			softWorst = std::max( softWorst, ofSoft );
		}
		state.counters["rigid_ms"] = rigidSum / kCompanyFrames;
		state.counters["soft_ms"] = softSum / kCompanyFrames;
		state.counters["ratio"] = softSum / rigidSum;
		state.counters["worst_rigid"] = rigidWorst;
		state.counters["worst_soft"] = softWorst;
		state.counters["implicit"] = body->stepsImplicitly();
	}
}
BENCHMARK( company )
	->ArgNames( { "kind", "kPa" } )
	->ArgsProduct( { { 0, 1, 2, 3 }, { 0, 50 } } )
	->Iterations( 1 )
	->Unit( benchmark::kMillisecond );

} // namespace
} // namespace pliant
