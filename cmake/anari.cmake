# The device of ANARI, which other programs load by the name `raio`, if its SDK is installed; -Danari_DIR names it
# elsewhere.
find_package(anari 0.17 CONFIG QUIET)
if(NOT anari_FOUND)
  message(STATUS "The ANARI device is left out: its SDK is not installed")
  return()
endif()
make_library(raio_static STATIC)
add_library(raio_anari SHARED src/device/anari.cpp)
set_target_properties(raio_anari PROPERTIES OUTPUT_NAME anari_library_raio
                      LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/anari)
target_link_libraries(raio_anari PRIVATE raio_device raio_static anari::anari_backend)
if(UNIX AND NOT APPLE)  # everything but its entry is its own
  target_link_options(raio_anari PRIVATE LINKER:--exclude-libs,ALL)
endif()
if(RAIO_INSTALL)
  install(TARGETS raio_anari LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
endif()
