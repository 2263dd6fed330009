#pragma once

// Composes messages for a Status.

#include <sstream>
#include <string>

namespace pliant {

/// Concatenates words and numbers, with stream formatting.
template <class... Words>
std::string sentence( const Words&... words )
{
	std::ostringstream out;
	( out << ... << words );
	return out.str();
}

} // namespace pliant
