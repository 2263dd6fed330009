#pragma once

// Progress of a long job: one line redrawn on a terminal, a line every tenth in a log.

#include <string>

namespace pliant_demos {

/// True if output goes to a terminal, on which lines can be redrawn.
bool standardOutputIsTerminal();

class ProgressLine
{
public:
	ProgressLine( std::string name, int total );
	void show( int done );
	void end();

private:
	std::string m_name;
	int m_total;
	int m_lastTenth = 0;
	bool m_isTerminal;
};

} // namespace pliant_demos
