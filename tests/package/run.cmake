# Installs what was built, configures and builds the program beside this file against it, and runs it.
# Usage: cmake -DBUILD=… -DWORK=… -DSCENE=… [-DFLAGS=…] -P run.cmake
function(must)
    execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(NOT status EQUAL 0)
        list(JOIN ARGV " " command)
        message(FATAL_ERROR "${command}: ${status}\n${output}")
    endif()
    set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
must(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
must(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${WORK}/build -G Ninja
     -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCMAKE_CXX_FLAGS=${FLAGS})
must(${CMAKE_COMMAND} --build ${WORK}/build)
must(${WORK}/build/lamp ${SCENE})
# A furnace: exitance 1, reflectance 0.8, closed, so that the radiosity is 5 on every wall.
string(REGEX MATCHALL "[^\n]+ 5\n" lines "${output}")
list(LENGTH lines count)
if(NOT count EQUAL GROUPS)
    message(FATAL_ERROR "${GROUPS} groups should have radiosity 5:\n${output}")
endif()
must(${WORK}/prefix/bin/hemi info ${SCENE})
file(REMOVE_RECURSE ${WORK})
