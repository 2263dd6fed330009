#pragma once

// Pliant's version. This is its only definition; CMakeLists.txt reads it from this file.

#define PLIANT_VERSION_MAJOR 0
#define PLIANT_VERSION_MINOR 1
#define PLIANT_VERSION_PATCH 0
