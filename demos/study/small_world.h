#pragma once

// A world of Pliant's with blocks in it, for measurements.

#include "demos/study/specimen.h"

#include <pliant/soft_body_world.h>

#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

namespace pliant_study {

/// Cells of a cube of `edge` cells an edge, each `cell` m. Null if it is refused.
std::shared_ptr<const pliant::BodyTemplate> cubeTemplate( int edge, double cell, pliant::Skinning skinning );

/// A world and its collision classes, in the order of destruction.
struct WorldParts
{
	btDefaultCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher{ &configuration };
	btDbvtBroadphase broadphase;
	btSequentialImpulseConstraintSolver solver;
	pliant::SoftBodyWorld world{ &dispatcher, &broadphase, &solver, &configuration };
};

class SmallWorld
{
public:
	SmallWorld();
	~SmallWorld();

	pliant::SoftBodyWorld& world() { return m_world; }
	/// Null if it is refused. Never falls asleep.
	pliant::SoftBody* add( const std::shared_ptr<const pliant::BodyTemplate>& shape, const btVector3& at, const pliant::Material& material,
		const pliant::Adaptivity& adaptivity = {} );
	void addGround();
	const std::vector<std::unique_ptr<pliant::SoftBody>>& bodies() const { return m_bodies; }
	/// s, of the step and, if they are read, of the skins.
	double timedStep( bool isLookedAt = true );

private:
	WorldParts m_parts;
	pliant::SoftBodyWorld& m_world = m_parts.world;
	btStaticPlaneShape m_plane{ btVector3( 0, 1, 0 ), btScalar( 0 ) };
	std::unique_ptr<btRigidBody> m_ground;
	std::vector<std::unique_ptr<pliant::SoftBody>> m_bodies;
};

} // namespace pliant_study
