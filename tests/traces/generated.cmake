# The committed recording is what the generator makes of its recipe, byte for byte.
# cmake -DPROGRAM=... -DFOLDER=... -DOUTPUT=... -P generated.cmake
execute_process(COMMAND ${PROGRAM} ${FOLDER}/recipe.txt ${OUTPUT} RESULT_VARIABLE code)
if(code)
  message(FATAL_ERROR "${PROGRAM} ended with ${code}")
endif()
file(SHA256 ${OUTPUT} made)
file(SHA256 ${FOLDER}/hand.csv kept)
if(NOT made STREQUAL kept)
  message(FATAL_ERROR "${FOLDER}/hand.csv is not what its recipe gives; make it anew: cmake --build . --target traces")
endif()
