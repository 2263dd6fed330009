// Cracks open: each side is closed, tips stay joined, and no vertex follows a cell across the crack.

#include "surface/drawn_by_definition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <random>
#include <set>

namespace pliant {
namespace {

using namespace test;

struct CrackedSolid
{
	const char* name;
	std::function<Mesh()> make;
	double cellSize;
	friend void PrintTo( const CrackedSolid& solid, std::ostream* out ) { *out << solid.name; }
};

std::vector<CrackedSolid> crackedSolids()
{
	// clang-format off
	return {
		{ "BoxOnTheGrid", [] { return makeBox( { 0, 0, 0 }, { 1, 1, 1 } ); }, 0.2 },
		{ "Sphere", [] { return makeSphere( 1.0, 16, 24 ); }, 0.3 },
		{ "Torus", [] { return rotated( makeTorus( 1.0, 0.4, 24, 16 ), 0.4 ); }, 0.21 },
		{ "BumpySphere", [] { return makeBumpySphere( 1.0, 0.2, 24, 30 ); }, 0.27 },
		{ "HollowSphere", [] { return joined( makeSphere( 1.0, 16, 24 ), flipped( makeSphere( 0.6, 12, 20 ) ) ); }, 0.27 },
		{ "TwoShells", [] { return joined( makeSphere( 1.0, 16, 24 ), moved( makeSphere( 0.7, 12, 20 ), { 1.75, 0.1, 0.2 } ) ); }, 0.25 },
		{ "ThinPlate", [] { return rotated( makeBox( { 0, 0, 0 }, { 2, 1.5, 0.03 }, 3 ), 0.3 ); }, 0.2 },
		{ "Fork", [] { return joined( makeBox( { 0, 0, 0 }, { 2, 0.2, 0.2 } ), makeBox( { 0, 0.25, 0 }, { 2, 0.45, 0.2 } ) ); }, 0.3 },
	};
	// clang-format on
}

class Cracks : public testing::TestWithParam<std::tuple<CrackedSolid, float>>
{
protected:
	CrackCase make( Skinning kind = Skinning::NearbyNodes ) const
	{
		return CrackCase( std::get<0>( GetParam() ).make(), std::get<0>( GetParam() ).cellSize, noisy( std::get<1>( GetParam() ) ), kind );
	}
};

TEST_P( Cracks, UnbrokenItIsTheMesh )
{
	const CrackCase it = make();
	const DrawnCracks surface( it.complex );
	expectValid( surface );
	EXPECT_NEAR( volumeOf( surface ) / meshVolume( it.mesh ), 1.0, 1e-5 );
	const std::vector<std::uint32_t> drawn = surface.vertexOfKind();
	for ( std::uint32_t v = 0; v < std::uint32_t( it.mesh.vertexCount() ); ++v )
	{
		EXPECT_EQ( surface.binding().restPosition[drawn[v]], it.binding.restPosition[v] );
	}
}

TEST_P( Cracks, PiecesAreClosedAndSumToTheWhole )
{
	const CrackCase it = make();
	DrawnCracks whole( it.complex );
	const auto pieces = shatter( it.lattice(), 8, 5 );
	whole.breakFaces( facesBetween( *it.complex, pieces ) );
	expectValid( whole );
	expectNoSeams( whole );
	double sum = 0.0;
	int odd = 0;
	for ( const auto& cells : pieces )
	{
		const DrawnCracks piece = whole.piece( cells );
		expectValid( piece );
		EXPECT_EQ( openEdges( welded( piece ) ), 0 );
		odd += oddEdges( welded( piece ) );
		sum += volumeOf( piece );
	}
	EXPECT_NEAR( sum / meshVolume( it.mesh ), 1.0, 1e-5 );
	// Two triangles at each edge, except at a rare edge where a face and a piece of the surface both connect the same two points: four meet
	// there, and two of them coincide.
	EXPECT_LE( odd, 1 );
}

/// Both sides of every crack: the same triangles with opposite orientation, so that areas agree to the bit.
TEST_P( Cracks, SidesAreEqualAndOpposite )
{
	const CrackCase it = make();
	DrawnCracks whole( it.complex );
	whole.breakFaces( facesBetween( *it.complex, shatter( it.lattice(), 8, 7 ) ) );
	Vec3d sum = Vec3d::Zero();
	double area = 0.0, expected = 0.0;
	for ( std::size_t t = 0; t < whole.triangles().size(); ++t )
	{
		if ( whole.sources()[t] == CellComplex::kNone )
		{
			const auto at = [&]( std::size_t k ) { return Vec3d( whole.binding().restPosition[whole.triangles()[t][k]].cast<double>() ); };
			const Vec3d twice = ( at( 1 ) - at( 0 ) ).cross( at( 2 ) - at( 0 ) );
			sum += 0.5 * twice;
			area += 0.5 * twice.norm();
		}
	}
	for ( std::uint32_t f = 0; f < it.complex->face.size(); ++f )
	{
		expected += whole.isBroken( f ) ? 2.0 * double( it.complex->face[f].area ) : 0.0;
	}
	EXPECT_LT( sum.norm(), 1e-12 * area );
	EXPECT_NEAR( area / expected, 1.0, 1e-5 );
}

TEST_P( Cracks, BrokenFaceByFaceAreThoseBrokenAtOnce )
{
	const CrackCase it = make();
	DrawnCracks atOnce( it.complex ), stepwise( it.complex );
	std::vector<std::uint32_t> faces = facesBetween( *it.complex, shatter( it.lattice(), 5, 3 ) );
	atOnce.breakFaces( faces );
	std::mt19937 random( 3 );
	for ( std::size_t k = faces.size(); k > 1; --k )
	{
		std::swap( faces[k - 1], faces[random() % k] );
	}
	for ( const std::uint32_t face : faces )
	{
		stepwise.breakFaces( { face } );
	}
	expectValid( atOnce );
	expectValid( stepwise );
	ASSERT_EQ( atOnce.triangles().size(), stepwise.triangles().size() );
	auto a = welded( atOnce ), b = welded( stepwise );
	EXPECT_EQ( openEdges( a ), openEdges( b ) );
	EXPECT_NEAR( volumeOf( atOnce ), volumeOf( stepwise ), 1e-9 );
	// The rows of all cells agree: compares positions and rows of the drawn vertices, in any order.
	const auto corners = []( const DrawnCracks& s ) {
		std::vector<std::array<float, 5>> all;
		for ( const TrianglePoints& t : s.triangles() )
		{
			for ( const std::uint32_t v : t )
			{
				const Vec3& p = s.binding().restPosition[v];
				const std::uint32_t k = s.binding().start[s.binding().carrierOf( v )];
				all.push_back( { p.x(), p.y(), p.z(), float( s.binding().node[k] ), s.binding().weight[k] } );
			}
		}
		std::sort( all.begin(), all.end() );
		return all;
	};
	EXPECT_EQ( corners( atOnce ), corners( stepwise ) );
}

/// Random faces, broken in several steps: the rest stays closed as sums of edges, and valid.
TEST_P( Cracks, AnyBreaksLeaveItClosed )
{
	const CrackCase it = make();
	std::mt19937 random( 11 );
	DrawnCracks surface( it.complex );
	for ( int round = 0; round < 4; ++round )
	{
		std::vector<std::uint32_t> faces;
		for ( std::uint32_t f = 0; f < it.complex->face.size(); ++f )
		{
			if ( random() % 6 == 0 && !surface.isBroken( f ) )
			{
				faces.push_back( f );
			}
		}
		if ( faces.empty() )
		{
			continue; // the fork has few
		}
		surface.breakFaces( faces );
		expectValid( surface );
		expectNoSeams( surface );
		EXPECT_EQ( openEdges( welded( surface ) ), 0 );
		EXPECT_NEAR( volumeOf( surface ) / meshVolume( it.mesh ), 1.0, 1e-5 );
	}
}

INSTANTIATE_TEST_SUITE_P( Solids, Cracks, testing::Combine( testing::ValuesIn( crackedSolids() ), testing::Values( 0.0f, 0.3f ) ),
	[]( const auto& it ) { return std::string( std::get<0>( it.param ).name ) + ( std::get<1>( it.param ) > 0.0f ? "Noisy" : "Flat" ); } );

/// A piece of a box broken along a plane: every edge of its surface is used once in each direction.
TEST( DrawnCracks, HalvesAreManifolds )
{
	for ( const float noise : { 0.0f, 0.3f } )
	{
		const CrackCase it( makeSphere( 1.0, 24, 32 ), 0.22, noisy( noise ) );
		DrawnCracks whole( it.complex );
		std::vector<std::vector<std::uint32_t>> halves( 2 );
		for ( std::uint32_t cell = 0; cell < it.complex->cellCount(); ++cell )
		{
			halves[it.lattice().coordinate[cell].x() < it.lattice().extent.x() / 2 ? 0 : 1].push_back( cell );
		}
		whole.breakFaces( facesBetween( *it.complex, halves ) );
		for ( const auto& half : halves )
		{
			EXPECT_EQ( oddEdges( welded( whole.piece( half ) ) ), 0 );
		}
	}
}

/// No vertex of a side follows a cell that the crack separates, once the crack is complete.
TEST( DrawnCracks, SidesLetGoOfEachOther )
{
	for ( const Skinning kind : { Skinning::NearbyNodes, Skinning::Trilinear } )
	{
		const CrackCase it( makeBox( { 0, 0, 0 }, { 2, 1, 1 }, 6 ), 0.2, noisy(), kind );
		DrawnCracks whole( it.complex );
		std::vector<std::vector<std::uint32_t>> halves( 2 );
		std::vector<int> halfOf( it.complex->cellCount() );
		for ( std::uint32_t cell = 0; cell < it.complex->cellCount(); ++cell )
		{
			halfOf[cell] = it.lattice().coordinate[cell].x() < 5 ? 0 : 1;
			halves[std::size_t( halfOf[cell] )].push_back( cell );
		}
		whole.breakFaces( facesBetween( *it.complex, halves ) );
		int both = 0;
		const SkinBinding& b = whole.binding();
		for ( std::uint32_t v = 0; v < whole.vertexCount(); ++v )
		{
			std::set<int> sides;
			for ( std::uint32_t k = b.start[v]; k < b.start[v + 1]; ++k )
			{
				sides.insert( halfOf[b.node[k]] );
			}
			both += sides.size() == 2;
		}
		EXPECT_EQ( both, 0 );
	}
}

/// A body that is drawn from its own links is drawn as one whose breaking was followed, to the bit.
TEST( DrawnCracks, MadeFromItsOwnFacesItIsTheSame )
{
	const CrackCase it( makeSphere( 1.0, 16, 24 ), 0.3, noisy() );
	const auto pieces = shatter( it.lattice(), 4, 2 );
	DrawnCracks whole( it.complex );
	whole.breakFaces( facesBetween( *it.complex, pieces ) );
	for ( const auto& cells : pieces )
	{
		std::vector<std::uint32_t> own;
		for ( const std::uint32_t cell : cells )
		{
			std::copy_if( it.complex->facesOfCell.begin( cell ), it.complex->facesOfCell.end( cell ), std::back_inserter( own ),
				[&]( std::uint32_t f ) { return it.complex->face[f].isLinked && whole.isBroken( f ); } );
		}
		DrawnCracks alone( it.complex );
		alone.breakFaces( own );
		const Vec3 shift( 0.25f, 0.5f, -1.0f );
		const DrawnCracks made = alone.piece( cells, shift ), taken = whole.piece( cells, shift );
		EXPECT_EQ( made.triangles(), taken.triangles() );
		EXPECT_EQ( drawingOf( made.view() ), drawingOf( taken.view() ) );
		expectValid( whole.piece( cells ) );
	}
}

/// A crack through half of the body: at its tip no vertex is doubled, behind it all are.
TEST( DrawnCracks, TipsStayJoined )
{
	const CrackCase it( makeBox( { 0, 0, 0 }, { 1, 1, 1 } ), 0.25, noisy( 0.0f ) );
	DrawnCracks surface( it.complex );
	const auto cellAt = [&]( int x, int y, int z ) {
		for ( std::uint32_t cell = 0; cell < it.complex->cellCount(); ++cell )
		{
			if ( it.lattice().coordinate[cell].cast<int>() == Eigen::Vector3i( x, y, z ) )
			{
				return cell;
			}
		}
		return CellComplex::kNone;
	};
	std::vector<std::uint32_t> faces;
	for ( int y = 0; y < 4; ++y )
	{
		faces.push_back( it.complex->faceBetween( cellAt( 1, y, 0 ), cellAt( 2, y, 0 ) ) );
		faces.push_back( it.complex->faceBetween( cellAt( 1, y, 1 ), cellAt( 2, y, 1 ) ) );
	}
	surface.breakFaces( faces );
	expectValid( surface );
	const auto rowsAt = [&]( const Vec3d& place ) {
		std::set<std::vector<std::uint32_t>> rows;
		const SkinBinding& b = surface.binding();
		for ( const TrianglePoints& t : surface.triangles() )
		{
			for ( const std::uint32_t v : t )
			{
				if ( ( b.restPosition[v].cast<double>() + it.lattice().massCentre - place ).norm() < 1e-6 )
				{
					const std::uint32_t c = b.carrierOf( v );
					rows.insert( std::vector<std::uint32_t>( b.node.begin() + b.start[c], b.node.begin() + b.start[c + 1] ) );
				}
			}
		}
		return rows.size();
	};
	EXPECT_EQ( rowsAt( { 0.5, 0.0, 0.5 } ), 1u );  // the tip
	EXPECT_EQ( rowsAt( { 0.5, 0.0, 0.25 } ), 2u ); // behind it
	EXPECT_EQ( rowsAt( { 0.5, 0.5, 0.0 } ), 2u );
	EXPECT_EQ( rowsAt( { 0.25, 0.0, 0.25 } ), 1u ); // beside it
}

TEST( DrawnCracks, TextureCoordinatesRunThroughCutsOfTheSurface )
{
	CrackSettings settings = noisy();
	settings.textureTile = 0.5f;
	const CrackCase it( makeBox( { 0, 0, 0 }, { 1, 1, 1 } ), 0.23, settings );
	// u, v are linear in the position on the input, so they must be linear on every cut of it.
	std::vector<float> input;
	for ( std::size_t v = 0; v < it.mesh.vertexCount(); ++v )
	{
		const float* p = &it.mesh.positions[3 * v];
		input.insert( input.end(), { 2.0f * p[0] + p[1], p[2] - 3.0f * p[1] } );
	}
	DrawnCracks surface( it.complex, input.data() );
	surface.breakFaces( facesBetween( *it.complex, shatter( it.lattice(), 4, 1 ) ) );
	expectValid( surface, input.data() );
	const std::vector<float>& uv = surface.view().texture;
	int outer = 0;
	for ( std::size_t t = 0; t < surface.triangles().size(); ++t )
	{
		for ( const std::uint32_t v : surface.triangles()[t] )
		{
			const Vec3 p = surface.binding().restPosition[v] + it.lattice().massCentre.cast<float>();
			if ( surface.sources()[t] != CellComplex::kNone )
			{
				ASSERT_NEAR( uv[2 * v], 2.0f * p.x() + p.y(), 1e-3 );
				ASSERT_NEAR( uv[2 * v + 1], p.z() - 3.0f * p.y(), 1e-3 );
				++outer;
			}
			else
			{
				ASSERT_LT( std::abs( uv[2 * v] ), 2.0f );
			}
		}
	}
	EXPECT_GT( outer, 100 );
}

} // namespace
} // namespace pliant
