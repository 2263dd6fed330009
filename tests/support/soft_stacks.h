#pragma once

// Stacks of soft cubes, with or without rigid boxes between them, each element dropped from a small height.

#include "support/explicit_material.h"
#include "support/test_world.h"

#include <algorithm>

namespace pliant::test {

struct Stack
{
	int cubes = 4;
	bool hasBoxes = false;
	float youngsModulus = 4e7f;
	double friction = 0.5; ///< of each element; 0.5 is Bullet's default
	double gap = 0.01;     ///< height from which each falls onto the next, m
	Elasticity elasticity = Elasticity::Implicit;
};

/// Every other cube, of 6 x 6 x 6 cells of 0.1 m, is offset a little.
struct StackScene : SoftWorld
{
	double top = 0.0; ///< height of the top cube's centre without gaps below it, m

	explicit StackScene( const Stack& stack )
	{
		world.setGravity( btVector3( 0, -10, 0 ) );
		addBoxFloor();
		const auto shape = cubeTemplate( 0.6f, 6 );
		Material material = test::explicitMaterial();
		material.youngsModulus = stack.youngsModulus;
		material.elasticity = stack.elasticity;
		double y = stack.gap;
		for ( int k = 0; k < stack.cubes; ++k )
		{
			const btScalar aside = k % 2 == 0 ? btScalar( 0 ) : btScalar( 0.02 );
			add( shape, btVector3( aside, btScalar( y + 0.3 ), aside / 2 ), material )->setFriction( btScalar( stack.friction ) );
			y += 0.6 + stack.gap;
			if ( stack.hasBoxes && k + 1 < stack.cubes )
			{
				add( 216, new btBoxShape( btVector3( btScalar( 0.3 ), btScalar( 0.1 ), btScalar( 0.3 ) ) ),
					btVector3( 0, btScalar( y + 0.1 ), 0 ) )
					->setFriction( btScalar( stack.friction ) );
				y += 0.2 + stack.gap;
			}
		}
		top = y - 0.3 - stack.gap;
	}

	bool sleeps() const
	{
		return std::all_of( soft.begin(), soft.end(), []( const auto& cube ) { return cube->getActivationState() == ISLAND_SLEEPING; } );
	}
};

} // namespace pliant::test
