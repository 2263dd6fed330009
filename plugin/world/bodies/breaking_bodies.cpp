// Which links break, and the settings of breaking.

#include "body/breaking.h"
#include "world/bodies/soft_body_impl.h"
#include "world/step/soft_body_system.h"
#include "world/stopwatch.h"

#include "threads/parallel.h"

#include <algorithm>

namespace pliant {

float SoftBody::fadeFraction() const
{
	const Fading& fading = m_impl->fading;
	return fading.time > 0.0f ? std::clamp( float( fading.left ) / fading.time, 0.0f, 1.0f ) : 1.0f;
}

void SoftBodySystem::testLinks( btScalar h )
{
	std::vector<SoftBody*> testing;
	for ( SoftBody* body : m_awake )
	{
		if ( body->impl().body->breaking() && moves( *body ) )
		{
			testing.push_back( body );
		}
	}
	if ( testing.empty() )
	{
		return;
	}
	Stopwatch watch( report.fracture );
	auto test = [&]( int k ) { testing[std::size_t( k )]->impl().body->testLinks( float( h ) ); };
	runTasks( tasks(), int( testing.size() ), test );
}

Status SoftBody::setFracture( const Fracture& fracture, const ToughnessField& toughness, const ShardCentres& centres )
{
	if ( Status status = m_impl->checkTime( "setFracture" ); !status.ok() )
	{
		return status;
	}
	Status status = m_impl->body->setFracture( fracture, toughness, centres );
	m_impl->mustDeform = m_impl->mustDeform || status.ok();
	if ( status.ok() && fracture.rule != BreakRule::Never )
	{
		m_impl->bodyTemplate->crackComplex(); // built now, not when the first crack opens
	}
	if ( status.ok() )
	{
		activate( true ); // a sleeping body may be stretched beyond the new limit
	}
	return status;
}

Fracture SoftBody::fracture() const
{
	return m_impl->body->fracture();
}

} // namespace pliant
