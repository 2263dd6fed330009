#pragma once

// Bodies whose operator of the implicit step is tested.

#include "matching/implicit/strain_rates.h"
#include "matching/step/lattice_matcher.h"
#include "support/block_body.h"
#include "support/block_lattice.h"
#include "support/explicit_material.h"

#include <memory>
#include <utility>
#include <vector>

namespace pliant::test {

/// A block rotated, moved, bent and displaced at random.
inline NodeState strained( const Lattice& lattice )
{
	NodeState nodes = restNodes( lattice );
	Seeded random( 11 );
	const Eigen::Matrix3f turn = Eigen::AngleAxisf( 1.3f, Vec3( 1, 2, 3 ).normalized() ).toRotationMatrix();
	for ( int i = 0; i < nodes.count; ++i )
	{
		Vec3 p = nodes.x0.get( i );
		p.y() += 0.4f * p.x() * p.x();
		nodes.x.set( i, turn * p + random.inBox( 0.2f * lattice.cellSize ) + Vec3( 3, 1, -2 ) );
	}
	return nodes;
}

/// A rotated, moved block whose nodes are displaced by a thousandth of a cell, as of a stiff body.
inline NodeState hardlyStrained( const Lattice& lattice, const Eigen::Quaternionf& rotation, unsigned seed )
{
	NodeState nodes = restNodes( lattice );
	Seeded random( seed );
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3 offset = random.inBox( 1e-3f * lattice.cellSize );
		nodes.x.set( i, rotation * ( nodes.x0.get( i ) + offset ) + Vec3( 3, 1, -2 ) );
	}
	return nodes;
}

inline Eigen::Quaternionf rotationBy( float angle )
{
	return Eigen::Quaternionf( Eigen::AngleAxisf( angle, Vec3( 1, 2, 3 ).normalized() ) );
}

struct RatesCase
{
	Lattice lattice;
	int halfWidth;
	Summation summation;
	std::vector<float> stiffness = {};
};

struct RatesOperator
{
	RatesOperator( const RatesCase& c, const Kernels& kernels = bestKernels() ) : RatesOperator( c, strained( c.lattice ), kernels ) {}
	RatesOperator( const RatesCase& c, NodeState state, const Kernels& kernels = bestKernels() ) : nodes( std::move( state ) )
	{
		Material material = explicitMaterial();
		material.regionHalfWidth = c.halfWidth;
		matcher = std::make_unique<LatticeMatcher>(
			c.lattice, material, buildRegionTables( c.lattice, material, c.summation, c.stiffness ), kernels );
		rates.prepare( *matcher, nodes, nullptr );
	}
	void prepareStiff( const Eigen::Quaternionf& rotation, float stiffness )
	{
		matcher->reset( nodes, rotation.cast<double>() );
		rates.prepare( *matcher, nodes, nullptr, stiffness );
	}
	std::vector<double> operator()( const std::vector<double>& v, float stiffness, TaskRunner* runner = nullptr )
	{
		AlignedArray<float> in( v.begin(), v.end() ), out( v.size(), -1.0f );
		rates.resist( in.data(), stiffness, out.data(), runner );
		return std::vector<double>( out.begin(), out.end() );
	}
	std::vector<double> random( unsigned seed ) const
	{
		Seeded seeded( seed );
		std::vector<double> v( 3 * std::size_t( nodes.padded ), 0.0 );
		for ( int k = 0; k < 3; ++k )
		{
			for ( int i = 0; i < nodes.count; ++i )
			{
				v[std::size_t( k * nodes.padded + i )] = double( seeded.uniform( -1, 1 ) );
			}
		}
		return v;
	}
	std::vector<double> rigid( const Vec3d& shift, const Vec3d& turn ) const
	{
		std::vector<double> v( 3 * std::size_t( nodes.padded ), 0.0 );
		for ( int i = 0; i < nodes.count; ++i )
		{
			const Vec3d move = shift + turn.cross( nodes.x.get( i ).cast<double>() );
			for ( int k = 0; k < 3; ++k )
			{
				v[std::size_t( k * nodes.padded + i )] = move[k];
			}
		}
		return v;
	}

	NodeState nodes;
	std::unique_ptr<LatticeMatcher> matcher;
	StrainRates rates;
};

} // namespace pliant::test
