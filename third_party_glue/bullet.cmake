# Bullet as one imported target, pliant::bullet, in the precision that PLIANT_DOUBLE asks for. The build includes this file, and so does
# the installed package, so that both find Bullet alike. When there is none that fits, PLIANT_BULLET_PROBLEM says why.
#
# CMake's own module finds Bullet's plain libraries: Debian's BulletConfig.cmake holds relative paths and names no targets.
# pkg-config finds Debian's double-precision ones, which bear other names; elsewhere Bullet's plain libraries may be the double ones.

set( PLIANT_BULLET_PROBLEM "" )

macro( pliant_find_plain_bullet )
	find_package( Bullet MODULE QUIET )
	if( BULLET_FOUND )
		target_include_directories( pliant::bullet SYSTEM INTERFACE ${BULLET_INCLUDE_DIRS} )
		target_link_libraries( pliant::bullet INTERFACE ${BULLET_DYNAMICS_LIBRARY} ${BULLET_COLLISION_LIBRARY} ${BULLET_MATH_LIBRARY} )
	else()
		set( PLIANT_BULLET_PROBLEM "Bullet was not found (Debian: libbullet-dev; elsewhere set BULLET_ROOT)" )
	endif()
endmacro()

# A translation unit and a library of different precision share most symbol names, and would link and crash: see whether the one
# function whose name tells them apart is there.
macro( pliant_check_bullet_precision variable )
	include( CheckCXXSourceCompiles )
	set( CMAKE_REQUIRED_LIBRARIES pliant::bullet )
	check_cxx_source_compiles( "
		#include <btBulletDynamicsCommon.h>
		#if BT_BULLET_VERSION < 324
		#error older than 3.24
		#endif
		int main( int count, char** ) { btDiscreteDynamicsWorld* world = nullptr; return count < 99 ? 0 : world->btDiscreteDynamicsWorld::stepSimulation( btScalar( 1 ) ); }
		" ${variable} )
	unset( CMAKE_REQUIRED_LIBRARIES )
endmacro()

if( NOT TARGET pliant::bullet )
	add_library( pliant::bullet INTERFACE IMPORTED GLOBAL )
	if( PLIANT_DOUBLE )
		target_compile_definitions( pliant::bullet INTERFACE BT_USE_DOUBLE_PRECISION )
		find_package( PkgConfig QUIET )
		if( PKG_CONFIG_FOUND )
			pkg_check_modules( PLIANT_BULLET_DOUBLE QUIET IMPORTED_TARGET GLOBAL bullet-float64>=3.24 )
		endif()
		if( TARGET PkgConfig::PLIANT_BULLET_DOUBLE )
			target_link_libraries( pliant::bullet INTERFACE PkgConfig::PLIANT_BULLET_DOUBLE )
		else()
			pliant_find_plain_bullet()
		endif()
		set( PLIANT_BULLET_CHECK PLIANT_BULLET_IS_DOUBLE )
	else()
		pliant_find_plain_bullet()
		set( PLIANT_BULLET_CHECK PLIANT_BULLET_IS_FLOAT )
	endif()
	if( NOT PLIANT_BULLET_PROBLEM )
		pliant_check_bullet_precision( ${PLIANT_BULLET_CHECK} )
		if( NOT ${PLIANT_BULLET_CHECK} )
			set( PLIANT_BULLET_PROBLEM "Bullet was found, but a program of the asked precision (PLIANT_DOUBLE=${PLIANT_DOUBLE}) does not link with it, or it is older than 3.24. Debian's libbullet-dev holds both precisions; with pkg-config the double ones are found" )
		endif()
	endif()
endif()
