// Reference implementations of the fast computations in a change of levels: tables rebuilt, blends through eigenvalues.

#include "body/body.h"
#include "body/levels/levels.h"
#include "matching/step/lattice_matcher.h"
#include "support/explicit_material.h"
#include "support/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace pliant {
namespace {

void expectSameTables( const RegionTables& got, const RegionTables& wanted )
{
	EXPECT_EQ( got.matrix->start, wanted.matrix->start );
	EXPECT_EQ( got.matrix->member, wanted.matrix->member );
	EXPECT_EQ( got.matrix->mass, wanted.matrix->mass );
	EXPECT_EQ( got.matrix->fraction, wanted.matrix->fraction );
	EXPECT_EQ( got.matrix->unit, wanted.matrix->unit );
	ASSERT_EQ( got.plan != nullptr, wanted.plan != nullptr );
	if ( got.plan )
	{
		EXPECT_EQ( got.plan->start, wanted.plan->start );
		EXPECT_EQ( got.plan->term, wanted.plan->term );
	}
	EXPECT_EQ( got.pull, wanted.pull );
	EXPECT_EQ( got.beta, wanted.beta );
	EXPECT_EQ( got.eta, wanted.eta );
	EXPECT_EQ( got.moments.regionWeight, wanted.moments.regionWeight );
	EXPECT_EQ( got.moments.nodeWeight, wanted.moments.nodeWeight );
	for ( int k = 0; k < 6; ++k )
	{
		EXPECT_EQ( got.moments.moment[k], wanted.moments.moment[k] );
		EXPECT_EQ( got.moments.inverseMoment[k], wanted.moments.inverseMoment[k] );
		EXPECT_EQ( got.outOfPlane[k], wanted.outOfPlane[k] );
	}
	for ( int k = 0; k < 9; ++k )
	{
		EXPECT_EQ( got.blend[k], wanted.blend[k] );
	}
}

/// Random splits and merges with 1 and 3 threads: all tables equal rebuilt ones.
void expectChangesAsFromNothing( const Adaptivity& settings, Material material )
{
	const auto lattice = std::make_shared<const Lattice>( test::makeBlobLattice( 18, 0.05f, 6 ) );
	const std::shared_ptr<const LevelBase> base = buildLevelBase( *lattice, material, settings );
	const std::vector<float> everywhere;
	const std::unique_ptr<TaskRunner> pool = createThreadPool( 3 );
	for ( TaskRunner* tasks : { static_cast<TaskRunner*>( nullptr ), pool.get() } )
	{
		Levels changing( base, *lattice, material, settings, everywhere, firstCut( base->octree, settings ) );
		NodeState nodes;
		changing.fillNodes( nodes, material.density );
		LatticeMatcher matcher( *lattice, material, changing.tables() );
		std::mt19937 random( 5 );
		std::vector<std::uint32_t> taken;
		for ( int round = 0; round < 8; ++round )
		{
			std::vector<std::uint32_t> split, merge;
			for ( const std::uint32_t node : changing.cut().node )
			{
				if ( changing.octree().levelOf( node ) == 2 && random() % 3 == 0 )
				{
					split.push_back( node );
				}
			}
			for ( const std::uint32_t node : taken )
			{
				( random() % 2 == 0 ? merge : split ).push_back( node );
			}
			split.erase( std::remove_if( split.begin(), split.end(),
							 [&taken]( std::uint32_t node ) { return std::find( taken.begin(), taken.end(), node ) != taken.end(); } ),
				split.end() );
			changing.change( nodes, matcher, material, split, merge, tasks );
			taken.erase( std::remove_if( taken.begin(), taken.end(),
							 [&merge]( std::uint32_t node ) { return std::find( merge.begin(), merge.end(), node ) != merge.end(); } ),
				taken.end() );
			taken.insert( taken.end(), split.begin(), split.end() );
			const LevelRegions regions = buildLevelRegions( RegionInput{ *base, *lattice, material, settings }, changing.cut() );
			expectSameTables( *changing.tables(),
				*buildLevelTables( *base, *lattice, changing.cut(), regions, LevelSettings{ material, settings, everywhere } ) );
		}
		EXPECT_FALSE( taken.empty() );
	}
}

TEST( Levels, OfEveryRegionRuleChangeToTheTablesOfANewBodyOnAnyNumberOfThreads )
{
	Adaptivity ours;
	ours.coarseLevels = 3;
	for ( const Adaptivity& settings : { ours, steinemannAdaptivity( 3 ), ohtaAdaptivity( 3 ) } )
	{
		for ( const Weights weights : { Weights::Conserving, Weights::Literal } )
		{
			Material material = test::explicitMaterial();
			material.weights = weights;
			expectChangesAsFromNothing( settings, material );
			material.regionHalfWidth = 2;
			expectChangesAsFromNothing( settings, material );
		}
	}
}

/// The deformation of regions, as the skin reads it around a change: computed for a few regions it is bit-identical to that of all at once,
/// and a region that a change has not measured again keeps its deformation.
TEST( Levels, StretchOfAFewRegionsEqualsThatOfAllAndIsKept )
{
	const auto lattice = std::make_shared<const Lattice>( test::makeBlobLattice( 18, 0.05f, 6 ) );
	const Material material = test::explicitMaterial();
	Adaptivity settings;
	settings.coarseLevels = 3;
	const std::vector<float> everywhere;
	const std::shared_ptr<const LevelBase> base = buildLevelBase( *lattice, material, settings );
	Levels levels( base, *lattice, material, settings, everywhere, firstCut( base->octree, settings ) );
	NodeState nodes;
	levels.fillNodes( nodes, material.density );
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3 at = nodes.x0.get( i );
		nodes.x.set( i, at + Vec3( 0.3f * at.y() * at.y(), 0.2f * at.x(), -0.1f * at.z() * at.x() ) );
	}
	LatticeMatcher matcher( *lattice, material, levels.tables() );
	matcher.reset( nodes, Eigen::Quaterniond::Identity() );
	std::vector<float> before( std::size_t( nodes.padded ) * 9 );
	matcher.deformations( nodes, before.data() );

