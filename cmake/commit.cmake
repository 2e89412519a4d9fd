# Writes OUTPUT, a source file with the commit of the work tree SOURCE_DIR. Runs at each build; an
# unchanged file is not rewritten, so nothing is compiled again.
set(hash "")
set(date "")
set(modified false)
find_program(git git)
if(git)
  # Not the commit of a repository that merely contains Raio's source.
  execute_process(COMMAND ${git} -C ${SOURCE_DIR} rev-parse --show-toplevel
                  OUTPUT_VARIABLE root OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  file(REAL_PATH "${SOURCE_DIR}" source)
  if(root AND root STREQUAL source)
    execute_process(COMMAND ${git} -C ${SOURCE_DIR} -c log.showSignature=false log -1 --abbrev=7 --format=%h,%cs
                    OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(commit MATCHES "^([0-9a-f]+),([0-9-]+)$")
      set(hash ${CMAKE_MATCH_1})
      set(date ${CMAKE_MATCH_2})
      execute_process(COMMAND ${git} --no-optional-locks -C ${SOURCE_DIR} status --porcelain --untracked-files=no
                      OUTPUT_VARIABLE changes ERROR_QUIET)
      if(changes)
        set(modified true)
      endif()
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
// Made by cmake/commit.cmake.
#include "app/version.h"

raio::core::app::Commit raio::core::app::commit() { return {"@hash@", "@date@", @modified@}; }
]])
