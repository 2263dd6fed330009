// The part of the implicit step's operator that resists changes of volume, compared with the derivative of the matching force.

#include "lattice/pieces.h"
#include "matching/implicit/strain_rates.h"
#include "matching/step/lattice_matcher.h"
#include "support/block_body.h"
#include "support/block_lattice.h"
#include "support/explicit_material.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace pliant {
namespace {

using Field = AlignedArray<float>;

double dot( const Field& a, const Field& b )
{
	double sum = 0.0;
	for ( std::size_t k = 0; k < a.size(); ++k )
	{
		sum += double( a[k] ) * double( b[k] );
	}
	return sum;
}

/// A block that is slit: regions that are not full cubes.
Lattice slitBlock()
{
	const Lattice whole = makeBlockLattice( 7, 6, 5, 0.1f );
	return withoutLinks( whole, test::linksAtFour( whole, 4 ) );
}

struct VolumeRates
{
	/// `lattice` must outlive it.
	VolumeRates( const Lattice& lattice, float kappa, const Eigen::Matrix3f& shape, float noise, Summation summation,
		const Kernels& kernels = bestKernels() ) :
		material( materialOf( kappa ) ),
		matcher( lattice, material, summation, kernels ), nodes( test::restNodes( lattice ) )
	{
		test::Seeded random( 5 );
		const Eigen::Matrix3f turn = Eigen::AngleAxisf( 1.3f, Vec3( 1, 2, 3 ).normalized() ).toRotationMatrix();
		for ( int i = 0; i < nodes.count; ++i )
		{
			nodes.x.set( i, turn * ( shape * nodes.x0.get( i ) ) + random.inBox( noise * lattice.cellSize ) );
		}
		matcher.reset( nodes, Eigen::Quaterniond( turn.cast<double>() ) );
		match( 3 ); // rotations converge
		rates.prepare( matcher, nodes, nullptr, 1e4f );
	}
	static Material materialOf( float kappa )
	{
		Material m = test::explicitMaterial();
		m.volumeKeeping = kappa;
		return m;
	}
	/// Leaves the displacements to the goals in the velocities.
	void match( int times )
	{
		MatchStep step{ 1.0f, 1.0f };
		step.storesVolumeGradients = true;
		for ( int k = 0; k < times; ++k )
		{
			for ( int i = 0; i < nodes.count; ++i )
			{
				nodes.v.set( i, Vec3::Zero() );
			}
			matcher.accelerate( nodes, step, nullptr );
		}
	}
	Field noise( std::uint32_t seed ) const
	{
		test::Seeded random( seed );
		Field v( std::size_t( 3 * nodes.padded ), 0.0f );
		for ( int k = 0; k < 3; ++k )
		{
			for ( int i = 0; i < nodes.count; ++i )
			{
				v[std::size_t( k * nodes.padded + i )] = random.uniform( -1, 1 );
			}
		}
		return v;
	}
	/// m ( v - P v + kappa V v )
	Field resisted( const Field& v )
	{
		Field with( v.size() ), mass( v.size() );
		rates.resist( v.data(), 1.0f, with.data(), nullptr, material.volumeKeeping );
		rates.resist( v.data(), 0.0f, mass.data(), nullptr );
		for ( std::size_t k = 0; k < v.size(); ++k )
		{
			with[k] -= mass[k];
		}
		return with;
	}
	/// Minus the derivative of the matching force along v, times v.
	double derivative( const Field& v )
	{
		const NodeState before = nodes;
		double sum = 0.0;
		for ( const float step : { 1e-3f, -1e-3f } )
		{
			for ( int i = 0; i < nodes.count; ++i )
			{
				nodes.x.set( i, before.x.get( i ) + step * at( v, i ) );
			}
			match( 2 );
			for ( int i = 0; i < nodes.count; ++i )
			{
				sum -= double( nodes.mass[i] * nodes.v.get( i ).dot( at( v, i ) ) ) / double( 2.0f * step );
			}
			nodes = before;
		}
		match( 1 );
		return sum;
	}
	Vec3 at( const Field& v, int i ) const
	{
		return { v[std::size_t( i )], v[std::size_t( nodes.padded + i )], v[std::size_t( 2 * nodes.padded + i )] };
	}

