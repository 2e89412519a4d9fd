# Installs what was built, builds examples/cpp against it in a clean folder, and holds its picture against the
# command line's and the library's symbols against its interface:
#   cmake -D BUILD=... -D SOURCE=... -D FOLDER=... -D GENERATOR=... -D CXX=... -D NM=... -D LIBDIR=...
#     -P library_example.cmake
cmake_minimum_required(VERSION 3.25)

function(run)
  execute_process(COMMAND ${ARGV} WORKING_DIRECTORY ${FOLDER} RESULT_VARIABLE status OUTPUT_VARIABLE text
                  ERROR_VARIABLE text)
  if(NOT status EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "${command}: ${status}\n${text}")
  endif()
  set(text "${text}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${FOLDER}/installed)
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE}/examples/cpp -B ${FOLDER}/build
    -D CMAKE_PREFIX_PATH=${FOLDER}/installed
    -D CMAKE_CXX_COMPILER=${CXX} -D "CMAKE_CXX_FLAGS=-Wall -Wextra -Wpedantic -Werror")
run(${CMAKE_COMMAND} --build ${FOLDER}/build)
run(${FOLDER}/build/necklace own.png own.npz)
set(scene ${SOURCE}/scenes/shapes.nff)
run(${FOLDER}/build/necklace library.png library.npz ${scene})
set(options render ${scene} --size 400x300 --aa 3 --soft-shadows --quiet)
run(${FOLDER}/installed/bin/raio ${options} -o program.png)
run(${FOLDER}/installed/bin/raio ${options} --channels depth -o program.npz)
foreach(suffix png npz)
  run(${CMAKE_COMMAND} -E compare_files library.${suffix} program.${suffix})
endforeach()

# The header by itself, by the oldest standard that it promises.
file(WRITE ${FOLDER}/alone.cpp "#include <raio/raio.h>\n#include <raio/raio.h>\nint main() { return raio::version().empty(); }\n")
run(${CXX} -std=c++17 -Wall -Wextra -Wpedantic -Werror -fsyntax-only -I${FOLDER}/installed/include alone.cpp)

run(${NM} -D -C --defined-only ${FOLDER}/installed/${LIBDIR}/libraio.so)
string(REGEX MATCHALL "[^\n]+" symbols "${text}")
foreach(symbol IN LISTS symbols)
  if(NOT symbol MATCHES "raio::v1::")
    message(FATAL_ERROR "the library exports what is not of its interface: ${symbol}")
  endif()
endforeach()
list(LENGTH symbols count)
message(STATUS "${count} symbols, all of the interface")
