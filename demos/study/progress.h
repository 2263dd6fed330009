#pragma once

// Progress of a long study, the remaining time, and requests to stop it.

#include <chrono>
#include <string>

namespace pliant_study {

class Progress
{
public:
	explicit Progress( int total );
	~Progress();
	void begin( const std::string& what );
	void done();

private:
	int m_total, m_done = 0, m_lastTenth = 0;
	bool m_isTerminal;
	std::string m_what;
	std::chrono::steady_clock::time_point m_start;
	void show();
};

/// After this call the first interrupt (Ctrl+C) or termination signal requests a stop, the second ends the process.
void listenForStop();
bool stopWasAsked();

} // namespace pliant_study
