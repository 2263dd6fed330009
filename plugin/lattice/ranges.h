#pragma once

// Whether settings are in range.

namespace pliant {

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
