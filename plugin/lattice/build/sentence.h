#pragma once

// Sentences for the person who reads a Status.

#include <sstream>
#include <string>

namespace pliant {

/// Words and numbers one after the other, numbers as streams write them.
template <class... Words>
std::string sentence( const Words&... words )
{
	std::ostringstream out;
	( out << ... << words );
	return out.str();
}

} // namespace pliant
