// Each vertex follows the material behind it, and none across a gap.

#include "surface/skin_case.h"

#include "lattice/region.h"

#include <gtest/gtest.h>

#include <chrono>

namespace pliant {
namespace {

using test::SkinCase;

/// Weights of every vertex sum to 1, are not negative, and belong to different cells.
void expectSound( const SkinCase& it )
{
	ASSERT_EQ( it.binding.start.size(), it.mesh.vertexCount() + 1 );
	for ( int v = 0; v < it.vertexCount(); ++v )
	{
		double sum = 0.0;
		ASSERT_LT( it.binding.start[v], it.binding.start[v + 1] );
		for ( std::uint32_t k = it.binding.start[v]; k < it.binding.start[v + 1]; ++k )
		{
			EXPECT_GT( it.binding.weight[k], 0.0f );
			EXPECT_LT( int( it.binding.node[k] ), it.nodes.count );
			EXPECT_TRUE( k == it.binding.start[v] || it.binding.node[k - 1] < it.binding.node[k] );
			sum += it.binding.weight[k];
		}
		EXPECT_NEAR( sum, 1.0, 1e-6 );
	}
}

/// Number of the connected part that each cell belongs to, by its lowest cell.
std::vector<int> partOfCell( const Lattice& lattice )
{
	std::vector<int> part( lattice.cellCount(), -1 );
	for ( int seed = 0; seed < lattice.cellCount(); ++seed )
	{
		std::vector<int> open( 1, seed );
		while ( !open.empty() )
		{
			const int i = open.back();
			open.pop_back();
			if ( part[i] >= 0 )
			{
				continue;
			}
			part[i] = seed;
			open.insert( open.end(), lattice.linkTo.begin() + lattice.linkStart[i], lattice.linkTo.begin() + lattice.linkStart[i + 1] );
		}
	}
	return part;
}

/// Two parts that are not linked, vertices of the first before those of the second: each vertex follows its own part only.
void expectPartsApart( const SkinCase& it, int verticesOfFirst, const std::function<bool( const Vec3& )>& isOfFirst )
{
	const std::vector<int> part = partOfCell( it.lattice() );
	ASSERT_EQ( countComponents( it.lattice() ), 2 );
	std::vector<std::uint8_t> cellOfFirst( it.nodes.count );
	for ( int i = 0; i < it.nodes.count; ++i )
	{
		cellOfFirst[i] = isOfFirst( it.nodes.x0.get( i ) + it.lattice().massCentre.cast<float>() );
	}
	int wrong = 0;
	for ( int v = 0; v < it.vertexCount(); ++v )
	{
		for ( std::uint32_t k = it.binding.start[v]; k < it.binding.start[v + 1]; ++k )
		{
			wrong += cellOfFirst[it.binding.node[k]] != ( v < verticesOfFirst );
		}
	}
	EXPECT_EQ( wrong, 0 );
}

class Binding : public testing::TestWithParam<Skinning>
{};

INSTANTIATE_TEST_SUITE_P( Kinds, Binding, testing::Values( Skinning::NearbyNodes, Skinning::Trilinear ),
	[]( const auto& kind ) { return kind.param == Skinning::Trilinear ? "Trilinear" : "NearbyNodes"; } );

TEST_P( Binding, IsSoundOnManyShapes )
{
	expectSound( SkinCase( test::makeBox( { 0, 0, 0 }, { 1, 1, 1 } ), 0.13, GetParam() ) );
	expectSound( SkinCase( test::makeTorus( 1.0, 0.1, 30, 12 ), 0.15, GetParam() ) ); // thinner than a cell here and there
	expectSound( SkinCase( test::makeGlob( 1.0, 20 ), 0.12, GetParam() ) );
	expectSound( SkinCase( test::makeBeam( 2.0, 0.05, 20 ), 0.2, GetParam() ) );           // thinner than a cell
	expectSound( SkinCase( test::makeBox( { 0, 0, 0 }, { 1, 1, 1 } ), 3.0, GetParam() ) ); // one cell
}

TEST_P( Binding, TwoFingersInNeighbouringCellsDoNotDragEachOther )
{
	const test::Mesh first = test::makeBox( { 0.0, 0, 0 }, { 0.27, 0.3, 1.0 }, 8 );
	const test::Mesh both = test::joined( first, test::makeBox( { 0.33, 0, 0 }, { 0.6, 0.3, 1.0 }, 8 ) );
	SkinCase it( both, 0.1, GetParam() );
	expectPartsApart( it, int( first.vertexCount() ), []( const Vec3& x ) { return x.x() < 0.3f; } );

	// One part is pulled away: the skin of the other stays the same to the bit.
	it.skinIt();
	const std::vector<float> before = it.positions;
	for ( int i = 0; i < it.nodes.count; ++i )
	{
		if ( it.nodes.x0.x[i] + it.lattice().massCentre.x() > 0.3f )
		{
			it.nodes.x.x[i] += 1.0f;
		}
	}
	it.skinIt();
	for ( int v = 0; v < it.vertexCount(); ++v )
	{
		const float moved = v < int( first.vertexCount() ) ? 0.0f : 1.0f;
		EXPECT_NEAR( it.positions[3 * std::size_t( v )] - before[3 * std::size_t( v )], moved, 1e-5f );
	}
}

TEST_P( Binding, TwoPartsWithinOneLayerOfCellsAreToldApartByTheirSides )
{
	// A thick plate and a thin one close above it; both cross the same layer of cells.
	const test::Mesh thick = test::makeBox( { 0, 0, 0.00 }, { 1.0, 1.0, 0.16 }, 10 );
	const test::Mesh both = test::joined( thick, test::makeBox( { 0, 0, 0.19 }, { 1.0, 1.0, 0.24 }, 10 ) );
	for ( const bool isFlipped : { false, true } ) // inverted: the side of the material is found nevertheless
	{
		SkinCase it( isFlipped ? test::flipped( both ) : both, 0.12, GetParam() );
		expectPartsApart( it, int( thick.vertexCount() ), []( const Vec3& x ) { return x.z() < 0.175f; } );
	}
}

TEST( BindingAcrossACrack, ReachesOnlyWhatLinksJoin )
{
	// A U: two arms joined at the far end. Near the tips an arm's skin must not follow the other arm, although both are one part.
	test::Mesh mesh = test::joined(
		test::makeBox( { 0, 0, 0 }, { 0.37, 0.4, 1.2 }, 8 ), test::makeBox( { 0.43, 0, 0 }, { 0.8, 0.4, 1.2 }, 8 ) );
	const int arms = int( mesh.vertexCount() );
	mesh = test::joined( mesh, test::makeBox( { 0, 0, -0.4 }, { 0.8, 0.4, 0.1 }, 8 ) ); // overlaps both: shells may cut each other
	const SkinCase it( mesh, 0.1 );
	ASSERT_EQ( countComponents( it.lattice() ), 1 );
	for ( int v = 0; v < arms; ++v )
	{
		const Vec3 at = it.rest( v ) + it.lattice().massCentre.cast<float>();
		for ( std::uint32_t k = it.binding.start[v]; at.z() > 0.5f && k < it.binding.start[v + 1]; ++k )
		{
			const double x = it.nodes.x0.x[it.binding.node[k]] + it.lattice().massCentre.x();
			EXPECT_EQ( x < 0.4, at.x() < 0.4f );
		}
	}
}

TEST( BindingOutOfReach, VerticesFarFromEveryCellFollowTheNearestOne )
{
	test::Mesh mesh = test::makeBox( { 0, 0, 0 }, { 1, 1, 1 }, 4 );
	const std::uint32_t lonely = mesh.addVertex( 5.0, 0.5, 0.5 ), farOff = mesh.addVertex( 0.5, -1e6, 0.5 );
	SkinCase it( mesh, 0.25 );
	expectSound( it );
	const Eigen::Matrix3f turn = Eigen::AngleAxisf( 0.5f, Vec3::UnitZ() ).toRotationMatrix();
	it.affine( turn, Vec3( 1, 0, 0 ) );
	it.skinIt();
	EXPECT_LT( ( it.position( int( lonely ) ) - ( turn * it.rest( int( lonely ) ) + Vec3( 1, 0, 0 ) ) ).norm(), 1e-5f );
	EXPECT_LT( ( it.position( int( farOff ) ) - ( turn * it.rest( int( farOff ) ) + Vec3( 1, 0, 0 ) ) ).norm(), 1.0f ); // float, at 1000 km
	const std::uint32_t start = it.binding.start[lonely];
	ASSERT_EQ( it.binding.start[lonely + 1] - start, 1u );
	EXPECT_GT( it.nodes.x0.x[it.binding.node[start]] + it.lattice().massCentre.x(), 0.75 );
}

TEST( BindingOutOfReach, ManyOfThemCostLittle )
{
	test::Mesh mesh = test::makeBox( { 0, 0, 0 }, { 1, 1, 1 }, 4 );
	for ( int i = 0; i < 50000; ++i )
	{
		mesh.addVertex( 10.0 + i * 1e-4, -20.0, 3.0 + ( i % 7 ) );
	}
	LatticeSettings settings;
	settings.targetCells = 20000;
	settings.cellSize = 0.037f;
	const Result<LatticeBuild> built = buildLattice( mesh.view(), settings );
	ASSERT_TRUE( built.ok() ) << built.status.sentence;
	const auto start = std::chrono::steady_clock::now();
	const SkinBinding binding = bindSkin( mesh.view(), built.value.lattice, built.value.weldedVertex, Skinning::NearbyNodes );
	const double seconds = std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count();
	std::printf( "%d cells, %zu vertices out of reach: %.3f s\n", built.value.lattice.cellCount(), mesh.vertexCount(), seconds );
	EXPECT_LT( seconds, 5.0 ); // a search through all cells for each vertex would take minutes under a sanitizer
	EXPECT_EQ( binding.start.size(), mesh.vertexCount() + 1 );
}

TEST( BindingNone, BindsNothing )
{
	SkinCase it( test::makeBox( { 0, 0, 0 }, { 1, 1, 1 }, 2 ), 0.25, Skinning::None );
	EXPECT_TRUE( it.binding.node.empty() );
	it.skinIt();
	EXPECT_EQ( it.positions[0], 1e9f ); // nothing is written
}

} // namespace
} // namespace pliant
