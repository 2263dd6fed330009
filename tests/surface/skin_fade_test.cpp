// The displacement of the skin by a change of levels: searched only where something was measured again, with the same result as a full
// search.

#include "body/levels/levels.h"
#include "support/explicit_material.h"
#include "surface/crack_pieces.h"
#include "surface/skin/rows_of_cells.h"
#include "surface/skin/skin_fade.h"
#include "surface/skin_case.h"

#include <gtest/gtest.h>

#include <random>

namespace pliant {
namespace {

using test::SkinCase;

/// How a body with levels carries its skin.
struct Carried
{
	std::vector<float> rotations, gradients;
	SkinPose pose;

	Carried( const Body& body, const SkinFade& fade ) :
		rotations( 4 * std::size_t( body.nodeCount() ) ), gradients( 9 * std::size_t( body.nodes().padded ) )
	{
		body.nodeRotations( rotations.data() );
		body.nodeDeformations( gradients.data() );
		pose.rotations = rotations.data();
		pose.gradients = gradients.data();
		pose.slotOfCell = body.levels()->cut().slotOfCell.data();
		pose.fade = fade.isActive() ? &fade : nullptr;
	}

	/// Regions with unchanged members have the same deformation: summed again they would differ in the last bits.
	void keepWhatWasNotMeasured( const Carried& before, const LevelChange& change )
	{
		for ( std::uint32_t i = 0; i < std::uint32_t( change.source.size() ); ++i )
		{
			if ( !std::binary_search( change.measured.begin(), change.measured.end(), i ) )
			{
				std::copy_n(
					before.gradients.begin() + 9 * std::ptrdiff_t( change.source[i] ), 9, gradients.begin() + 9 * std::ptrdiff_t( i ) );
			}
		}
	}
};

/// With two coarse levels, while it bends.
std::unique_ptr<Body> bodyInMotion( const Lattice& lattice )
{
	Adaptivity settings;
	settings.coarseLevels = 2;
	Result<std::unique_ptr<Body>> made = Body::create(
		std::make_shared<const Lattice>( lattice ), test::explicitMaterial(), {}, nullptr, settings );
	EXPECT_TRUE( made.ok() ) << made.status.sentence;
	NodeState& nodes = made.value->nodes();
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3 x = nodes.x0.get( i );
		nodes.v.set( i, Vec3( 2.0f * x.x() * x.y(), -x.z(), x.y() * x.y() ) );
	}
	return std::move( made.value );
}

/// Every fifth node from the first on, if it is a coarse one.
std::vector<std::uint32_t> someOfThoseThatSplit( const Body& body, int first )
{
	std::vector<std::uint32_t> split;
	for ( int i = first; i < body.nodeCount(); i += 5 )
	{
		if ( body.levels()->levelOf( i ) > 0 )
		{
			split.push_back( body.levels()->cut().node[i] );
		}
	}
	return split;
}

std::vector<float> offsets( const SkinFade& fade, const SkinBinding& binding )
{
	std::vector<float> packed( 3 * binding.restPosition.size(), 0.0f ), wide( 4 * binding.restPosition.size(), 0.0f );
	fade.addTo( packed.data(), wide.data(), Eigen::Quaternionf::Identity() );
	return packed;
}

TEST( SkinFade, IsTheSameWhereOnlyWhatWasMeasuredAnewIsLookedAt )
{
	const SkinCase it( test::makeBumpySphere( 1.0, 0.1, 30, 40 ), 0.12 );
	const std::unique_ptr<Body> made = bodyInMotion( it.lattice() );
	Body& body = *made;
	SkinFade everywhere, there;
	std::size_t offset = 0;
	for ( int change = 0; change < 12; ++change )
	{
		for ( int k = 0; k < 5; ++k )
		{
			test::substep( body, 1.0f / 240.0f, 0.3f );
		}
		everywhere.advance();
		there.advance();
		const std::vector<std::uint32_t> split = someOfThoseThatSplit( body, change );
		const int cells = it.lattice().cellCount();
		const Carried before( body, everywhere );
		everywhere.keep( body.nodes(), before.pose, cells );
		AlignedArray<float> maps( std::size_t( body.nodeCount() ) * kSkinMapFloats );
		skinMaps( body.nodes(), before.pose, maps.data() );
		there.keep( body.nodes(), before.pose, cells, &maps );
		body.changeLevels( split, {} );

		const LevelChange& done = body.levels()->lastChange();
		Carried now( body, SkinFade() );
		now.keepWhatWasNotMeasured( before, done );
		SkinFade::Nodes nodes{ body.nodes(), now.pose, done.source, done.keptAs, Eigen::Quaternionf::Identity() };
		everywhere.start( it.binding, nodes );
		nodes.measured = &done.measured;
		there.start( it.binding, nodes );
		const std::vector<float> wanted = offsets( everywhere, it.binding );
		EXPECT_EQ( offsets( there, it.binding ), wanted ) << change;
		offset += std::size_t( std::count_if( wanted.begin(), wanted.end(), []( float x ) { return x != 0.0f; } ) );
		EXPECT_LT( done.measured.size(), std::size_t( body.nodeCount() ) ) << "nothing was left to leave out";
	}
	EXPECT_GT( offset, 1000u );
}

/// The surface as it is drawn, without earlier fades.
std::vector<float> drawn( const SkinBinding& binding, const Body& body, const SkinPose& pose, const SkinTriangles& triangles )
{
	SkinScratch scratch;
	std::vector<float> positions( 3 * binding.restPosition.size() ), normals( positions.size() );
	skin( binding, body.nodes(), pose, triangles, scratch, positions.data(), normals.data() );
	return positions;
}

/// A body with cracks: right after a change it is drawn at its previous position, and rows found by their points give the same as all rows,
/// to the bit. Vertices in panels that no crack divides follow their corners and need no offsets.
TEST( SkinFade, OfACrackedBodyKeepsItWhereItStood )
{
	const test::CrackCase it( test::makeBumpySphere( 1.0, 0.1, 30, 40 ), 0.12, test::noisy() );
	const std::unique_ptr<Body> made = bodyInMotion( it.lattice() );
	Body& body = *made;
	test::DrawnCracks surface( test::withAllCuts( it.complex ) );
	std::vector<std::uint32_t> faces;
	for ( std::uint32_t f = 0; f < std::uint32_t( it.complex->face.size() / 2 ); f += 9 )
	{
		faces.push_back( f );
	}
	surface.breakFaces( faces );
	const SkinBinding& binding = surface.binding();
	EXPECT_GT( binding.placed.size(), 500u );
	const SkinTriangles triangles{ surface.triangles()[0].data(), int( surface.triangles().size() ) };
	const std::vector<std::uint32_t> same;
	std::size_t offset = 0;
	float largest = 0.0f;
	for ( int change = 0; change < 4; ++change )
	{
		for ( int k = 0; k < 5; ++k )
		{
			test::substep( body, 1.0f / 240.0f, 0.3f );
		}
		const std::vector<std::uint32_t> split = someOfThoseThatSplit( body, change );
		SkinFade everywhere, there;
		const Carried before( body, everywhere );
		everywhere.keep( body.nodes(), before.pose, it.lattice().cellCount() );
		there.keep( body.nodes(), before.pose, it.lattice().cellCount() );
		const std::vector<float> stood = drawn( binding, body, before.pose, triangles );
		body.changeLevels( split, {} );
		const LevelChange& done = body.levels()->lastChange();
		Carried now( body, SkinFade() );
		now.keepWhatWasNotMeasured( before, done );
		SkinFade::Nodes nodes{ body.nodes(), now.pose, done.source, done.keptAs, Eigen::Quaternionf::Identity() };
		everywhere.start( binding, nodes );
		nodes.measured = &done.measured;
		nodes.complex = it.complex.get();
		nodes.cellsInComplex = &same;
		there.start( binding, nodes );
		const std::vector<float> wanted = offsets( everywhere, binding );
		EXPECT_EQ( offsets( there, binding ), wanted ) << change;
		for ( const SkinBinding::Placed& of : binding.placed )
		{
			EXPECT_TRUE( Eigen::Map<const Vec3>( &wanted[3 * std::size_t( of.vertex )] ).isZero( 0.0f ) );
		}
		now.pose.fade = &there;
		const std::vector<float> stands = drawn( binding, body, now.pose, triangles );
		float most = 0.0f;
		for ( std::size_t k = 0; k < stood.size(); ++k )
		{
			most = std::max( most, std::abs( stands[k] - stood[k] ) );
		}
		EXPECT_LT( most, 5e-5f ) << "of a body 2 m across";
		offset += std::size_t( std::count_if( wanted.begin(), wanted.end(), []( float x ) { return x != 0.0f; } ) );
		largest = std::max( largest, *std::max_element( wanted.begin(), wanted.end() ) );
	}
	EXPECT_GT( offset, 1000u );
	EXPECT_GT( largest, 5e-4f ) << "nothing would have jumped";
}

float farthest( const std::vector<float>& offsets )
{
	float far = 0.0f;
	for ( std::size_t k = 0; k < offsets.size(); k += 3 )
	{
		far = std::max( far, Eigen::Map<const Vec3>( &offsets[k] ).norm() );
	}
	return far;
}

/// The surfaces of torn elephants were off their nodes for up to 13 s, since no frame was to move a vertex by more than a twentieth of a
/// percent of the body, and were skinned in full all that time: a crushed body jumps by a third of itself.
TEST( SkinFade, OfACrushedBodyIsOverInHalfASecond )
{
	const SkinCase it( test::makeBumpySphere( 1.0, 0.1, 30, 40 ), 0.12 );
	const std::unique_ptr<Body> made = bodyInMotion( it.lattice() );
	Body& body = *made;
	std::mt19937 random( 7 );
	const auto some = [&] { return float( random() ) / 4294967296.0f - 0.5f; };
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		body.nodes().x.set( i, body.nodes().x.get( i ) + Vec3( some(), some(), some() ) );
	}
	test::substep( body, 1.0f / 240.0f, 0.3f );
	SkinFade fade;
	const Carried before( body, fade );
	fade.keep( body.nodes(), before.pose, it.lattice().cellCount() );
	body.changeLevels( someOfThoseThatSplit( body, 0 ), {} );
	const LevelChange& done = body.levels()->lastChange();
	const Carried now( body, SkinFade() );
	fade.start( it.binding, SkinFade::Nodes{ body.nodes(), now.pose, done.source, done.keptAs, Eigen::Quaternionf::Identity() } );
	const float jumped = farthest( offsets( fade, it.binding ) );
	EXPECT_GT( jumped, 0.1f ) << "of a body 2 m across";
	int frames = 0;
	for ( float left = jumped; fade.isActive() && frames < 100; ++frames )
	{
		fade.advance();
		const float next = farthest( offsets( fade, it.binding ) );
		EXPECT_LT( left - next, 1.01f * jumped / 30.0f );
		left = next;
	}
	EXPECT_EQ( frames, 30 );
}

