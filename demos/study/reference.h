#pragma once

// The reference for errors: stored in a file, since it takes the longest to compute.

#include "demos/study/measure.h"

#include <string>

namespace pliant_study {

/// Of the reference itself, or of the second reference on a rotated lattice, which gives the distance between two references.
bool isReference( const Record& record );

struct Reference
{
	Track track;
	double brokenAt = -1;
};

/// Reads `path` if it exists and fits; otherwise returns false.
bool read( const std::string& path, const Specimen& specimen, Reference& to );
bool write( const std::string& path, const Reference& reference );

} // namespace pliant_study
