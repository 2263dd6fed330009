// Bodies that hold one another by their shape alone, for a minute: a chain of rings, and a knot.

#include "test_meshes.h"
#include "twin_worlds.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <vector>

namespace pliant {
namespace {

using test::at;
using test::TestWorld;
using Vec3d = Eigen::Vector3d;

constexpr int kMinute = 3600; // frames

Material entangled( Elasticity elasticity, float youngsModulus )
{
	Material material;
	material.elasticity = elasticity;
	material.youngsModulus = youngsModulus > 0.0f ? youngsModulus : material.youngsModulus;
	return material;
}

/// How far a chain of four rings of .26 m hangs down from a peg after a minute, m: the centre of the lowest one.
btScalar lengthOfAChain( const Material& material )
{
	TestWorld t;
	LatticeSettings settings;
	settings.cellSize = 0.04f;
	const auto ring = BodyTemplate::build( test::makeTorus( 0.2, 0.06, 48, 16 ).view(), settings ).value;
	t.add( 0, new btCapsuleShapeZ( btScalar( 0.05 ), btScalar( 0.6 ) ), at( 0, 0, 0 ) );
	for ( int k = 0; k < 4; ++k )
	{
		// A ring in the plane of x and y, and the next one in that of z and y.
		const btQuaternion turn( btVector3( 0, 1, 0 ), k % 2 == 0 ? 0 : SIMD_HALF_PI );
		t.addSoft( ring, btTransform( turn, btVector3( 0, btScalar( -0.08 - 0.26 * k ), 0 ) ), material );
	}
	t.run( kMinute );
	for ( const auto& body : t.soft )
	{
		EXPECT_TRUE( body->isHealthy() );
		EXPECT_FALSE( body->isActive() );
	}
	return -t.soft.back()->massCentre().y();
}

TEST( Entangled, AChainOfRingsHolds )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit, Elasticity::Automatic } )
	{
		for ( const float youngsModulus : { 0.0f, 1e6f } )
		{
			const btScalar length = lengthOfAChain( entangled( elasticity, youngsModulus ) );
			EXPECT_GT( length, 0.9 );
			EXPECT_LT( length, 1.3 ) << int( elasticity ) << " " << youngsModulus; // one below the other, a little stretched
		}
	}
}

/// A rope of 12 cm along an open trefoil of 6.5 m, whose ends stand out at the side.
class Rope
{
public:
	Rope()
	{
		std::vector<Vec3d> line;
		const Vec3d out = Vec3d( trefoil( kOpening ).x(), trefoil( kOpening ).y(), 0 ).normalized();
		const auto add = [&line]( const Vec3d& p ) { line.empty() || ( p - line.back() ).norm() >= 0.03 ? line.push_back( p ) : void(); };
		for ( double l = 0.5; l > 0; l -= 0.01 )
		{
			add( trefoil( kOpening + kGap ) + l * out );
		}
		for ( double t = kOpening + kGap; t < kOpening + 2 * M_PI - kGap; t += 1e-3 )
		{
			add( trefoil( t ) );
		}
		for ( double l = 0; l < 0.5; l += 0.01 )
		{
			add( trefoil( kOpening - kGap ) + l * out );
		}
		addTube( line );
		m_ends[0] = line.front();
		m_ends[1] = line.back();
		m_apart = ( trefoil( kOpening + 1e-3 ) - trefoil( kOpening - 1e-3 ) ).normalized();
	}
	MeshView view() const { return m_mesh.view(); }
	Vec3d end( int k ) const { return m_ends[k]; }
	/// The direction in which the first end is pulled.
	const Vec3d& apart() const { return m_apart; }

private:
	static constexpr double kRadius = 0.06, kOpening = M_PI / 3, kGap = 0.09;

