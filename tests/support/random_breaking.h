#pragma once

// Bodies of random shapes that are thrown, bent, cut, torn and healed at random; every structure is validated after each event. Seeded.

#include "body/breaking.h"
#include "body/levels/levels.h"
#include "fracture/cut_links.h"
#include "support/block_body.h"
#include "support/explicit_material.h"
#include "support/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pliant::test {

struct BreakingCounts
{
	int events = 0, links = 0, healed = 0, pieces = 0, removed = 0, splits = 0;
	int kind[5] = {}; ///< plane, sphere, blade, random links, by strain
};

class RandomBreaking
{
public:
	explicit RandomBreaking( unsigned seed ) :
		m_random( seed ), m_whole( std::make_shared<const Lattice>( makeBlobLattice( 7 + int( seed % 4 ), 0.1f, seed ) ) )
	{
		Adaptivity settings;
		settings.coarseLevels = int( seed % 3 );
		Material material = test::explicitMaterial();
		material.youngsModulus = 1e5f;
		material.volumeKeeping = seed % 5 == 0 ? 0.5f : 0.0f;
		Result<std::unique_ptr<Body>> made = Body::create( m_whole, material, {}, nullptr, settings );
		EXPECT_TRUE( made.ok() ) << made.status.sentence;
		Fracture fracture;
		fracture.rule = seed % 8 >= 6 ? BreakRule::Shards : seed % 2 == 0 ? BreakRule::Plane : BreakRule::Distance;
		fracture.shardSize = 0.25f;
		fracture.crumbFraction = 0.2f;
		fracture.breakStrain = 0.15f;
		fracture.coolDown = 0.0f;
		fracture.smallCells = int( seed % 7 ) * 4;
		fracture.smallPieces = SmallPieces( seed / 3 % 4 );
		EXPECT_TRUE( made.value->setFracture( fracture ).ok() );
		m_bodies.push_back( std::move( made.value ) );
	}

	/// Runs `events` events, or until nothing is left to break.
	void run( int events, BreakingCounts& counts )
	{
		const int last = counts.events + events;
		for ( int tries = 0; counts.events < last && tries < 3 * events; ++tries )
		{
			const std::size_t which = std::size_t( m_random.uniform( 0.0f, 0.999f ) * float( m_bodies.size() ) );
			stir( *m_bodies[which] );
			hurt( *m_bodies[which], counts );
			if ( m_bodies[which]->hasBrokenLinks() )
			{
				comeApart( which, counts );
			}
		}
	}

private:
	void stir( Body& body )
	{
		const Vec3 spin = m_random.inBox( 8.0f ), pull = m_random.inBox( 4.0f );
		for ( int i = 0; i < body.nodeCount(); ++i )
		{
			const Vec3 x0 = body.nodes().x0.get( i );
			body.nodes().v.set( i, m_random.inBox( 0.5f ) + spin.cross( x0 ) + pull.cwiseProduct( x0 ) );
		}
		for ( int k = 0; k < 2; ++k )
		{
			body.adaptLevels( 1.0f / 240.0f );
			ASSERT_EQ( substep( body, 1.0f / 240.0f, 0.5f ), BodyHealth::Good );
		}
	}

	Vec3d wide( float half ) { return m_random.inBox( half ).cast<double>(); }

	void hurt( Body& body, BreakingCounts& counts )
	{
		const std::vector<Vec3d> positions = body.cellPositions();
		const Lattice& lattice = body.lattice();
		const Vec3d& at = positions[std::size_t( m_random.uniform( 0.0f, 0.999f ) * float( positions.size() ) )];
		const int kind = int( m_random.uniform( 0.0f, 4.999f ) );
		std::vector<CellLink> links;
		switch ( kind )
		{
			case 0: links = linksCut( lattice, positions, PlaneCut{ at, wide( 1.0f ), double( m_random.uniform( 0.1f, 1.0f ) ) } ); break;
			case 1: links = linksCut( lattice, positions, SphereCut{ at, double( m_random.uniform( 0.05f, 0.3f ) ) } ); break;
			case 2:
				links = linksCut(
					lattice, positions, BladeCut{ at + wide( 0.4f ), at + wide( 0.4f ), at + wide( 0.4f ), at + wide( 0.4f ) } );
				break;
			case 3: links = someLinks( lattice ); break;
			default: body.testLinks( 1.0f / 240.0f ); break;
		}
		if ( m_random.uniform( 0.0f, 1.0f ) < 0.2f )
		{
			counts.healed += body.healLinks( linksToHeal( *m_whole, lattice, body.firstCells(), positions, 1.5 ) );
		}
		body.breakLinks( links );
		counts.kind[kind] += body.hasBrokenLinks() ? 1 : 0;
	}

