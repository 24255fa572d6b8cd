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
file(READ ${WORK}/build/worker worker)

# Worker processes are in use: without their program nothing is drawn.
set(ENV{HEMI_WORKER} ${WORK}/nowhere)
execute_process(COMMAND ${WORK}/build/memory RESULT_VARIABLE status OUTPUT_QUIET ERROR_VARIABLE problem)
if(status EQUAL 0 OR NOT problem MATCHES "nowhere cannot be started")
    message(FATAL_ERROR "a worker program that is not there should have been missed: ${status} ${problem}")
endif()
set(ENV{HEMI_WORKER} ${worker})

# A furnace: exitance 1, reflectance 0.8, closed, so that the radiosity is 5 everywhere.
must(${WORK}/build/memory)
string(REGEX MATCHALL "[^\n]+" values "${output}")
list(LENGTH values count)
if(NOT count EQUAL 96)
    message(FATAL_ERROR "96 patches should have a radiosity:\n${output}")
endif()
foreach(value IN LISTS values)
    if(NOT value MATCHES "^(5|4\\.9999[0-9]*|5\\.0000[0-9]*)$")
        message(FATAL_ERROR "the radiosity should be 5:\n${output}")
    endif()
endforeach()

file(MAKE_DIRECTORY ${WORK}/results)
execute_process(COMMAND ${WORK}/build/lamp ${SCENE} WORKING_DIRECTORY ${WORK}/results RESULT_VARIABLE status
    ERROR_VARIABLE problem)
if(NOT status EQUAL 0)
    message(FATAL_ERROR "lamp: ${status} ${problem}")
endif()
must(${WORK}/prefix/bin/hemi info ${WORK}/results/room.hres --json)
if(NOT output MATCHES "\"kind\":\"result\"")
    message(FATAL_ERROR "room.hres should hold the solution:\n${output}")
endif()
file(SIZE ${WORK}/results/room.png bytes)
if(bytes LESS 1000)
    message(FATAL_ERROR "room.png should hold a picture")
endif()

# The installed program finds its worker without being told.
unset(ENV{HEMI_WORKER})
must(${WORK}/prefix/bin/hemi factors ${SCENE} --preset fast --jobs 2 --device osmesa -q)
must(${WORK}/prefix/bin/hemi info ${SCENE})
foreach(file man/man1/hemi.1 man/man1/hemi-solve.1 bash-completion/completions/hemi)
    if(NOT EXISTS ${WORK}/prefix/share/${file})
        message(FATAL_ERROR "share/${file} should have been installed")
    endif()
endforeach()
file(REMOVE_RECURSE ${WORK})
