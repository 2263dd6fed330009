// The skin of a body whose nodes are split and merged does not jump.

#include "world/levels/adaptive_bodies.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pliant {
namespace {

using test::at;
using test::changeLevels;
using test::coarseNodes;
using test::levels;
using test::stiff;
using test::TestWorld;

/// A block with a vertex at each corner of each surface cell.
std::shared_ptr<const BodyTemplate> gridBlock( const Eigen::Vector3i& cells, float cell )
{
	std::vector<float> points;
	std::vector<std::uint32_t> triangles;
	for ( int face = 0; face < 6; ++face )
	{
		const int axis = face / 2, u = ( axis + 1 ) % 3, v = ( axis + 2 ) % 3;
		const std::uint32_t first = std::uint32_t( points.size() / 3 ), row = std::uint32_t( cells[u] + 1 );
		for ( int k = 0; k < ( cells[u] + 1 ) * ( cells[v] + 1 ); ++k )
		{
			Eigen::Vector3i at = Eigen::Vector3i::Zero();
			at[axis] = face % 2 == 0 ? 0 : cells[axis];
			at[u] = k % ( cells[u] + 1 );
			at[v] = k / ( cells[u] + 1 );
			for ( int c = 0; c < 3; ++c )
			{
				points.push_back( cell * ( float( at[c] ) - 0.5f * float( cells[c] ) ) );
			}
		}
		for ( int k = 0; k < cells[u] * cells[v]; ++k )
		{
			const std::uint32_t a = first + std::uint32_t( k / cells[u] ) * row + std::uint32_t( k % cells[u] );
			const std::uint32_t b = a + 1, c = a + row, d = c + 1;
			const std::vector<std::uint32_t> two = face % 2 == 0 ? std::vector<std::uint32_t>{ a, c, b, b, c, d }
																 : std::vector<std::uint32_t>{ a, b, c, b, d, c };
			triangles.insert( triangles.end(), two.begin(), two.end() );
		}
	}
	LatticeSettings settings;
	settings.cellSize = cell;
	auto made = BodyTemplate::build( MeshView{ points.data(), points.size() / 3, 3, triangles.data(), triangles.size() / 3 }, settings );
	EXPECT_TRUE( made.ok() ) << made.status.sentence;
	return made.value;
}

/// A beam held at one end, bent by its weight.
struct Beam
{
	static constexpr float kDiagonal = 3.394f; // sqrt( 3.2^2 + 2 0.8^2 ), m

	TestWorld test;
	SoftBody* soft = nullptr;
	std::vector<Vec3> before, now;

