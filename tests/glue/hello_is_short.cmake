# The README promises a whole program in at most 40 lines.
# Usage: cmake -DFILE=<hello_soft_body.cpp> -P hello_is_short.cmake

file( READ ${FILE} text )
string( REGEX MATCHALL "\n" newlines "${text}" )
list( LENGTH newlines lines )
if( lines GREATER 40 OR lines LESS 10 )
	message( FATAL_ERROR "${FILE} has ${lines} lines" )
endif()
