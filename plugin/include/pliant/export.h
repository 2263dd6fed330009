#pragma once

// Which symbols a shared library of Pliant shows. Elsewhere than on Windows the mark costs a static library nothing, so it always stands.

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
