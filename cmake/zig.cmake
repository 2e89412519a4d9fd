# Cross-compiles with zig, a clang that brings the C and C++ libraries of its targets. tools/wheels writes the
# programs in $RAIO_ZIG/bin, which know their target, and builds the static libraries in $RAIO_ZIG.
set(RAIO_ZIG $ENV{RAIO_ZIG})
set(CMAKE_SYSTEM_NAME $ENV{RAIO_ZIG_SYSTEM})
set(CMAKE_SYSTEM_PROCESSOR $ENV{RAIO_ZIG_PROCESSOR})
foreach(program C_COMPILER=cc CXX_COMPILER=c++ AR=ar RANLIB=ranlib RC_COMPILER=rc)
  string(REPLACE "=" ";" program ${program})
  list(GET program 0 variable)
  list(GET program 1 name)
  set(CMAKE_${variable} ${RAIO_ZIG}/bin/${name})
endforeach()

set(CMAKE_FIND_ROOT_PATH ${RAIO_ZIG})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_LIBDIR} ${RAIO_ZIG}/lib/pkgconfig)

# zig asks for a function that C++17 removed, whose name std::unexpected now has.
set(CMAKE_CXX_FLAGS_INIT -U_LIBCPP_ENABLE_CXX17_REMOVED_UNEXPECTED_FUNCTIONS)
