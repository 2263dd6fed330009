#pragma once

// Marks the symbols that a shared library of Pliant exports. Outside Windows the mark costs a static library nothing, so it is always set.

#if defined( _WIN32 )
	#if defined( PLIANT_SHARED ) && defined( PLIANT_BUILDING )
		#define PLIANT_API __declspec( dllexport )
	#elif defined( PLIANT_SHARED )
		#define PLIANT_API __declspec( dllimport )
	#else
		#define PLIANT_API
	#endif
#else
	#define PLIANT_API __attribute__( ( visibility( "default" ) ) )
#endif
