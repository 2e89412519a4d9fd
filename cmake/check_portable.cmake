# Fails if an object of a portable build calls POSIX or thread functions instead of standard C++:
#   cmake -D NM=nm -D "LIBRARIES=a.a;b.a" -P check_portable.cmake
# The standard library's own dependencies do not count: they are not in these libraries.
cmake_minimum_required(VERSION 3.25)

set(calls
  access chdir clock_gettime close dlclose dlerror dlopen dlsym dup dup2 execv execve faccessat fchmod fcntl fcntl64
  fileno fork fstat fstat64 fsync ftruncate getpid getrlimit getrlimit64 getrusage ioctl isatty kill link lseek
  lseek64 lstat lstat64 madvise mkstemp mmap mmap64 mprotect munmap nanosleep open open64 openat pause pipe pipe2
  poll posix_memalign posix_spawn pread pread64 pthread_create pthread_join pthread_kill pthread_sigmask read
  readlink select setrlimit setrlimit64 sigaction sigprocmask sigtimedwait socket stat stat64 syscall sysconf umask
  unlink usleep vfork waitpid write _exit)
list(JOIN calls "|" calls)

foreach(library IN LISTS LIBRARIES)
  execute_process(COMMAND ${NM} --undefined-only --print-file-name ${library}
                  OUTPUT_VARIABLE text RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${NM} cannot read ${library}")
  endif()
  string(REGEX MATCHALL "[^\n]* U (${calls})(@[^\n]*)?(\n|$)" found "${text}")
  foreach(line IN LISTS found)
    string(STRIP "${line}" line)
    message(NOTICE "error: ${line}: not in standard C++")
    set(failed TRUE)
  endforeach()
endforeach()
if(failed)
  message(FATAL_ERROR "The portable build calls functions that other systems do not have; move the calls to src/base/platform.")
endif()
