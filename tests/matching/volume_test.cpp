// Volume conservation: Poisson's ratio, the volume after an impact, and no cost for bodies without it.

#include "matching/reference/reference_matcher.h"
#include "matching/step/lattice_matcher.h"
#include "matching/volume_law.h"
#include "support/block_body.h"
#include "support/block_lattice.h"
#include "support/clamped_bar.h"
#include "support/explicit_material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace pliant {
namespace {

Material keeping( float kappa )
{
	Material material = test::explicitMaterial();
	material.volumeKeeping = kappa;
	return material;
}

TEST( Volume, SettingsOutOfRangeAreRefused )
{
	EXPECT_FALSE( check( keeping( -0.1f ) ).ok() );
	EXPECT_FALSE( check( keeping( 25.0f ) ).ok() );
	Material stiff = keeping( 2.0f );
	stiff.stiffness = Stiffness::RawAlpha;
	stiff.alpha = 1.0f;
	EXPECT_FALSE( check( stiff ).ok() );
}

TEST( Volume, AgreesWithTheReference )
{
	for ( const Summation summation : { Summation::Table, Summation::BoxSums } )
	{
		const Lattice lattice = makeBlockLattice( 7, 6, 5, 0.1f );
		const Material material = keeping( 0.8f );
		LatticeMatcher fast( lattice, material, summation );
		ReferenceMatcher slow( lattice, material );
		NodeState a = test::restNodes( lattice ), b = test::restNodes( lattice );
		test::Seeded random( 5 );
		for ( int i = 0; i < a.count; ++i )
		{
			const Vec3 x = a.x0.get( i ).cwiseProduct( Vec3( 1.15f, 0.9f, 0.95f ) ) + random.inBox( 0.01f );
			a.x.set( i, x );
			b.x.set( i, x );
		}
		fast.reset( a, Eigen::Quaterniond::Identity() );
		slow.reset( b, Eigen::Quaterniond::Identity() );
		for ( int step = 0; step < 5; ++step )
		{
			const MatchStep match{ 0.01f, 0.8f };
			fast.accelerate( a, match, nullptr );
			slow.accelerate( b, match, nullptr );
			for ( int i = 0; i < a.count; ++i )
			{
				a.x.set( i, a.x.get( i ) + 0.01f * a.v.get( i ) );
				b.x.set( i, b.x.get( i ) + 0.01f * b.v.get( i ) );
			}
		}
		for ( int i = 0; i < a.count; ++i )
		{
			EXPECT_LT( ( a.x.get( i ) - b.x.get( i ) ).norm(), 2e-6f );
		}
	}
}

TEST( Volume, PoissonsRatioAndYoungsModulusAreWhatTheySay )
{
	const float strain = 0.002f;
	for ( const float kappa : { 0.0f, 0.5f, 1.0f, 2.0f, 8.0f, kLargestVolumeKeeping } )
	{
		Material material = keeping( kappa );
		material.damping = 60.0f;
		material.wobbleDamping = 1.0f;
		material.youngsModulus = 2e4f;
		const std::unique_ptr<Body> body = test::makeBlock( 24, 6, 6, 0.1f, material );
		const float h = 1.0f / 240.0f;
		const StiffnessPlan plan = planStiffness( material, 0.1f, h, 1 );
		ASSERT_TRUE( plan.reachable );
		// Pulled at both ends by sigma = 0.2 % of E over the end faces.
		NodeState& nodes = body->nodes();
		nodes.force.resize( nodes.padded );
		const float force = strain * material.youngsModulus * 0.01f;
		for ( int i = 0; i < nodes.count; ++i )
		{
			const float x = nodes.x0.get( i ).x();
			nodes.force.x[i] = x > 1.1f ? force : x < -1.1f ? -force : 0.0f;
		}
		for ( int step = 0; step < 1500; ++step )
		{
			test::substep( *body, h, plan.alpha );
		}
		const Vec3d strains = test::middleStretch( body->nodes() ) - Vec3d::Ones();
		const double along = strains.x(), across = strains.y();
		const double wanted = kappa / ( 2.0 * kappa + 1.0 );
		std::printf(
			"kappa %.1f: nu %.3f (%.3f), E %.3f of what was set\n", double( kappa ), -across / along, wanted, double( strain ) / along );
		EXPECT_NEAR( -across / along, wanted, 0.01 );
		EXPECT_NEAR( double( strain ) / along, 1.0, 0.04 ); // the layers at its faces are softer
	}
}

// A bar that was stretched to three times its length became a thread: volume was conserved to first order in strain.
TEST( Volume, AStretchedBarIsAsThinAsRubber )
{
	for ( const double stretch : { 2.0, 3.0 } )
	{
		for ( const double nu : { 0.3, 0.45 } )
		{
			Material material = keeping( float( nu / ( 1.0 - 2.0 * nu ) ) );
			material.wobbleDamping = 0.5f;
			material.youngsModulus = 1e5f;
			const float h = 1.0f / 480.0f;
			const StiffnessPlan plan = planStiffness( material, 0.1f, h, 1 );
			ASSERT_TRUE( plan.reachable );
			test::ClampedBar bar( material );
			bar.pull( stretch, 2400, [&] { test::substep( bar.body(), h, plan.alpha ); } );
			// Hencky: the logarithms of the stretches keep Poisson's ratio.
			const Vec3d stretches = test::middleStretch( bar.nodes() );
			const double wanted = std::pow( stretches.x(), -nu );
			std::printf( "nu %.2f, stretched %.2f times: width %.3f (%.3f)\n", nu, stretches.x(), stretches.y(), wanted );
			EXPECT_NEAR( stretches.y() / wanted, 1.0, 0.05 );
		}
	}
}

// A stretch of a hundred at unchanged volume was measured as a change of volume of .78: Newton's method began too far away.
TEST( Volume, IsMeasuredExactlyHoweverStretched )
{
	const Lattice lattice = makeBlockLattice( 3, 3, 3, 0.1f );
	for ( const float stretch : { 0.05f, 0.5f, 2.0f, 10.0f, 30.0f, 100.0f } )
	{
		for ( const float volume : { 1.0f, 1.1f } )
		{
			LatticeMatcher matcher( lattice, keeping( 2.0f ) );
			NodeState nodes = test::restNodes( lattice );
			const float across = std::sqrt( volume / stretch );
			for ( int i = 0; i < nodes.count; ++i )
			{
				nodes.x.set( i, nodes.x0.get( i ).cwiseProduct( Vec3( stretch, across, across ) ) );
			}
			matcher.reset( nodes, Eigen::Quaterniond::Identity() );
			MatchStep step{ 1.0f, 1.0f };
			step.storesVolumeGradients = true;
			matcher.accelerate( nodes, step, nullptr );
			const Eigen::Matrix3d u = Vec3d( double( stretch ), double( across ), double( across ) ).asDiagonal();
			const double exact = volumeStrain( u, Eigen::Matrix3d::Identity() ).size;
			// 13 is the middle of 27 nodes: a whole region, with weights of 1.
			EXPECT_NEAR( double( matcher.volumeSize()[13] ), exact, 3e-5 * double( std::max( stretch, 1.0f ) ) )
				<< stretch << " " << volume;
		}
	}
}

/// Volume of the nodes' hull as the mean of det F over cells, from face neighbours.
double meanVolume( const Body& body )
{
	double sum = 0.0;
	int count = 0;
	const Lattice& lattice = body.lattice();
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		Eigen::Matrix3f edges = Eigen::Matrix3f::Zero();
		int found = 0;
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			const int j = int( lattice.linkTo[k] );
			const Eigen::Vector3i step = lattice.coordinate[j].cast<int>() - lattice.coordinate[i].cast<int>();
			if ( step.sum() == 1 && step.cwiseAbs().sum() == 1 )
			{
				edges.col( step.x() == 1 ? 0
						: step.y() == 1  ? 1
										 : 2 ) = ( body.nodes().x.get( j ) - body.nodes().x.get( i ) ) / lattice.cellSize;
				++found;
			}
		}
		if ( found == 3 )
		{
			sum += edges.determinant();
			++count;
		}
	}
	return sum / count;
}

