# Fails if a file includes a header of a room that its own room must not include, or calls a function that C libraries
# round differently:
#   cmake -D RULES="base=base;shape=shape,base;..." -D SOURCE_DIR=.../src -P check_rooms.cmake
# A project header is included by room and name, "room/file.h", never by a relative path, so that it
# can be checked against the list. Files in no room (src/main.cpp) may include any.
cmake_minimum_required(VERSION 3.25)

foreach(rule IN LISTS RULES)
  string(REGEX MATCH "^([^=]+)=(.*)$" rule "${rule}")
  list(APPEND rooms ${CMAKE_MATCH_1})
  string(REPLACE "," ";" looks_into_${CMAKE_MATCH_1} "${CMAKE_MATCH_2}")
endforeach()

# Members may be named log; std::log may not be called.
set(rounded_differently a?sinh? a?cosh? a?tanh? atan2 exp exp2 expm1 log2 log10 log1p pow cbrt hypot erfc? [lt]gamma)
list(JOIN rounded_differently "|" rounded_differently)
set(rounded_differently
    "std::(log|${rounded_differently})[fl]?[^A-Za-z0-9_]|[^A-Za-z0-9_.:>](${rounded_differently}|log[fl])[fl]?\\(")

# Prints the violation with the line number of `what` in `text`.
function(report file text what rule)
  string(FIND "${text}" "${what}" start)
  string(SUBSTRING "${text}" 0 ${start} before)
  string(REGEX MATCHALL "\n" lines "${before}")
  list(LENGTH lines line)
  math(EXPR line "${line} + 1")
  message(NOTICE "src/${file}:${line}: error: ${what}: ${rule}")
  set(failed TRUE PARENT_SCOPE)
endfunction()

file(GLOB_RECURSE files RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/*.h ${SOURCE_DIR}/*.cpp)
foreach(file IN LISTS files)
  string(REGEX MATCH "^[^/]+" room ${file})
  set(allowed ${rooms})
  if(room IN_LIST rooms)
    set(allowed ${looks_into_${room}})
  endif()
  list(JOIN allowed " " allowed_text)
  file(READ ${SOURCE_DIR}/${file} text)
  string(REPLACE ";" "," text "${text}")
  string(REGEX MATCHALL "#[ \t]*include[ \t]*[<\"][^>\"\n]*[>\"]" includes "${text}")
  foreach(include IN LISTS includes)
    string(REGEX MATCH "([<\"])([^/>\"]*)/?" _ "${include}")
    set(kind "${CMAKE_MATCH_1}")
    set(looked_into "${CMAKE_MATCH_2}")
    if(looked_into IN_LIST rooms)
      if(NOT looked_into IN_LIST allowed)
        report(${file} "${text}" "${include}"
               "room ${room} may look into ${allowed_text}, not ${looked_into} (raio_room in CMakeLists.txt)")
      endif()
    elseif(kind STREQUAL "\"")
      report(${file} "${text}" "${include}" "write a header of the project as \"room/file.h\"")
    endif()
  endforeach()
  string(REGEX REPLACE "//[^\n]*" "" code "${text}")
  string(REPLACE "\n" "\n " code "${code}")  # so that the character before a name is in its line
  string(REGEX MATCHALL "${rounded_differently}" calls "${code}")
  foreach(call IN LISTS calls)
    string(REGEX MATCH "(std::)?[a-z0-9]+" name "${call}")
    report(${file} "${code}" "${call}"
           "C libraries round ${name} differently, pictures have the same bytes everywhere; see base/exact_math.h")
  endforeach()
endforeach()
if(failed)
  message(FATAL_ERROR "src/ breaks the rules of its rooms.")
endif()
