#pragma once

// One loop over independent tasks, in the calling thread or through a TaskRunner. Tasks write to their own places only, so that
// results do not depend on how they are spread.

#include "pliant/task_runner.h"

namespace pliant {

template <class F>
void runTasks( TaskRunner* runner, int count, F& task )
{
	if ( runner && count > 1 && runner->threadCount() > 1 )
	{
		runner->run( count, []( void* context, int index ) { ( *static_cast<F*>( context ) )( index ); }, &task );
		return;
	}
	for ( int i = 0; i < count; ++i )
	{
		task( i );
	}
}

} // namespace pliant
