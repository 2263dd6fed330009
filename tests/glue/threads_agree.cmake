# Runs a scene with one thread and with four; both must end in the same bits.
# Usage: cmake -DDEMO=<pliant_demos> -DSCENE=<name> -DOUT=<folder> -P threads_agree.cmake

foreach( threads 1 4 )
	execute_process( COMMAND ${DEMO} --scene ${SCENE} --frames 30 --no-render --threads ${threads} --out ${OUT}/${threads} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY )
	file( READ ${OUT}/${threads}/summary.json summary )
	string( JSON hash_${threads} GET ${summary} stateHash )
	string( JSON nodes GET ${summary} nodes )
	if( nodes LESS 1 )
		message( FATAL_ERROR "${SCENE} has no nodes: equal hashes would show nothing" )
	endif()
endforeach()
if( NOT hash_1 STREQUAL hash_4 )
	message( FATAL_ERROR "${SCENE}: state hash ${hash_1} with 1 thread, ${hash_4} with 4" )
endif()
