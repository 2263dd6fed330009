#pragma once

// Seconds between two lines, added up where the step report keeps them.

#include <chrono>

namespace pliant {

class Stopwatch
{
public:
	explicit Stopwatch( double& to ) : m_to( to ), m_start( std::chrono::steady_clock::now() ) {}
	~Stopwatch() { m_to += std::chrono::duration<double>( std::chrono::steady_clock::now() - m_start ).count(); }
	Stopwatch( const Stopwatch& ) = delete;
	Stopwatch& operator=( const Stopwatch& ) = delete;

private:
	double& m_to;
	std::chrono::steady_clock::time_point m_start;
};

} // namespace pliant
