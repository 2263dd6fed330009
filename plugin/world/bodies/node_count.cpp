// Counts the nodes on each level for the report.

#include "body/levels/levels.h"
#include "world/bodies/soft_body_impl.h"
#include "world/step/soft_body_system.h"

#include <algorithm>
#include <iterator>

namespace pliant {

void SoftBodySystem::countNodes()
{
	report.nodes = 0;
	std::fill( std::begin( report.nodesOnLevel ), std::end( report.nodesOnLevel ), 0 );
	for ( const SoftBody* body : m_bodies )
	{
		report.nodes += body->nodeCount();
		if ( const Levels* levels = body->impl().body->levels() )
		{
			for ( std::size_t level = 0; level < levels->nodesOnLevel().size(); ++level )
			{
				report.nodesOnLevel[level] += levels->nodesOnLevel()[level];
			}
			continue;
		}
		report.nodesOnLevel[0] += body->nodeCount();
	}
}

} // namespace pliant
