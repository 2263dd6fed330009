#pragma once

// Which symbols a shared build of Pliant shows. A static build needs none of it.

#if defined( PLIANT_SHARED )
	#if defined( _WIN32 )
		#if defined( PLIANT_BUILDING )
			#define PLIANT_API __declspec( dllexport )
		#else
			#define PLIANT_API __declspec( dllimport )
		#endif
	#else
		#define PLIANT_API __attribute__( ( visibility( "default" ) ) )
	#endif
#else
	#define PLIANT_API
#endif
