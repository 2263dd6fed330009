// +-----------------------------------------------------------------------------------------------------------------+
// | Instructions, by Linux's perf_event_open.                                                                        |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/instruction_count.h"

#if defined( __linux__ )
	#include <linux/perf_event.h>
	#include <sys/syscall.h>
	#include <unistd.h>
#endif

namespace pliant_study {

#if defined( __linux__ )

InstructionCount::InstructionCount()
{
	perf_event_attr wanted{};
	wanted.type = PERF_TYPE_HARDWARE;
	wanted.size = sizeof( wanted );
	wanted.config = PERF_COUNT_HW_INSTRUCTIONS;
	wanted.exclude_kernel = 1;
	wanted.exclude_hv = 1;
	m_file = int( syscall( SYS_perf_event_open, &wanted, 0, -1, -1, 0 ) );
}

InstructionCount::~InstructionCount()
{
	if ( m_file >= 0 )
	{
		close( m_file );
	}
}

std::uint64_t InstructionCount::now() const
{
	std::uint64_t count = 0;
	return m_file >= 0 && read( m_file, &count, sizeof( count ) ) == ssize_t( sizeof( count ) ) ? count : 0;
}

#else

InstructionCount::InstructionCount() = default;
InstructionCount::~InstructionCount() = default;

std::uint64_t InstructionCount::now() const
{
	return 0;
}

#endif

} // namespace pliant_study
