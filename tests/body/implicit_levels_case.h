#pragma once

// Implicit bodies with levels of detail, and their operator.

#include "body/levels/levels.h"
#include "matching/constants.h"
#include "matching/implicit/strain_rates.h"
#include "matching/step/lattice_matcher.h"
#include "support/block_body.h"
#include "support/block_lattice.h"
#include "support/explicit_material.h"

#include <gtest/gtest.h>

#include <vector>

namespace pliant {
namespace implicit_case {

inline constexpr float kStep = 1.0f / 60.0f;

inline Material material( float alpha )
{
	Material m = test::explicitMaterial();
	m.elasticity = Elasticity::Implicit;
	m.damping = 0.0f;
	m.wobbleDamping = 0.0f;
	m.youngsModulus = alpha * m.density * 0.01f * 2.0f / ( 3.0f * kStep * kStep );
	return m;
}

inline Adaptivity levels( int count, RegionRule rule = RegionRule::Multiplicity, bool isHierarchical = true )
{
	Adaptivity settings;
	settings.coarseLevels = count;
	settings.regions = rule;
	settings.hierarchicalSums = isHierarchical;
	return settings;
}

inline std::unique_ptr<Body> make( int nx, int ny, int nz, const Material& m, const Adaptivity& settings )
{
	Result<std::unique_ptr<Body>> made = Body::create(
		std::make_shared<Lattice>( makeBlockLattice( nx, ny, nz, 0.1f ) ), m, {}, nullptr, settings );
	EXPECT_TRUE( made.ok() ) << made.status.sentence;
	return std::move( made.value );
}

/// Splits every node of the first cut at positive x, so that nodes of all sizes are neighbours.
inline void splitHalf( Body& body )
{
	for ( int round = 0; round < 2; ++round )
	{
		std::vector<std::uint32_t> split;
		for ( int i = 0; i < body.nodeCount(); ++i )
		{
			if ( body.levels()->levelOf( i ) > 0 && body.nodes().x0.x[i] > ( round == 0 ? 0.0f : 0.3f ) )
			{
				split.push_back( body.levels()->cut().node[std::size_t( i )] );
			}
		}
		body.changeLevels( split, {} );
	}
}

struct Rates
{
	explicit Rates( Body& own, const Kernels& kernels = bestKernels() ) :
		body( own ), matcher( own.lattice(), own.material(), own.levels()->tables(), kernels )
	{
		if ( body.material().volumeKeeping > 0.0f )
		{
			const NodeState before = body.nodes();
			matcher.accelerate( body.nodes(), matchStep(), nullptr ); // stores the gradients of volume
			body.nodes() = before;
		}
		rates.prepare( matcher, body.nodes(), nullptr );
	}
	/// Displaces each node to its goal in a step of 1 s.
	static MatchStep matchStep()
	{
		MatchStep step{ 1.0f, 1.0f };
		step.storesVolumeGradients = true;
		return step;
	}
	std::vector<float> operator()( const std::vector<float>& v, float stiffness )
	{
		AlignedArray<float> in( v.begin(), v.end() ), out( v.size(), -1.0f );
		rates.resist( in.data(), stiffness, out.data(), nullptr, body.material().volumeKeeping );
		return std::vector<float>( out.begin(), out.end() );
	}
	/// Returns the values of `of( node )`, component by component.
	template <class Of>
	std::vector<float> field( Of of ) const
	{
		const std::size_t padded = std::size_t( body.nodes().padded );
		std::vector<float> v( 3 * padded, 0.0f );
		for ( int i = 0; i < body.nodeCount(); ++i )
		{
			const Vec3 value = of( i );
			for ( std::size_t k = 0; k < 3; ++k )
			{
				v[k * padded + std::size_t( i )] = value[Eigen::Index( k )];
			}
		}
		return v;
	}

	Body& body;
	LatticeMatcher matcher;
	StrainRates rates;
};

inline double product( const std::vector<float>& a, const std::vector<float>& b )
{
	double sum = 0.0;
	for ( std::size_t k = 0; k < a.size(); ++k )
	{
		sum += double( a[k] ) * double( b[k] );
	}
	return sum;
}

struct Rule
{
	const char* name;
	Adaptivity settings;
};

inline std::vector<Rule> rules()
{
	Adaptivity scaled = levels( 2 );
	scaled.softening = Softening::Ohta3D;
	scaled.residual = ResidualRule::Soften;
	Adaptivity keeping = levels( 2 );
	keeping.residual = ResidualRule::Keep;
	return { { "multiplicity", levels( 2 ) }, { "all residual kept", keeping }, { "union", levels( 2, RegionRule::Union ) },
		{ "interval", levels( 2, RegionRule::Interval, false ) }, { "interval by the octree", levels( 2, RegionRule::Interval, true ) },
		{ "by size", scaled } };
}

} // namespace implicit_case
} // namespace pliant