double leastVolumeAtImpact( float kappa, float alpha )
{
	Material material = keeping( kappa );
	material.regionHalfWidth = 2;
	material.stiffness = Stiffness::RawAlpha;
	material.alpha = alpha;
	material.wobbleDamping = 0.0f;
	const std::unique_ptr<Body> body = test::makeBlock( 8, 8, 8, 1.0f, material );
	NodeState& nodes = body->nodes();
	const float h = 0.01f;
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.v.set( i, Vec3( 0.0f, 0.0f, -0.3f / h ) ); // 0.3 cells a step
	}
	double least = 1.0;
	for ( int step = 0; step < 60; ++step )
	{
		body->accelerateTowardGoals( h, alpha, nullptr );
		for ( int i = 0; i < nodes.count; ++i )
		{
			const double scratch = nodes.worldPosition( i ).z() + 4.0;
			nodes.v.z[i] = scratch + h * nodes.v.z[i] < 0.0 ? float( -scratch / h ) : nodes.v.z[i];
		}
		body->integrate( h );
		least = std::min( least, meanVolume( *body ) );
	}
	return least;
}

TEST( Volume, OfABlockThatHitsTheGroundIsKeptThreeTimesAsWell )
{
	const double plain = 1.0 - leastVolumeAtImpact( 0.0f, 1.0f ), kept = 1.0 - leastVolumeAtImpact( 0.9f, 0.94f );
	std::printf( "volume lost at impact: %.3f plain, %.3f with kappa 0.9\n", plain, kept );
	EXPECT_LT( kept, plain / 3.0 );
}