	std::vector<std::uint32_t> split;
	for ( const std::uint32_t node : levels.cut().node )
	{
		if ( levels.octree().levelOf( node ) > 1 && split.size() < 2 )
		{
			split.push_back( node );
		}
	}
	levels.change( nodes, matcher, material, split, {} );
	const LevelChange& change = levels.lastChange();
	ASSERT_FALSE( change.measured.empty() );
	ASSERT_LT( change.measured.size(), std::size_t( nodes.count ) );
	std::vector<float> all( std::size_t( nodes.padded ) * 9 ), few( change.measured.size() * 9 );
	matcher.deformations( nodes, all.data() );
	matcher.deformationsOf( nodes, change.measured, few.data() );
	std::size_t next = 0;
	for ( std::uint32_t i = 0; i < std::uint32_t( nodes.count ); ++i )
	{
		const bool isMeasured = next < change.measured.size() && change.measured[next] == i;
		for ( std::size_t k = 0; k < 9; ++k )
		{
			if ( isMeasured )
			{
				EXPECT_EQ( few[9 * next + k], all[9 * i + k] );
			}
			else
			{
				EXPECT_NEAR( before[9 * change.source[i] + k], all[9 * i + k], 1e-5f );
			}
		}
		next += isMeasured ? 1 : 0;
	}
	EXPECT_EQ( next, change.measured.size() );
}

