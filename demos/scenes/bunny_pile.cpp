// +-----------------------------------------------------------------------------------------------------------------+
// | bunny_pile, the main scene: soft and rigid bodies meet, roll and pile up, with a hinged door in their path.       |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/must_succeed.h"
#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"

#include <algorithm>
#include <random>

namespace pliant_demos {

namespace {

constexpr int kSteps = 5;
constexpr btScalar kRise = btScalar( 0.19 ), kTread = btScalar( 0.42 ), kWidth = btScalar( 1.7 );
constexpr btScalar kStairsEnd = btScalar( 0.3 ); // x where the ground begins
constexpr btScalar kDoorX = btScalar( 1.05 ), kDoorWidth = btScalar( 1.1 ), kDoorHeight = btScalar( 0.95 );
constexpr int kLooseBodies = 22;
constexpr double kCameraRide = 3.0; // s

btTransform at( btScalar x, btScalar y, btScalar z )
{
	return btTransform( btQuaternion::getIdentity(), btVector3( x, y, z ) );
}

class BunnyPile : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		stage.addGround( btScalar( 0.6 ) );
		addStairs( stage );
		addDoor( stage );
		addLooseBodies( stage );
		return addBunny( stage ) && addGlob( stage );
	}

	double duration() const override { return 6.0; }

	pliant_glue::DrawCamera camera( double seconds ) const override
	{
		// From the whole stairs down to the pile at their foot.
		const float fraction = float( std::min( 1.0, seconds / kCameraRide ) );
		const float ride = fraction * fraction * ( 3 - 2 * fraction );
		const auto between = [&]( float from, float to ) { return from + ( to - from ) * ride; };
		return { { between( 2.5f, 1.9f ), between( 1.95f, 1.5f ), between( 4.3f, 3.3f ) },
			{ between( -0.3f, 0.25f ), between( 0.8f, 0.36f ), 0 }, 38.0f };
	}
	pliant_glue::DrawLight light() const override { return { { -0.25f, 0.80f, 0.55f }, { 0, 0.6f, 0 }, 3.4f }; }

private:
	static void addStairs( Stage& stage )
	{
		for ( int k = 0; k < kSteps; ++k )
		{
			// Each step is a block down to the ground; the top one is the landing.
			const btScalar height = kRise * btScalar( kSteps - k );
			const btScalar tread = k == 0 ? 2 * kTread : kTread;
			const btScalar x = kStairsEnd - kTread * btScalar( kSteps - 1 - k ) - tread / 2;
			stage.addBox( btVector3( tread, height, kWidth ), at( x, height / 2, 0 ), 0, kStone );
		}
	}

	static void addDoor( Stage& stage )
	{
		const btScalar post = btScalar( 0.1 ), gap = btScalar( 0.02 );
		const btScalar postHeight = kDoorHeight + 3 * gap;
		stage.addBox( btVector3( post, postHeight, post ), at( kDoorX, postHeight / 2, -( kDoorWidth / 2 + gap + post / 2 ) ), 0, kOak );
		// Kerbs keep the pile between the stairs and the door.
		const btScalar kerb = btScalar( 0.16 ), length = kDoorX - kStairsEnd + post;
		for ( const int side : { -1, 1 } )
		{
			stage.addBox( btVector3( length, kerb, post ),
				at( kStairsEnd + length / 2, kerb / 2, btScalar( side ) * ( kWidth - post ) / 2 ), 0, kStone );
		}
		btRigidBody* door = stage.addBox(
			btVector3( btScalar( 0.06 ), kDoorHeight, kDoorWidth ), at( kDoorX, kDoorHeight / 2 + gap, 0 ), 6, kMoss );
		door->setActivationState( DISABLE_DEACTIVATION ); // a door that sleeps would not swing
		auto hinge = std::make_unique<btHingeConstraint>( *door, btVector3( 0, 0, -kDoorWidth / 2 ), btVector3( 0, 1, 0 ) );
		hinge->setLimit( btScalar( -1.9 ), btScalar( 1.9 ) );
		hinge->enableAngularMotor( true, 0, btScalar( 0.004 ) ); // the hinge's own friction
		stage.addConstraint( std::move( hinge ), true );
	}