	static Vec3d trefoil( double t )
	{
		return 0.2 * Vec3d( std::sin( t ) + 2 * std::sin( 2 * t ), std::cos( t ) - 2 * std::cos( 2 * t ), -1.1 * std::sin( 3 * t ) );
	}
	void addTube( const std::vector<Vec3d>& line )
	{
		constexpr std::uint32_t kAround = 12;
		const std::size_t last = line.size() - 1;
		Vec3d side( 0, 0, 1 );
		for ( std::size_t i = 0; i <= last; ++i )
		{
			const Vec3d along = ( line[std::min( i + 1, last )] - line[i > 0 ? i - 1 : 0] ).normalized();
			side = ( side - side.dot( along ) * along ).normalized();
			for ( std::uint32_t j = 0; j < kAround; ++j )
			{
				const double angle = 2 * M_PI * j / kAround;
				const Vec3d p = line[i] + kRadius * ( std::cos( angle ) * side + std::sin( angle ) * along.cross( side ) );
				m_mesh.addVertex( p.x(), p.y(), p.z() );
			}
		}
		const std::uint32_t end = std::uint32_t( last ) * kAround;
		const std::uint32_t caps[2] = {
			m_mesh.addVertex( line[0].x(), line[0].y(), line[0].z() ), m_mesh.addVertex( line[last].x(), line[last].y(), line[last].z() ) };
		for ( std::uint32_t j = 0; j < kAround; ++j )
		{
			const std::uint32_t next = ( j + 1 ) % kAround;
			for ( std::uint32_t at = 0; at < end; at += kAround )
			{
				m_mesh.addQuad( at + j, at + next, at + next + kAround, at + j + kAround );
			}
			m_mesh.addTriangle( caps[0], next, j );
			m_mesh.addTriangle( caps[1], end + j, end + next );
		}
	}

	test::Mesh m_mesh;
	Vec3d m_ends[2], m_apart;
};

// Both ends are pulled by 2.8 m within ten seconds. Were the rope no longer knotted, it would be slack: its ends are 6 m apart then.
TEST( Entangled, AKnotThatIsPulledTightHolds )
{
	const Rope rope;
	LatticeSettings settings;
	settings.cellSize = 0.03f;
	const auto made = BodyTemplate::build( rope.view(), settings );
	ASSERT_TRUE( made.ok() ) << made.status.sentence;
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const body = t.addSoft( made.value, at( 0, 0, 0 ), entangled( Elasticity::Implicit, 0.0f ) );
	ASSERT_TRUE( body->setSelfCollision( true ).ok() );
	const btVector3 apart( btScalar( rope.apart().x() ), btScalar( rope.apart().y() ), btScalar( rope.apart().z() ) );
	struct Held
	{
		int node;
		btVector3 from, pull;
	};
	std::vector<Held> held;
	for ( int node = 0; node < body->nodeCount(); ++node )
	{
		const btVector3 p = body->nodePosition( node );
		for ( int k = 0; k < 2; ++k )
		{
			if ( ( Vec3d( double( p.x() ), double( p.y() ), double( p.z() ) ) - rope.end( k ) ).norm() < 0.06 )
			{
				held.push_back( { node, p, k == 0 ? apart : -apart } );
			}
		}
	}
	constexpr int kPulled = 600; // frames
	int least = 1000;
	for ( int frame = 1; frame <= kPulled + kMinute; ++frame )
	{
		for ( std::size_t k = 0; frame <= kPulled && k < held.size(); ++k )
		{
			const btVector3 to = held[k].from + btScalar( 2.8 * frame / kPulled ) * held[k].pull;
			EXPECT_TRUE( body->driveNode( held[k].node, to ).ok() );
		}
		t.run( 1 );
		ASSERT_TRUE( body->isHealthy() ) << frame;
		least = frame > kPulled && body->isActive() ? std::min( least, t.world.stepReport().selfContacts ) : least;
	}
	EXPECT_GT( least, 50 ); // the turns of the knot press each other
	EXPECT_LT( body->linearVelocity().length(), 0.01 );
}

} // namespace
} // namespace pliant
