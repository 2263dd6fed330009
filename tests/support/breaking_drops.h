#pragma once

// Bars that fall on the floor and break, on several levels: fracture must not depend on the coarseness of the body.

#include "support/explicit_material.h"
#include "support/random_impacts.h"
#include "support/test_world.h"

namespace pliant::test {

/// A bar of 20 x 10 x 10 cells of 3 cm.
inline const std::shared_ptr<const BodyTemplate>& fallingBar()
{
	static const std::shared_ptr<const BodyTemplate> bar = boxTemplate( { 0.6f, 0.3f, 0.3f }, 0.03f );
	return bar;
}

struct Drop
{
	Elasticity elasticity = Elasticity::Explicit;
	BreakRule rule = BreakRule::Plane;
	float breakStrain = 0.35f;
	int coarseLevels = 0;
	bool refinesOnContact = false;
};

/// Returns the number of links that break within half a second after a randomly rotated bar strikes the floor at 6 to 9 m/s.
inline int linksBrokenBy( const Drop& drop, unsigned seed )
{
	Random random( seed );
	SoftWorld world;
	world.addBoxFloor();
	Material material = test::explicitMaterial();
	material.density = 300.0f;
	material.youngsModulus = 3e4f;
	material.damping = 25.0f;
	material.elasticity = drop.elasticity;
	Adaptivity levels;
	levels.coarseLevels = drop.coarseLevels;
	levels.refinesOnContact = drop.refinesOnContact;
	SoftBody* const body = world.add( fallingBar(), btVector3( 0, btScalar( 0.45 ), 0 ), material, random.turn(), levels );
	static_cast<void>( body->setVelocities( btVector3( 0, random.between( -9, -6 ), 0 ), btVector3( 0, 0, 0 ) ) );
	Fracture fracture;
	fracture.rule = drop.rule;
	fracture.breakStrain = drop.breakStrain;
	static_cast<void>( body->setFracture( fracture ) );
	int links = 0;
	for ( int frame = 0; frame < 30; ++frame )
	{
		world.step( 1 );
		links += world.world.stepReport().brokenLinks;
	}
	return links;
}

} // namespace pliant::test
