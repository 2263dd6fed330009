// The drawn surface in front of the cells, which objects touch, independently of the fill of the cells.

#include "lattice_checks.h"

#include <pliant/task_runner.h>

#include <cmath>
#include <memory>

namespace pliant::test {
namespace {

/// A cell's node in the mesh's coordinates, m.
Vec3d nodeOf( const Lattice& lattice, std::size_t cell )
{
	return lattice.restCentre[cell].cast<double>() + lattice.massCentre;
}

// Cells at a ball's surface are full, half full or nearly empty: their own spheres project from it by up to a seventh of a cell.
// Patches are parts of one sphere, for any fill of the cell.
TEST( ContactPatches, OfABallAreItsSurface )
{
	const Lattice lattice = built( makeSphere( 0.4, 60, 120 ), cellsOf( 0.06f ) ).lattice;
	int count = 0, surface = 0;
	for ( std::size_t i = 0; i < lattice.patch.size(); ++i )
	{
		const ContactPatch& patch = lattice.patch[i];
		surface += lattice.isSurface[i];
		if ( patch.radius > 0.0f )
		{
			++count;
			const Vec3d normal = patch.normal.cast<double>(), node = nodeOf( lattice, i );
			EXPECT_NEAR( ( node + double( patch.height ) * normal ).norm(), 0.4, 0.02 * 0.06 );
			EXPECT_LT( ( node - double( patch.radius - patch.height ) * normal ).norm(), 0.1 * 0.06 );
		}
	}
	EXPECT_GT( count, 0.8 * surface );
}

// No single sphere fits at its edges and corners.
TEST( ContactPatches, OfABoxAreFlatAndEndAtItsEdges )
{
	const Lattice lattice = built( makeBox( { 0, 0, 0 }, { 1, 1, 1 } ), cellsOf( 0.1f ) ).lattice;
	ASSERT_EQ( int( lattice.patch.size() ), lattice.cellCount() );
	for ( std::size_t i = 0; i < lattice.patch.size(); ++i )
	{
		const Eigen::Array3i at = lattice.coordinate[i].cast<int>().array();
		const int sides = int( ( at == 0 || at == 9 ).count() );
		const ContactPatch& patch = lattice.patch[i];
		ASSERT_EQ( patch.radius > 0.0f, sides == 1 ) << at.transpose();
		if ( sides == 1 )
		{
			EXPECT_NEAR( patch.height, 0.05, 1e-4 );
			EXPECT_NEAR( patch.normal.cwiseAbs().maxCoeff(), 1.0, 1e-4 );
			EXPECT_GT( patch.radius, 0.79f );
		}
	}
}

TEST( ContactPatches, AtEdgesAndCornersAreTheFacesThatMeetThere )
{
	const Lattice lattice = built( makeBox( { 0, 0, 0 }, { 1, 1, 1 } ), cellsOf( 0.1f ) ).lattice;
	ASSERT_EQ( int( lattice.edgeFaceStart.size() ), lattice.cellCount() + 1 );
	for ( std::size_t i = 0; i < lattice.patch.size(); ++i )
	{
		const Eigen::Array3i at = lattice.coordinate[i].cast<int>().array();
		const int sides = int( ( at == 0 || at == 9 ).count() );
		const std::uint32_t first = lattice.edgeFaceStart[i], last = lattice.edgeFaceStart[i + 1];
		ASSERT_EQ( int( last - first ), sides > 1 ? sides : 0 ) << at.transpose();
		for ( std::uint32_t k = first; k < last; ++k )
		{
			const ContactPatch& face = lattice.edgeFace[k];
			EXPECT_NEAR( face.height, 0.05, 1e-4 );
			Eigen::Index axis = 0;
			EXPECT_NEAR( face.normal.cwiseAbs().maxCoeff( &axis ), 1.0, 1e-4 );
			EXPECT_EQ( at[axis], face.normal[axis] > 0.0f ? 9 : 0 );
		}
	}
}

// A wall one cell thick has a surface on both sides of each node: no patch, but a face for each side.
TEST( ContactPatches, OfThinPartsAreFacesOnBothSides )
{
	const Lattice lattice = built( makeBox( { 0, 0, 0 }, { 1, 1, 0.1 } ), cellsOf( 0.1f ) ).lattice;
	for ( std::size_t i = 0; i < lattice.patch.size(); ++i )
	{
		EXPECT_EQ( lattice.patch[i].radius, 0.0f );
		for ( const float side : { -1.0f, 1.0f } )
		{
			EXPECT_TRUE(
				std::any_of( lattice.edgeFace.begin() + lattice.edgeFaceStart[i], lattice.edgeFace.begin() + lattice.edgeFaceStart[i + 1],
					[side]( const ContactPatch& face ) {
						return face.normal.z() * side > 0.999f && std::abs( face.height - 0.05f ) < 1e-4f;
					} ) )
				<< i;
		}
	}
}

TEST( ContactPatches, AreThereByDefaultAndTheSameForAnyThreadCount )
{
	const Mesh mesh = makeSphere( 0.4, 40, 80 );
	LatticeSettings settings = cellsOf( 0.06f );
	const Lattice one = built( mesh, settings ).lattice;
	const std::unique_ptr<TaskRunner> pool = createThreadPool( 3 );
	settings.runner = pool.get();
	const Lattice other = built( mesh, settings ).lattice;
	ASSERT_EQ( one.patch.size(), std::size_t( one.cellCount() ) );
	float highest = 0.0f;
	for ( std::size_t i = 0; i < one.patch.size(); ++i )
	{
		EXPECT_TRUE( one.patch[i].normal == other.patch[i].normal && one.patch[i].height == other.patch[i].height ) << i;
		highest = std::max( highest, one.patch[i].radius > 0.0f ? one.patch[i].height : 0.0f );
	}
	ASSERT_EQ( one.edgeFaceStart, other.edgeFaceStart );
	for ( std::size_t k = 0; k < one.edgeFace.size(); ++k )
	{
		EXPECT_TRUE( one.edgeFace[k].normal == other.edgeFace[k].normal && one.edgeFace[k].height == other.edgeFace[k].height ) << k;
		highest = std::max( highest, one.edgeFace[k].height );
	}
	// The overhang is exact, so that no box is larger than it must be.
	EXPECT_GT( one.overhang, 0.0f );
	EXPECT_EQ( one.overhang, highest - 0.5f * one.cellSize );
	EXPECT_EQ( one.overhang, other.overhang );
}

} // namespace
} // namespace pliant::test
