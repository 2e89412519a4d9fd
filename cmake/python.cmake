# The module of the Python package, and the program in its wheel. `pip install .` configures this
# (pyproject.toml).
find_package(Python 3.11 REQUIRED COMPONENTS Interpreter Development.Module
             OPTIONAL_COMPONENTS Development.SABIModule)
if(NOT nanobind_ROOT)
  execute_process(COMMAND ${Python_EXECUTABLE} -m nanobind --cmake_dir
                  OUTPUT_STRIP_TRAILING_WHITESPACE OUTPUT_VARIABLE nanobind_ROOT)
endif()
find_package(nanobind CONFIG REQUIRED)

if(NOT TARGET raio_static)
  make_library(raio_static STATIC)
endif()
if(APPLE AND CMAKE_CROSSCOMPILING)  # zig makes no bundles, and reads no list of Python's symbols
  function(nanobind_link_options target)
    target_link_options(${target} PRIVATE -shared LINKER:-undefined,dynamic_lookup)
  endfunction()
endif()
nanobind_add_module(raio_python STABLE_ABI NB_STATIC python/module.cpp)
# build/PRESET/python holds the whole package, for tests.
set(package ${PROJECT_BINARY_DIR}/python/raio)
set_target_properties(raio_python PROPERTIES OUTPUT_NAME _raio LIBRARY_OUTPUT_DIRECTORY ${package})
add_custom_target(raio_package ALL
  COMMAND ${CMAKE_COMMAND} -E copy_directory ${PROJECT_SOURCE_DIR}/python/raio ${package}
  COMMENT "Copying the Python package")
add_dependencies(raio_package raio_python)
target_link_libraries(raio_python PRIVATE raio_static)
# nanobind's headers use stderr without including its header.
foreach(target raio_python nanobind-static nanobind-static-abi3 nanobind-static-ft)
  if(TARGET ${target})
    target_compile_options(${target} PRIVATE -include stdio.h)
  endif()
endforeach()
if(UNIX AND NOT APPLE)  # everything but its entry is its own
  target_link_options(raio_python PRIVATE LINKER:--version-script,${PROJECT_SOURCE_DIR}/python/exported.map)
endif()

install(TARGETS raio_python LIBRARY DESTINATION raio COMPONENT python)
if(TARGET raio_anari)  # for raio.ovito
  add_custom_command(TARGET raio_package POST_BUILD
    COMMAND ${CMAKE_COMMAND} -E copy $<TARGET_FILE:raio_anari> ${package})
  add_dependencies(raio_package raio_anari)
  install(TARGETS raio_anari LIBRARY DESTINATION raio COMPONENT python)
endif()
if(SKBUILD_SCRIPTS_DIR)
  install(TARGETS raio RUNTIME DESTINATION ${SKBUILD_SCRIPTS_DIR} COMPONENT python)
endif()
