// +-----------------------------------------------------------------------------------------------------------------+
// | hello: the smallest scene, one soft cube on one rigid box. hello_soft_body.cpp is the same without the pictures.  |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"

namespace pliant_demos {

namespace {

class Hello : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		stage.addGround( btScalar( 0.6 ) );
		stage.addBox( btVector3( 1, btScalar( 0.4 ), 1 ), btTransform( btQuaternion::getIdentity(), btVector3( 0, btScalar( 0.2 ), 0 ) ),
			20, kSlate );
		const pliant_glue::ModelMesh cube = makeCube( 0.5f, 16 );
		SoftOrder order;
		order.name = "cube";
		order.mesh = &cube;
		order.cells = 512;
		// Lands on an edge, so that it is seen to be soft.
		order.place = btTransform( btQuaternion( btVector3( 0, 0, 1 ), btScalar( 0.6 ) ), btVector3( 0, btScalar( 1.6 ), 0 ) );
		order.material.youngsModulus = 4.0e4f;
		order.material.density = 500.0f;
		order.material.damping = 6.0f;
		order.colour = kTerracotta;
		return stage.addSoft( order ) != nullptr;
	}

	double duration() const override { return 3.0; }
	pliant_glue::DrawCamera camera( double ) const override { return { { 1.7f, 1.5f, 2.4f }, { 0, 0.55f, 0 }, 38.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.55f, 0.75f, 0.35f }, { 0, 0.6f, 0 }, 2.2f }; }
};

} // namespace

std::unique_ptr<Scene> makeHello()
{
	return std::make_unique<Hello>();
}

} // namespace pliant_demos