/// Touched big nodes come in the order of their contacts, not by index. The deformations must not depend on that order, also where a node
/// follows one of a later tile.
TEST( Levels, StretchOfAFewRegionsIsTheSameInAnyOrder )
{
	const auto lattice = std::make_shared<const Lattice>( test::makeBlobLattice( 18, 0.05f, 6 ) );
	Adaptivity settings;
	settings.coarseLevels = 1;
	const std::unique_ptr<Body> body = std::move( Body::create( lattice, test::explicitMaterial(), {}, nullptr, settings ).value );
	const int count = body->nodeCount();
	ASSERT_GT( count, 2 * 64 );
	for ( int i = 0; i < count; ++i )
	{
		const Vec3 at = body->nodes().x0.get( i );
		body->nodes().x.set( i, at + Vec3( 0.3f * at.y() * at.y(), 0.2f * at.x(), -0.1f * at.z() * at.x() ) );
	}
	std::vector<float> all( 9 * std::size_t( body->nodes().padded ) );
	body->nodeDeformations( all.data() );
	std::vector<std::uint32_t> which;
	for ( int k = 0; k < count; k += 3 )
	{
		which.push_back( std::uint32_t( k ) );
	}
	std::mt19937 random( 11 );
	for ( int round = 0; round < 3; ++round )
	{
		round == 0 ? std::reverse( which.begin(), which.end() ) : std::shuffle( which.begin(), which.end(), random );
		std::vector<float> few( 9 * which.size() );
		body->nodeDeformationsOf( which, few.data() );
		for ( std::size_t k = 0; k < which.size(); ++k )
		{
			EXPECT_TRUE( std::equal( &few[9 * k], &few[9 * k] + 9, &all[9 * which[k]] ) ) << which[k];
		}
	}
}

TEST( Levels, FastBlendsEqualThoseByEigenvalues )
{
	std::mt19937 random( 9 );
	std::normal_distribution<double> normal;
	int limited = 0;
	for ( int round = 0; round < 1000; ++round )
	{
		const auto some = [&] { return Eigen::Matrix3d::NullaryExpr( [&] { return normal( random ); } ).eval(); };
		const Eigen::Matrix3d a = some(), b = some();
		const Eigen::Matrix3d moment = a * a.transpose() + 0.3 * Eigen::Matrix3d::Identity();
		const Eigen::Matrix3d fine = 0.2 * ( b * b.transpose() ) + 0.1 * moment;
		const Eigen::Matrix3d difference = energyBlend( fine, moment ) - energyBlendByDirections( fine, moment );
		EXPECT_LT( difference.norm(), 1e-9 * ( moment.inverse() * fine ).norm() + 1e-9 );
		limited += ( moment.inverse() * fine - energyBlend( fine, moment ) ).norm() > 1e-6 ? 1 : 0;
	}
	EXPECT_GT( limited, 50 ); // both methods were exercised
	EXPECT_LT( limited, 950 );
}

/// x + F ( x0_c - x0 ), though F is measured only where a node has more than one cell.
TEST( LevelChanges, CellsFollowTheirNodesRegions )
{
	for ( int count = 1; count < 4; ++count )
	{
		const auto lattice = std::make_shared<const Lattice>( test::makeBlobLattice( 16, 0.05f, 3 ) );
		Adaptivity settings;
		settings.coarseLevels = count;
		const std::unique_ptr<Body> body = std::move( Body::create( lattice, test::explicitMaterial(), {}, nullptr, settings ).value );
		std::mt19937 random( 7 );
		const auto any = [&random] { return float( random() % 1000 ) * 2e-5f - 0.01f; };
		for ( int i = 0; i < body->nodeCount(); ++i )
		{
			body->nodes().x.set( i, body->nodes().x.get( i ) + Vec3( any(), any(), any() ) );
		}
		std::vector<float> gradients( 9 * std::size_t( body->nodes().padded ) );
		body->nodeDeformations( gradients.data() );
		const std::vector<Vec3d> positions = body->cellPositions();
		int moved = 0;
		for ( std::uint32_t cell = 0; cell < std::uint32_t( lattice->cellCount() ); ++cell )
		{
			const int node = body->nodeOfCell( cell );
			const Vec3 arm = lattice->restCentre[cell] - body->nodes().x0.get( node );
			const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> f( gradients.data() + 9 * std::size_t( node ) );
			const Vec3 position = body->nodes().x.get( node ) + f * arm;
			EXPECT_EQ( positions[cell], position.cast<double>() );
			moved += arm.isZero( 0.0f ) ? 0 : 1;
		}
		EXPECT_GT( moved, 100 );
		EXPECT_LT( moved, lattice->cellCount() );
	}
}

} // namespace
} // namespace pliant
