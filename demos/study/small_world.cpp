// +-----------------------------------------------------------------------------------------------------------------+
// | A world of Pliant's with blocks in it.                                                                           |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/small_world.h"

#include "demos/shapes.h"
#include "demos/study/subject.h"

#include <chrono>

namespace pliant_study {

std::shared_ptr<const pliant::BodyTemplate> cubeTemplate( int edge, double cell, pliant::Skinning skinning )
{
	const pliant_glue::ModelMesh mesh = pliant_demos::makeCube( float( edge * cell ), 8 );
	pliant::LatticeSettings settings;
	settings.cellSize = float( cell );
	settings.maxCells = 10000000;
	settings.skinning = skinning;
	settings.samplesPerEdge = 1; // cells are full, so that more samples give the same
	const auto made = pliant::BodyTemplate::build(
		{ mesh.positions.data(), mesh.vertexCount(), 3, mesh.indices.data(), mesh.triangleCount(), nullptr, nullptr }, settings );
	return made.value;
}

SmallWorld::SmallWorld() = default;

SmallWorld::~SmallWorld()
{
	for ( const auto& body : m_bodies )
	{
		m_world.removeSoftBody( body.get() );
	}
	if ( m_ground )
	{
		m_world.removeRigidBody( m_ground.get() );
	}
}

pliant::SoftBody* SmallWorld::add( const std::shared_ptr<const pliant::BodyTemplate>& shape, const btVector3& at,
	const pliant::Material& material, const pliant::Adaptivity& adaptivity )
{
	auto made = pliant::SoftBody::create( shape, btTransform( btQuaternion::getIdentity(), at ), material, adaptivity );
	if ( !made )
	{
		return nullptr;
	}
	made.value->setActivationState( DISABLE_DEACTIVATION );
	m_world.addSoftBody( made.value.get() );
	m_bodies.push_back( std::move( made.value ) );
	return m_bodies.back().get();
}

void SmallWorld::addGround()
{
	m_ground = std::make_unique<btRigidBody>( btScalar( 0 ), nullptr, &m_plane );
	m_world.addRigidBody( m_ground.get() );
}

double SmallWorld::timedStep( bool isLookedAt )
{
	const auto start = std::chrono::steady_clock::now();
	m_world.stepSimulation( btScalar( kGameStep ), 0 );
	for ( std::size_t k = 0; isLookedAt && k < m_bodies.size(); ++k )
	{
		m_bodies[k]->surface();
	}
	return std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count();
}

} // namespace pliant_study
