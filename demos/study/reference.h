#pragma once

// What errors are measured against: kept in a file, since it takes the longest to make.

#include "demos/study/measure.h"

#include <string>

namespace pliant_study {

/// Of the reference itself, or of its turned twin, which says how far two references are apart.
bool isReference( const Record& record );

struct Reference
{
	Track track;
	double brokenAt = -1;
};

/// From `path` if it is there and fits, else false.
bool read( const std::string& path, const Specimen& specimen, Reference& to );
bool write( const std::string& path, const Reference& reference );

} // namespace pliant_study
