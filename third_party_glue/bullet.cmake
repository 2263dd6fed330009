# Bullet as one imported target, pliant::bullet, in the precision asked for.
# CMake's own module (not Debian's config file, whose paths are relative) finds the float libraries; pkg-config the double ones.

if( NOT TARGET pliant::bullet )
	add_library( pliant::bullet INTERFACE IMPORTED GLOBAL )
	if( PLIANT_DOUBLE )
		find_package( PkgConfig REQUIRED )
		pkg_check_modules( PLIANT_BULLET_DOUBLE REQUIRED IMPORTED_TARGET bullet-float64>=3.24 )
		target_link_libraries( pliant::bullet INTERFACE PkgConfig::PLIANT_BULLET_DOUBLE )
		target_compile_definitions( pliant::bullet INTERFACE BT_USE_DOUBLE_PRECISION )
	else()
		find_package( Bullet MODULE REQUIRED )
		target_include_directories( pliant::bullet SYSTEM INTERFACE ${BULLET_INCLUDE_DIRS} )
		target_link_libraries( pliant::bullet INTERFACE ${BULLET_DYNAMICS_LIBRARY} ${BULLET_COLLISION_LIBRARY} ${BULLET_MATH_LIBRARY} )
	endif()
endif()