	std::vector<CellLink> someLinks( const Lattice& lattice )
	{
		const float fraction = m_random.uniform( 0.0f, 1.0f ) < 0.5f ? 0.05f : 0.9f;
		std::vector<CellLink> links;
		for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
		{
			for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
			{
				if ( i < lattice.linkTo[k] && m_random.uniform( 0.0f, 1.0f ) < fraction )
				{
					links.push_back( CellLink{ i, lattice.linkTo[k] } );
				}
			}
		}
		return links;
	}

	void comeApart( std::size_t which, BreakingCounts& counts )
	{
		Body& body = *m_bodies[which];
		while ( body.mustRefineToBreak() )
		{
			body.refineToBreak();
			++counts.splits;
		}
		const BodySums before = body.sums();
		const int cells = body.lattice().cellCount();
		BreakReport report;
		std::vector<BodyPiece> pieces = body.breakApart( report, 1 + int( m_random.uniform( 0.0f, 40.0f ) ) );
		double mass = report.removedMass;
		Vec3d momentum = Vec3d::Zero();
		int left = 0;
		for ( const BodyPiece& piece : pieces )
		{
			check( *piece.body );
			const BodySums sums = piece.body->sums();
			mass += sums.mass;
			momentum += sums.momentum;
			left += piece.body->lattice().cellCount();
		}
		EXPECT_NEAR( mass / before.mass, 1.0, 1e-6 );
		if ( report.removedPieces == 0 )
		{
			EXPECT_EQ( left, cells );
			EXPECT_LT( ( momentum - before.momentum ).norm(), 1e-6 * ( before.momentum.norm() + before.mass ) );
		}
		counts.links += report.links;
		counts.removed += report.removedPieces;
		counts.pieces += int( pieces.size() ) - 1;
		++counts.events;
		m_bodies[which] = std::move( pieces[0].body );
		for ( std::size_t k = 1; k < pieces.size() && m_bodies.size() < 60; ++k )
		{
			m_bodies.push_back( std::move( pieces[k].body ) );
		}
	}

	void check( const Body& body ) const
	{
		const Status lattice = validate( body.lattice() );
		EXPECT_TRUE( lattice.ok() ) << lattice.sentence;
		if ( const Levels* levels = body.levels() )
		{
			const Status octree = validate( levels->octree(), body.lattice() ), cut = validate( levels->cut(), levels->octree() );
			EXPECT_TRUE( octree.ok() ) << octree.sentence;
			EXPECT_TRUE( cut.ok() ) << cut.sentence;
		}
		for ( const Vec3d& position : body.cellPositions() )
		{
			EXPECT_TRUE( position.allFinite() );
		}
		EXPECT_TRUE( std::is_sorted( body.firstCells().begin(), body.firstCells().end() ) );
	}

	Seeded m_random;
	std::shared_ptr<const Lattice> m_whole;
	std::vector<std::unique_ptr<Body>> m_bodies;
};

/// `shapes` bodies, `events` cuts, tears and heals each.
inline BreakingCounts breakAtRandom( int shapes, int events, unsigned firstSeed )
{
	BreakingCounts counts;
	for ( int k = 0; k < shapes; ++k )
	{
		RandomBreaking breaking( firstSeed + unsigned( k ) );
		breaking.run( events, counts );
	}
	std::printf( "%d events (%d planes, %d spheres, %d blades, %d of random links, %d by strain): %d links, %d healed, %d pieces, %d "
				 "removed, %d times split first\n",
		counts.events, counts.kind[0], counts.kind[1], counts.kind[2], counts.kind[3], counts.kind[4], counts.links, counts.healed,
		counts.pieces, counts.removed, counts.splits );
	return counts;
}

} // namespace pliant::test
