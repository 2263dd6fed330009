#pragma once

// Instructions of this thread in user space, by the processor's own counter: the same from run to run where times are not.

#include <cstdint>

namespace pliant_study {

class InstructionCount
{
public:
	InstructionCount();
	~InstructionCount();
	InstructionCount( const InstructionCount& ) = delete;
	InstructionCount& operator=( const InstructionCount& ) = delete;

	/// False where the system has no such counter, or does not let us see it.
	bool works() const { return m_file >= 0; }
	/// Since it was made.
	std::uint64_t now() const;

private:
	int m_file = -1;
};

} // namespace pliant_study
