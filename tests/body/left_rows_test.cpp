// Rows of nodes that are split ahead of a cut are measured once, together with the cut.

#include "body/breaking.h"
#include "body/levels/levels.h"
#include "matching/step/lattice_matcher.h"
#include "support/block_body.h"
#include "support/block_lattice.h"
#include "support/explicit_material.h"
#include "support/same_levels.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

/// A piece's positions are those of the whole, translated: one rounding each.
constexpr float kRowRounding = 2e-5f;

/// Nodes above the cut links are split first, and their rows and those of their neighbours are deferred to the cut: measured by it where
/// one piece remains, before it where a piece comes off. With several levels only the last split defers rows.
TEST( LeftRows, AreMeasuredWithTheCut )
{
	for ( const int coarse : { 1, 2 } )
	{
		for ( const int most : { 8, 1 } ) // a full cut; a notch
		{
			Adaptivity settings;
			settings.coarseLevels = coarse;
			const auto lattice = std::make_shared<const Lattice>( makeBlockLattice( 16, 8, 8, 0.1f ) );
			const auto cut = [&]( PieceBuild road ) {
				const std::unique_ptr<Body> body = std::move(
					Body::create( lattice, test::explicitMaterial(), {}, nullptr, settings ).value );
				body->breakLinks( test::linksAtFour( *lattice, most ) );
				int splits = 0;
				for ( ; body->mustRefineToBreak(); ++splits )
				{
					body->refineToBreak();
				}
				EXPECT_EQ( splits, coarse );
				BreakReport report;
				return body->breakApart( report, 10, road );
			};
			const std::vector<BodyPiece> got = cut( PieceBuild::Reuse ), wanted = cut( PieceBuild::FromScratch );
			ASSERT_EQ( got.size(), most == 8 ? 2u : 1u );
			for ( std::size_t k = 0; k < got.size(); ++k )
			{
				test::expectNearTables(
					*got[k].body->levels()->tables(), *wanted[k].body->levels()->tables(), got.size() == 1 ? 0.0f : kRowRounding );
			}
		}
	}
}

} // namespace
} // namespace pliant