/// Kinetic energy of a block that is shaken and then left alone, undamped, J: initial value, and maximum over so many seconds of 1/240 s
/// steps.
struct Shaken
{
	double first = 0.0, most = 0.0;
};

Shaken shake( const Material& material, float speed, float seconds )
{
	const std::unique_ptr<Body> body = test::makeBlock( 5, 5, 5, 0.1f, material );
	const float h = 1.0f / 240.0f;
	const StiffnessPlan plan = planStiffness( material, 0.1f, h, 1 );
	test::Seeded random( 7 );
	for ( int i = 0; i < body->nodeCount(); ++i )
	{
		body->nodes().v.set( i, random.inBox( speed ) );
	}
	Shaken shaken;
	shaken.first = body->sums().kineticEnergy;
	for ( int step = 0; step < int( seconds / h ); ++step )
	{
		test::substep( *body, h, plan.alpha );
		shaken.most = std::max( shaken.most, body->sums().kineticEnergy );
	}
	return shaken;
}

// A vibrating body with volume conservation vibrated more and more until it tore itself apart: the response of regions at its faces, whose
// moments differ between the normal and the tangential directions, was not symmetric.
TEST( Volume, KeptBringsNoEnergyIn )
{
	for ( const float kappa : { 0.5f, 2.0f } )
	{
		Material material = keeping( kappa );
		material.youngsModulus = 1e4f;
		material.damping = material.wobbleDamping = 0.0f;
		const Shaken shaken = shake( material, 4.0f, 20.0f );
		std::printf( "kappa %.1f: motion %.1f J at first, %.1f at most\n", double( kappa ), shaken.first, shaken.most );
		EXPECT_LT( shaken.most, 1.02 * shaken.first );
	}
}

// The largest damping accelerated a compressed body: the rotation of a region compressed to half its size changes twice as fast as its
// material rotates, and volume conservation multiplies the response to compression by 1 + 3 kappa.
TEST( Volume, KeptOrNotTheLargestDampingOnlyDamps )
{
	for ( const float kappa : { 0.0f, 2.0f } )
	{
		Material material = keeping( kappa );
		material.damping = kLargestDamping;
		const Shaken shaken = shake( material, 20.0f, 2.0f );
		std::printf( "kappa %.1f, most damping: motion %.1f J at first, %.1f at most\n", double( kappa ), shaken.first, shaken.most );
		EXPECT_LT( shaken.most, 1.02 * shaken.first );
	}
}

TEST( Volume, WithoutItNothingIsHeld )
{
	const Lattice lattice = makeBlockLattice( 6, 6, 6, 0.1f );
	EXPECT_TRUE( LatticeMatcher( lattice, Material{} ).tables().moments.inverseMoment[0].empty() );
	EXPECT_FALSE( LatticeMatcher( lattice, keeping( 0.5f ) ).tables().moments.inverseMoment[0].empty() );
}

} // namespace
} // namespace pliant
