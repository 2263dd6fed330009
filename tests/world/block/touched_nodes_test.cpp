// Explicit bodies take part in an implicit system by the nodes that contacts touch. Reference implementation: the same system with all
// nodes of the bodies.

#include "world/test_world.h"

#include "body/implicit/touched_nodes.h"
#include "world/block/island_block.h"
#include "world/bodies/soft_body_impl.h"

#include <random>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

/// Cubes of which two nodes each are held, with random velocities.
struct Cubes
{
	explicit Cubes( std::uint32_t seed, const std::shared_ptr<const BodyTemplate>& shape )
	{
		std::minstd_rand random( seed );
		std::uniform_real_distribution<float> spread( -1.0f, 1.0f );
		for ( int k = 0; k < 3; ++k )
		{
			Material material = test::stiff( 1e5f );
			material.elasticity = Elasticity::Explicit;
			bodies.push_back( t.addSoft( shape, at( 0, btScalar( k ), 0 ), material ) );
		}
		t.run( 1 );
		for ( SoftBody* body : bodies )
		{
			NodeState& nodes = body->impl().body->nodes();
			for ( int i = 0; i < nodes.count; ++i )
			{
				nodes.v.set( i, Vec3( spread( random ), spread( random ), spread( random ) ) );
			}
			nodes.freedom[0] = nodes.freedom[3] = 0.0f;
		}
	}

	/// Adds a contact of two bodies, or of one with the world, that up to two nodes share on each side.
	void touch( IslandBlock& system, int first, int second, std::minstd_rand& random ) const
	{
		std::uniform_real_distribution<double> spread( -1.0, 1.0 );
		BlockContact contact;
		contact.normal = Vec3d( spread( random ), 2.0, spread( random ) ).normalized();
		contact.friction = 0.4;
		contact.target = contact.targetWithoutBounce = 0.1 * spread( random );
		const int members[2] = { first, second };
		for ( int k = 0; k < 2; ++k )
		{
			ContactSide& side = contact.side[k];
			side.soft = members[k];
			if ( side.soft >= 0 )
			{
				const int count = bodies[std::size_t( side.soft )]->nodeCount();
				side.node = 1 + int( random() % std::uint32_t( count - 2 ) );
				side.shared = SharedNodes::only( side.node );
				side.shared.count = 2;
				side.shared.node[1] = side.node == 1 ? 2 : side.node - 1;
				side.shared.press[0] = side.shared.rub[0] = 0.7;
				side.shared.press[1] = side.shared.rub[1] = 0.3;
			}
		}
		contact.velocityBefore = system.velocityBefore( contact );
		system.contacts.push_back( contact );
	}

	/// Solves random contacts, and returns the velocities of all nodes.
	std::vector<Vec3> solve( bool onlyTouched, int fixedContacts, int contacts )
	{
		IslandBlock system;
		for ( SoftBody* body : bodies )
		{
			Body& own = *body->impl().body;
			SoftPart part;
			part.owner = body;
			part.touched = onlyTouched ? &own.joinByContacts() : nullptr;
			part.motion = onlyTouched ? &part.touched->motion() : &own.joinFreely();
			part.velocityBefore = &own.velocityBefore();
			system.soft.push_back( part );
		}
		std::minstd_rand random( 7 );
		for ( int k = 0; k < contacts; ++k )
		{
			touch( system, k % 2, k < fixedContacts ? -1 : 1 - k % 2, random );
		}
		system.solve( nullptr );
		std::vector<Vec3> velocities;
		for ( const SoftBody* body : bodies )
		{
			const NodeState& nodes = body->impl().body->nodes();
			for ( int i = 0; i < nodes.count; ++i )
			{
				velocities.push_back( nodes.v.get( i ) );
			}
		}
		return velocities;
	}

	TestWorld t;
	std::vector<SoftBody*> bodies;
};

void expectAgreement( const std::shared_ptr<const BodyTemplate>& shape, int fixedContacts )
{
	for ( std::uint32_t seed = 1; seed <= 5; ++seed )
	{
		const std::vector<Vec3> before = Cubes( seed, shape ).solve( true, 0, 0 );
		const std::vector<Vec3> touched = Cubes( seed, shape ).solve( true, fixedContacts, 12 );
		const std::vector<Vec3> all = Cubes( seed, shape ).solve( false, fixedContacts, 12 );
		ASSERT_EQ( touched.size(), all.size() );
		float change = 0.0f, error = 0.0f;
		for ( std::size_t i = 0; i < all.size(); ++i )
		{
			change = std::max( change, ( all[i] - before[i] ).norm() );
			error = std::max( error, ( all[i] - touched[i] ).norm() );
		}
		EXPECT_GT( change, 0.1f ); // m/s
		EXPECT_LT( error, 2e-3f ); // m/s: the tolerance of the impulses
	}
}

TEST( TouchedNodes, AnswerContactsWithTheWorldAsAllNodesDo )
{
	expectAgreement( block( 4, 4, 4, 0.25f ), 12 );
}

TEST( TouchedNodes, AnswerEachOthersContactsAsAllNodesDo )
{
	expectAgreement( block( 4, 4, 4, 0.25f ), 3 );
}

TEST( TouchedNodes, OfABodyWithoutContactsKeepTheirVelocities )
{
	const std::shared_ptr<const BodyTemplate> shape = block( 3, 3, 3, 0.25f );
	const std::vector<Vec3> before = Cubes( 1, shape ).solve( true, 0, 0 ), after = Cubes( 1, shape ).solve( true, 4, 12 );
	for ( std::size_t i = 2 * before.size() / 3; i < before.size(); ++i )
	{
		EXPECT_EQ( before[i], after[i] );
	}
}

} // namespace
} // namespace pliant