	Material material;
	LatticeMatcher matcher;
	NodeState nodes;
	StrainRates rates;
};

struct Shape
{
	const char* name;
	Eigen::Matrix3f stretch;
};

Eigen::Matrix3f along( float x, float y, float z )
{
	return Vec3( x, y, z ).asDiagonal();
}

// At rest the operator is the derivative itself; of deformed bodies it must not fall short by more than a quarter, since the step is stable
// up to 4 / 3 of it, with the stiffness of shape raised by kappa times the largest change of volume (ImplicitMotion).
TEST( VolumeRates, AreTheDerivativeOfTheForce )
{
	const std::vector<Shape> shapes = { { "at rest", along( 1, 1, 1 ) }, { "stretched", along( 1.4f, 0.85f, 0.85f ) },
		{ "pressed", along( 0.7f, 1.2f, 1.2f ) }, { "flattened", along( 1.25f, 1.25f, 0.64f ) } };
	for ( const float kappa : { 0.5f, 2.0f, kLargestVolumeKeeping } )
	{
		for ( const Shape& shape : shapes )
		{
			double most = 0.0, least = 10.0;
			for ( const Lattice& lattice : { makeBlockLattice( 7, 6, 5, 0.1f ), slitBlock() } )
			{
				VolumeRates r( lattice, kappa, shape.stretch, 0.0f, Summation::Automatic );
				for ( std::uint32_t k = 0; k < 8; ++k )
				{
					Field v = r.noise( k );
					if ( k >= 4 ) // smooth: a uniform gradient
					{
						test::Seeded random( k );
						Eigen::Matrix3f gradient;
						gradient << random.inBox( 1 ), random.inBox( 1 ), random.inBox( 1 );
						for ( int i = 0; i < r.nodes.count; ++i )
						{
							const Vec3 value = gradient * r.nodes.x.get( i );
							for ( int c = 0; c < 3; ++c )
							{
								v[std::size_t( c * r.nodes.padded + i )] = value[c];
							}
						}
					}
					Field shapeOnly( v.size() ), mass( v.size() );
					r.rates.resist( v.data(), 1.0f, shapeOnly.data(), nullptr, 0.0f );
					r.rates.resist( v.data(), 0.0f, mass.data(), nullptr );
					const double raised = double( kappa * r.matcher.mostVolumeChange() ) * ( dot( v, shapeOnly ) - dot( v, mass ) );
					const double ratio = r.derivative( v ) / ( dot( v, r.resisted( v ) ) + raised );
					most = std::max( most, ratio );
					least = std::min( least, ratio );
				}
			}
			std::printf(
				"kappa %4.1f, %s: the force's derivative is %.3f to %.3f of the operator\n", double( kappa ), shape.name, least, most );
			EXPECT_LT( most, shape.stretch.isIdentity() ? 1.01 : 4.0 / 3.0 ) << shape.name;
			if ( shape.stretch.isIdentity() )
			{
				EXPECT_GT( least, 0.99 );
			}
		}
	}
}

TEST( VolumeRates, AreSymmetricAndResistNoRigidMotion )
{
	const Lattice lattice = makeBlockLattice( 7, 6, 5, 0.1f );
	for ( const Summation summation : { Summation::Table, Summation::BoxSums } )
	{
		VolumeRates r( lattice, kLargestVolumeKeeping, along( 1.3f, 0.9f, 0.8f ), 0.15f, summation );
		const Field a = r.noise( 1 ), b = r.noise( 2 );
		EXPECT_NEAR( dot( a, r.resisted( b ) ) / dot( b, r.resisted( a ) ), 1.0, 1e-3 );
		EXPECT_GT( dot( a, r.resisted( a ) ), 0.0 );
		Field turn( a.size(), 0.0f );
		for ( int i = 0; i < r.nodes.count; ++i )
		{
			const Vec3 value = Vec3( 1, 2, -1 ) + Vec3( 5, -3, 2 ).cross( r.nodes.x.get( i ) );
			for ( int c = 0; c < 3; ++c )
			{
				turn[std::size_t( c * r.nodes.padded + i )] = value[c];
			}
		}
		EXPECT_LT( std::abs( dot( turn, r.resisted( turn ) ) ), 1e-5 * dot( turn, turn ) );
		const Field pushed = r.resisted( a );
		Vec3d momentum = Vec3d::Zero(), spin = Vec3d::Zero(), size = Vec3d::Zero();
		for ( int i = 0; i < r.nodes.count; ++i )
		{
			const Vec3d f = r.at( pushed, i ).cast<double>();
			momentum += f;
			spin += r.nodes.x.get( i ).cast<double>().cross( f );
			size += f.cwiseAbs();
		}
		EXPECT_LT( momentum.norm(), 1e-5 * size.norm() );
		EXPECT_LT( spin.norm(), 1e-5 * size.norm() );
	}
}

TEST( VolumeRates, GiveTheSameBitsOnEveryInstructionSet )
{
	const Lattice lattice = slitBlock();
	const Kernels& base = *findKernels( KernelTarget::Baseline );
	for ( const KernelTarget target : { KernelTarget::Avx2, KernelTarget::Avx512 } )
	{
		if ( const Kernels* kernels = findKernels( target ) )
		{
			VolumeRates a( lattice, 2.0f, along( 1.3f, 0.9f, 0.8f ), 0.15f, Summation::Automatic, base );
			VolumeRates b( lattice, 2.0f, along( 1.3f, 0.9f, 0.8f ), 0.15f, Summation::Automatic, *kernels );
			const Field v = a.noise( 3 ), ofA = a.resisted( v ), ofB = b.resisted( v );
			EXPECT_TRUE( std::equal( ofA.begin(), ofA.end(), ofB.begin() ) ) << kernels->name;
		}
	}
}

TEST( VolumeRates, NameTheirDiagonal )
{
	const Lattice lattice = slitBlock();
	VolumeRates r( lattice, 2.0f, along( 1, 1, 1 ), 0.0f, Summation::Automatic );
	for ( int i = 0; i < r.nodes.count; i += 7 )
	{
		double sum = 0.0;
		for ( int c = 0; c < 3; ++c )
		{
			Field unit( std::size_t( 3 * r.nodes.padded ), 0.0f );
			unit[std::size_t( c * r.nodes.padded + i )] = 1.0f;
			sum += double( r.resisted( unit )[std::size_t( c * r.nodes.padded + i )] ) / double( r.nodes.mass[i] );
		}
		EXPECT_NEAR( sum / 3.0, double( r.rates.diagonal()[std::size_t( i )] ), 5e-3 );
	}
}

} // namespace
} // namespace pliant