	static void addLooseBodies( Stage& stage )
	{
		std::mt19937 random( stage.options().seed );
		// The numbers of mt19937 are the same on every system; those of the standard distributions are not.
		const auto between = [&]( btScalar low, btScalar high ) {
			return low + ( high - low ) * btScalar( random() ) / btScalar( 4294967296.0 );
		};
		const pliant_glue::Colour colours[] = { kSlate, kOchre, kBrick, kTeal };
		for ( int i = 0; i < kLooseBodies; ++i )
		{
			const bool isAtFoot = i % 2 == 0;
			const btScalar x = isAtFoot ? between( btScalar( 0.6 ), btScalar( 0.85 ) ) : between( btScalar( -1.6 ), btScalar( -0.2 ) );
			const btVector3 place( x, btScalar( 0.3 ) + btScalar( 0.11 ) * btScalar( i ) + ( isAtFoot ? 0 : btScalar( 0.7 ) ),
				between( btScalar( -0.5 ), btScalar( 0.5 ) ) );
			const pliant_glue::Colour& colour = colours[i % 4];
			if ( i % 3 == 0 )
			{
				const btScalar diameter = between( btScalar( 0.16 ), btScalar( 0.26 ) );
				stage.addSphere( diameter, place, 250 * diameter * diameter * diameter, colour );
			}
			else
			{
				const btVector3 size( between( btScalar( 0.13 ), btScalar( 0.26 ) ), between( btScalar( 0.12 ), btScalar( 0.22 ) ),
					between( btScalar( 0.13 ), btScalar( 0.26 ) ) );
				const btQuaternion turn( btVector3( between( -1, 1 ), 1, between( -1, 1 ) ).normalized(), between( 0, 3 ) );
				stage.addBox( size, btTransform( turn, place ), 300 * size.x() * size.y() * size.z(), colour );
			}
		}
	}

	static bool addBunny( Stage& stage )
	{
		pliant_glue::ModelMesh mesh = stage.modelOr( "bunny00.off", makeBunnyLike );
		fitHeight( mesh, 0.78f );
		SoftOrder order;
		order.name = "bunny";
		order.mesh = &mesh;
		order.cells = 2000;
		order.place = btTransform( btQuaternion( btVector3( 0, 1, 0 ), btScalar( 3.0 ) ),
			btVector3( btScalar( -1.35 ), btScalar( 1.6 ), btScalar( -0.1 ) ) ); // looks down the stairs
		order.material.density = 300.0f;
		order.material.youngsModulus = 4.0e4f; // soft foam: its own weight shortens it by about 2 %, the fall bends its ears flat
		order.material.damping = 25.0f;
		order.friction = btScalar( 0.6 );
		order.colour = kTerracotta;
		pliant::SoftBody* bunny = stage.addSoft( order );
		if ( bunny != nullptr )
		{
			mustSucceed( bunny->setVelocities( btVector3( btScalar( 1.4 ), 0, 0 ), btVector3( 0, 0, -2 ) ) );
		}
		return bunny != nullptr;
	}

	static bool addGlob( Stage& stage )
	{
		const pliant_glue::ModelMesh mesh = makeGlob();
		SoftOrder order;
		order.name = "Glob";
		order.mesh = &mesh;
		order.cells = 800;
		order.place = at( btScalar( -1.1 ), btScalar( 3.1 ), btScalar( -0.15 ) );
		order.material.density = 300.0f;
		order.material.youngsModulus = 2.0e4f;
		order.material.damping = 25.0f;
		order.friction = btScalar( 0.6 );
		order.colour = kPlum;
		pliant::SoftBody* glob = stage.addSoft( order );
		if ( glob != nullptr )
		{
			mustSucceed( glob->setVelocities( btVector3( 1, 0, 0 ), btVector3( 0, 0, -3 ) ) );
		}
		return glob != nullptr;
	}
};

} // namespace

std::unique_ptr<Scene> makeBunnyPile()
{
	return std::make_unique<BunnyPile>();
}

} // namespace pliant_demos