/// Rows of any length, empty ones included, few of which hold a requested cell.
TEST( SkinFade, RowsThatHoldACellAreFound )
{
	std::mt19937 random( 3 );
	int found = 0;
	for ( int round = 0; round < 60; ++round )
	{
		std::vector<char> isWanted( 300, 0 );
		for ( char& is : isWanted )
		{
			is = random() % ( round % 2 == 0 ? 150 : 6 ) == 0 ? 1 : 0;
		}
		SkinBinding binding;
		binding.start.push_back( 0 );
		for ( int row = 0; row < 200; ++row )
		{
			for ( std::uint32_t k = random() % 12; k > 0; --k )
			{
				binding.node.push_back( random() % 300 );
			}
			binding.start.push_back( std::uint32_t( binding.node.size() ) );
		}
		const std::vector<char> holds = rowsThatHold( binding, isWanted );
		ASSERT_EQ( holds.size(), 200u );
		for ( std::size_t row = 0; row < 200; ++row )
		{
			bool is = false;
			for ( std::uint32_t k = binding.start[row]; k < binding.start[row + 1]; ++k )
			{
				is = is || isWanted[binding.node[k]] != 0;
			}
			EXPECT_EQ( holds[row] != 0, is );
			found += is ? 1 : 0;
		}
	}
	EXPECT_GT( found, 500 );
	EXPECT_LT( found, 10000 );
}

} // namespace
} // namespace pliant
