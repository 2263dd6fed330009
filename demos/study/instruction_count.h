#pragma once

// Instructions of this thread in user space, by the processor's own counter: unlike times, the same in every run.

#include <cstdint>

namespace pliant_study {

class InstructionCount
{
public:
	InstructionCount();
	~InstructionCount();
	InstructionCount( const InstructionCount& ) = delete;
	InstructionCount& operator=( const InstructionCount& ) = delete;

	/// False if the system has no such counter, or gives no access to it.
	bool works() const { return m_file >= 0; }
	/// Since construction.
	std::uint64_t now() const;

private:
	int m_file = -1;
};

} // namespace pliant_study
