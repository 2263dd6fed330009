// +-----------------------------------------------------------------------------------------------------------------+
// | A stage's world, of one of Bullet's classes, and its destruction.                                                 |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/stage.h"

#include <pliant/soft_body_world_over.h>

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>

namespace pliant_demos {

Stage::Stage( const StageOptions& options, std::string name, StageWorld kind ) :
	m_options( options ), m_name( std::move( name ) ), m_configuration( new btDefaultCollisionConfiguration ),
	m_dispatcher( new btCollisionDispatcher( m_configuration.get() ) ), m_broadphase( new btDbvtBroadphase )
{
	if ( kind == StageWorld::MultiBodies )
	{
		auto solver = std::make_unique<btMultiBodyConstraintSolver>();
		auto world = std::make_unique<pliant::SoftBodyWorldOver<btMultiBodyDynamicsWorld>>(
			m_dispatcher.get(), m_broadphase.get(), solver.get(), m_configuration.get() );
		m_host = world.get();
		m_multiBodies = world.get();
		m_solver = std::move( solver );
		m_world = std::move( world );
	}
	else
	{
		m_solver = std::make_unique<btSequentialImpulseConstraintSolver>();
		auto world = std::make_unique<pliant::SoftBodyWorld>(
			m_dispatcher.get(), m_broadphase.get(), m_solver.get(), m_configuration.get() );
		m_host = m_plain = world.get();
		m_world = std::move( world );
	}
	m_host->setThreadCount( options.threads );
	if ( options.softSubsteps > 0 )
	{
		m_host->setSoftSubsteps( options.softSubsteps );
	}
}

Stage::~Stage()
{
	for ( const auto& constraint : m_constraints )
	{
		m_world->removeConstraint( constraint.get() );
	}
	for ( const SoftItem& item : m_soft )
	{
		if ( item.owned != nullptr )
		{
			m_host->removeSoftBody( item.body );
		}
	}
	for ( const RigidItem& item : m_rigid )
	{
		m_world->removeRigidBody( item.body.get() );
	}
}

} // namespace pliant_demos