	Beam()
	{
		test.world.setGravity( btVector3( 0, -5, 0 ) );
		Material material = stiff( 1.8e6f );
		material.density = 300.0f;
		material.damping = 10.0f;
		material.wobbleDamping = 0.7f;
		Adaptivity settings = levels( 2 );
		settings.mergeDelay = 60.0f;
		soft = test.addSoft( gridBlock( Eigen::Vector3i( 32, 8, 8 ), 0.1f ), at( 0, 0, 0 ), material, settings );
		soft->setActivationState( DISABLE_DEACTIVATION );
		EXPECT_EQ( soft->pinNodesInside( btVector3( -2, -1, -1 ), btVector3( btScalar( -1.3 ), 1, 1 ) ), 4 );
		step();
	}
	void step()
	{
		test.run( 1 );
		before.swap( now );
		now.clear();
		const SurfaceView view = soft->surface();
		for ( int v = 0; v < view.vertexCount; ++v )
		{
			const float* p = view.positions + 3 * v;
			now.push_back( Vec3( p[0], p[1], p[2] ) + toVec3( view.origin ) );
		}
	}
	/// Returns the largest difference of a vertex's displacement in the last frame from that in the other beam, as a fraction of the
	/// diagonal.
	float jump( const Beam& other ) const
	{
		float largest = 0.0f;
		for ( std::size_t v = 0; v < now.size(); ++v )
		{
			largest = std::max( largest, ( ( now[v] - before[v] ) - ( other.now[v] - other.before[v] ) ).norm() / kDiagonal );
		}
		return largest;
	}
	float deepest() const
	{
		float deep = 0.0f;
		for ( const Vec3& p : now )
		{
			deep = std::max( deep, ( -0.4f - p.y() ) / kDiagonal );
		}
		return deep;
	}
};

bool isFree( const SoftBody& soft, int node )
{
	return !soft.isPinned( node );
}

TEST( AdaptiveSkin, LoadedBeamChangesLevelsWithoutAJump )
{
	Beam steady, changing;
	for ( int frame = 0; frame < 150; ++frame )
	{
		steady.step();
		changing.step();
	}
	std::vector<std::vector<std::uint32_t>> splits;
	// The work of gravity: the scale for energies.
	const double work = -5.0 * double( changing.soft->mass() * changing.soft->massCentre().y() );
	float worst = 0.0f, deepest = 0.0f;
	double momentum = 0.0, energy = 0.0;
	for ( int change = 0; change < 10; ++change )
	{
		// Down two levels, up two levels, and again.
		const Body& body = *changing.soft->impl().body;
		const BodySums was = body.sums();
		const bool isSplit = change / 2 % 2 == 0;
		if ( isSplit )
		{
			splits.push_back( coarseNodes( *changing.soft, isFree ) );
			changeLevels( *changing.soft, splits.back(), {} );
		}
		else
		{
			changeLevels( *changing.soft, {}, splits.back() );
			splits.pop_back();
		}
		const BodySums is = body.sums();
		const double lifted = is.mass * 5.0 * ( is.centre - was.centre ).y();
		momentum = std::max( momentum, ( is.momentum - was.momentum ).norm() / std::sqrt( 2.0 * was.mass * was.kineticEnergy ) );
		energy = std::max( energy, std::abs( is.kineticEnergy - was.kineticEnergy + lifted ) / ( work + was.kineticEnergy ) );
		for ( int frame = 0; frame < 12; ++frame )
		{
			steady.step();
			changing.step();
			worst = std::max( worst, changing.jump( steady ) );
			deepest = std::max( deepest, changing.deepest() );
		}
	}
	std::printf( "beam bent by %.1f %% of its diagonal, ten changes: the surface jumps %.4f %% of it a frame (at most 0.1), momentum %.1e "
				 "(1e-6), energy %.1e (0.01)\n",
		100.0 * double( deepest ), 100.0 * double( worst ), momentum, energy );
	EXPECT_GT( deepest, 0.03f );
	EXPECT_LT( worst, 1e-3f );
	EXPECT_LT( momentum, 1e-6 );
	EXPECT_LT( energy, 0.01 );
}

/// A bar that was pulled to 1.3 of its length, flowed plastically, and was released.
TestWorld& pullPlasticBar( TestWorld& test, int coarseLevels )
{
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	Material material = stiff( 3e5f );
	material.damping = 20.0f;
	material.yieldStrain = 0.02f;
	material.plasticCreep = 40.0f;
	SoftBody* soft = test.addSoft( gridBlock( { 16, 4, 4 }, 0.1f ), at( 0, 0, 0 ), material, levels( coarseLevels ) );
	NodeState& nodes = soft->impl().body->nodes();
	std::vector<int> ends;
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.x[i] += 0.3f * nodes.x0.x[i];
		if ( std::abs( nodes.x0.x[i] ) > 0.65f )
		{
			EXPECT_TRUE( soft->pinNode( i ).ok() );
			ends.push_back( i );
		}
	}
	test.run( 30 );
	for ( const int node : ends )
	{
		soft->releaseNode( node );
	}
	test.run( 60 );
	return test;
}

TEST( PlasticSkin, ReachesTheEndsOfABarThatWasPulled )
{
	for ( const int coarseLevels : { 0, 1 } )
	{
		TestWorld test;
		const SoftBody& soft = *pullPlasticBar( test, coarseLevels ).soft.front();
		const NodeState& nodes = soft.impl().body->nodes();
		ASSERT_TRUE( soft.impl().body->hasFlowed() );
		// The permanent set next to the ends, by which half a cell there is longer than at rest.
		float inner[2] = { 0, 0 }, outer[2] = { 0, 0 };
		for ( int i = 0; i < nodes.count; ++i )
		{
			if ( nodes.x0.x[i] > outer[0] )
			{
				outer[0] = nodes.x0.x[i];
				outer[1] = nodes.x.x[i];
			}
		}
		for ( int i = 0; i < nodes.count; ++i )
		{
			if ( nodes.x0.x[i] > inner[0] && nodes.x0.x[i] < outer[0] - 0.01f )
			{
				inner[0] = nodes.x0.x[i];
				inner[1] = nodes.x.x[i];
			}
		}
		const float set = ( outer[1] - inner[1] ) / ( outer[0] - inner[0] );
		const SurfaceView view = soft.surface();
		float end = 0.0f;
		for ( int v = 0; v < view.vertexCount; ++v )
		{
			end = std::max( end, view.positions[3 * v] );
		}
		const float wanted = outer[1] + set * ( 0.8f - outer[0] );
		std::printf(
			"%d levels: set %.3f at the end, which is at %.4f (%.4f)\n", coarseLevels, double( set ), double( end ), double( wanted ) );
		EXPECT_GT( set, 1.1f );
		EXPECT_NEAR( end, wanted, 0.1f * 0.5f * 0.1f ) << "a tenth of half a cell";
	}
}

} // namespace
} // namespace pliant
