// Small free vibrations of a block whose nodes are all on level 1, compared with the uniform lattice: the accuracy of each method's
// stiffness for each kind of deformation. Relative error over 300 steps: two unrelated vibrations have 1.2.

#include "body/body.h"
#include "body/levels/levels.h"
#include "experiments/experiments.h"
#include "experiments/methods.h"
#include "support/block_lattice.h"
#include "support/explicit_material.h"

#include <cmath>
#include <cstdio>

namespace pliant::experiment {

namespace {

constexpr int kLength = 32, kHeight = 16; // cells
constexpr int kSteps = 300;
constexpr float kStep = 0.01f; // s

/// Displacement at a rest position, in cells, of three starts: half a wave of stretch, uniform shear, the free-free bending mode.
Vec3d displacement( int start, const Vec3d& at )
{
	if ( start == 0 )
	{
		return { 1e-2 * std::sin( 3.14159265358979 * at.x() / kLength ), 0.0, 0.0 };
	}
	if ( start == 1 )
	{
		return { 0.0, 0.0, 1e-3 * at.x() };
	}
	const double root = 4.730040745, k = root / kLength; // cos( root ) cosh( root ) = 1
	const double c = std::cos( root / 2 ), ch = std::cosh( root / 2 ), size = 1e-2 / ch;
	const double height = std::cos( k * at.x() ) * ch + std::cosh( k * at.x() ) * c;
	const double slope = k * ( -std::sin( k * at.x() ) * ch + std::sinh( k * at.x() ) * c );
	return { -size * slope * at.z(), 0.0, size * height };
}

std::unique_ptr<Body> makeBody( std::shared_ptr<const Lattice> lattice, int halfWidth, const NamedMethod& method, int start )
{
	Material material = test::explicitMaterial();
	material.density = 1.0f;
	material.stiffness = Stiffness::RawAlpha;
	material.regionHalfWidth = halfWidth;
	material.weights = method.weights;
	material.damping = 0.0f;
	material.wobbleDamping = 0.0f;
	std::unique_ptr<Body> body = std::move( Body::create( std::move( lattice ), material, {}, nullptr, method.adaptivity ).value );
	NodeState& nodes = body->nodes();
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3d rest = nodes.x0.get( i ).cast<double>();
		nodes.x.set( i, ( rest + displacement( start, rest ) ).cast<float>() );
	}
	return body;
}

double vibrationError( const std::shared_ptr<const Lattice>& lattice, int halfWidth, const NamedMethod& method, int start )
{
	const std::unique_ptr<Body> fine = makeBody( lattice, halfWidth, NamedMethod{}, start ),
								body = makeBody( lattice, halfWidth, method, start );
	const Octree& octree = body->levels()->octree();
	const Cut& cut = body->levels()->cut();
	double error = 0.0, whole = 0.0;
	for ( int step = 0; step < kSteps; ++step )
	{
		for ( Body* moved : { fine.get(), body.get() } )
		{
			moved->accelerateTowardGoals( kStep, 1.0f, nullptr );
			moved->integrate( kStep );
		}
		for ( int i = 0; i < cut.count(); ++i )
		{
			const std::uint32_t node = cut.node[std::size_t( i )];
			Vec3d mean = Vec3d::Zero();
			for ( std::uint32_t k = octree.cellStart[node]; k < octree.cellStart[node] + octree.cellCount[node]; ++k )
			{
				mean += fine->nodes().worldPosition( int( octree.cells[k] ) ) / octree.cellCount[node];
			}
			error += ( body->nodes().worldPosition( i ) - mean ).squaredNorm();
			whole += ( mean - octree.restCentre[node].cast<double>() ).squaredNorm();
		}
	}
	return std::sqrt( error / whole );
}

} // namespace

void vibrationExperiment()
{
	const auto lattice = std::make_shared<const Lattice>( makeBlockLattice( kLength, kHeight, kHeight, 1.0f ) );
	std::printf( "Block of %d x %d x %d cells, all nodes on level 1; error over %d undamped steps: stretch / shear / bend\n\n| method | w "
				 "= 1 | w = 2 |\n"
				 "|---|---|---|\n",
		kLength, kHeight, kHeight, kSteps );
	for ( const NamedMethod& method : staticMethods( 1 ) )
	{
		std::printf( "| %s |", method.name.c_str() );
		for ( int w = 1; w <= 2; ++w )
		{
			std::printf( " %.3f / %.3f / %.3f |", vibrationError( lattice, w, method, 0 ), vibrationError( lattice, w, method, 1 ),
				vibrationError( lattice, w, method, 2 ) );
		}
		std::printf( "\n" );
	}
}

} // namespace pliant::experiment
