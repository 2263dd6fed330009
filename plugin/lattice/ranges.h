#pragma once

// Whether settings are in range.

#include "pliant/result.h"

#include <initializer_list>

namespace pliant {

/// A condition, and what is said where it does not hold.
struct Requirement
{
	bool holds;
	const char* sentence;
};

/// The sentence of the first requirement that does not hold; null: all do.
inline const char* firstUnmet( std::initializer_list<Requirement> requirements )
{
	for ( const Requirement& each : requirements )
	{
		if ( !each.holds )
		{
			return each.sentence;
		}
	}
	return nullptr;
}

/// The same as the outcome of a call.
inline Status require( ResultCode code, std::initializer_list<Requirement> requirements )
{
	const char* const unmet = firstUnmet( requirements );
	return unmet ? Status{ code, unmet } : Status{};
}

/// False for NaN.
template <class T>
bool isWithin( T value, T low, T high )
{
	return value >= low && value <= high;
}

/// False for a number that is none of an enumeration's, from 0 to `last`, as a file or another language may give.
template <class Choice>
bool isChoice( Choice value, Choice last )
{
	return int( value ) >= 0 && int( value ) <= int( last );
}

} // namespace pliant
