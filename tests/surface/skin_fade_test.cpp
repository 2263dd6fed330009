// What a change of levels moves the skin by: looked for where something was measured anew, and found as if it were looked for everywhere.

#include "body/levels.h"
#include "surface/skin_case.h"
#include "surface/skin_fade.h"

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

	Carried( const Body& body, const SkinFade& fade ) : rotations( 4 * std::size_t( body.nodeCount() ) ), gradients( 9 * std::size_t( body.nodes().padded ) )
	{
		body.nodeRotations( rotations.data() );
		body.nodeDeformations( gradients.data() );
		pose.rotations = rotations.data();
		pose.gradients = gradients.data();
		pose.slotOfCell = body.levels()->cut().slotOfCell.data();
		pose.fade = fade.isActive() ? &fade : nullptr;
	}

	/// Regions that hold what they held are stretched as they were: summed again they would differ in the last bits.
	void keepWhatWasNotMeasured( const Carried& before, const LevelChange& change )
	{
		for ( std::uint32_t i = 0; i < std::uint32_t( change.heir.size() ); ++i )
		{
			if ( !std::binary_search( change.measured.begin(), change.measured.end(), i ) )
			{
				std::copy_n( before.gradients.begin() + 9 * std::ptrdiff_t( change.heir[i] ), 9, gradients.begin() + 9 * std::ptrdiff_t( i ) );
			}
		}
	}
};

std::vector<float> offsets( const SkinFade& fade, const SkinBinding& binding )
{
	std::vector<float> packed( 3 * binding.restPosition.size(), 0.0f ), wide( 4 * binding.restPosition.size(), 0.0f );
	fade.addTo( packed.data(), wide.data(), Eigen::Quaternionf::Identity() );
	return packed;
}

TEST( SkinFade, IsTheSameWhereOnlyWhatWasMeasuredAnewIsLookedAt )
{
	const SkinCase it( test::makeBumpySphere( 1.0, 0.1, 30, 40 ), 0.12 );
	Adaptivity settings;
	settings.coarseLevels = 2;
	Result<std::unique_ptr<Body>> made = Body::create( std::make_shared<const Lattice>( it.lattice() ), Material{}, {}, nullptr, settings );
	ASSERT_TRUE( made.ok() ) << made.status.sentence;
	Body& body = *made.value;
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		const Vec3 x = body.nodes().x0.get( i );
		body.nodes().v.set( i, Vec3( 2.0f * x.x() * x.y(), -x.z(), x.y() * x.y() ) );
	}
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
		std::vector<std::uint32_t> split;
		for ( int i = change; i < body.nodeCount(); i += 5 )
		{
			if ( body.levels()->levelOf( i ) > 0 )
			{
				split.push_back( body.levels()->cut().node[i] );
			}
		}
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
		SkinFade::Nodes nodes{ body.nodes(), now.pose, done.heir, done.keptAs, Eigen::Quaternionf::Identity() };
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

/// Rows of any length, none among them, of which few hold a cell that is wanted.
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
