#pragma once

// A block of cells that breaks into shards, without a body or a world.

#include "fracture/shards/shard_cracks.h"
#include "support/block_body.h"
#include "support/block_lattice.h"

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace pliant::test {

constexpr float kShardBlockStrain = 0.02f; // at which it breaks

inline Fracture shards( float size )
{
	Fracture fracture;
	fracture.rule = BreakRule::Shards;
	fracture.breakStrain = kShardBlockStrain;
	fracture.shardSize = size;
	return fracture;
}

/// A block of cells, and its shards; stretched along an axis at rest otherwise.
struct ShardBlock
{
	static constexpr float kCell = 0.05f;   // m
	static constexpr double kModulus = 1e6; // Pa
	Lattice lattice;
	NodeState nodes;
	ShardCracks cracks;
	LinkLimits limits;

	ShardBlock( int nx, int ny, int nz, const Fracture& fracture, const GivenCentres& given = {}, std::vector<float> toughness = {} ) :
		lattice( makeBlockLattice( nx, ny, nz, kCell ) ), nodes( restNodes( lattice ) ), cracks( lattice, fracture, given )
	{
		cracks.setLaw( fracture.breakStrain, kModulus );
		limits = limitLinks( lattice, cracks.candidateStrain(), std::move( toughness ) );
	}

	void stretchTo( int axis, float strain )
	{
		nodes = restNodes( lattice );
		for ( int i = 0; i < nodes.count; ++i )
		{
			Vec3 at = nodes.x.get( i );
			at[axis] *= 1.0f + strain;
			nodes.x.set( i, at );
		}
	}

	std::vector<CellLink> run()
	{
		std::vector<CellLink> broken;
		cracks.findOverloads( lattice, limits, CellPositions( nodes ) );
		const auto positions = [this] {
			std::vector<Vec3d> at;
			for ( int i = 0; i < nodes.count; ++i )
			{
				at.push_back( nodes.x.get( i ).cast<double>() );
			}
			return at;
		};
		cracks.run( lattice, limits, positions, broken );
		return broken;
	}

	std::map<std::uint32_t, std::vector<std::uint32_t>> cellsOfShards() const
	{
		std::map<std::uint32_t, std::vector<std::uint32_t>> cells;
		for ( std::uint32_t i = 0; i < std::uint32_t( cracks.shards().size() ); ++i )
		{
			cells[cracks.shards()[i]].push_back( i );
		}
		return cells;
	}
};

} // namespace pliant::test
