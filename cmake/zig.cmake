# Compiles with zig, a clang that brings the C and C++ libraries of its targets. tools/wheels writes the
# programs in $RAIO_ZIG/bin, which know their target, and builds the static libraries in $RAIO_ZIG.
set(RAIO_ZIG $ENV{RAIO_ZIG})
set(CMAKE_SYSTEM_NAME $ENV{RAIO_ZIG_SYSTEM})
set(CMAKE_SYSTEM_PROCESSOR $ENV{RAIO_ZIG_PROCESSOR})
set(CMAKE_C_COMPILER ${RAIO_ZIG}/bin/cc)
set(CMAKE_CXX_COMPILER ${RAIO_ZIG}/bin/c++)
set(CMAKE_AR ${RAIO_ZIG}/bin/ar)
set(CMAKE_RANLIB ${RAIO_ZIG}/bin/ranlib)
set(CMAKE_RC_COMPILER ${RAIO_ZIG}/bin/rc)  # for Windows
set(CMAKE_INSTALL_NAME_TOOL false)  # for macOS: CMake demands it, and nothing calls it

set(CMAKE_FIND_ROOT_PATH ${RAIO_ZIG})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_LIBDIR} ${RAIO_ZIG}/lib/pkgconfig)

# zig asks for a function that C++17 removed, whose name std::unexpected now has.
set(CMAKE_CXX_FLAGS_INIT -U_LIBCPP_ENABLE_CXX17_REMOVED_UNEXPECTED_FUNCTIONS)
