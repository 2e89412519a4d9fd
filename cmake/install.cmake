# The files that `cmake --install` installs and `cpack` packs.
# The manual page and the completions, written by the program itself.
if(NOT CMAKE_CROSSCOMPILING)
  set(manuals ${PROJECT_BINARY_DIR}/manuals)
  file(MAKE_DIRECTORY ${manuals})
  add_custom_command(
    OUTPUT ${manuals}/raio.1 ${manuals}/raio.bash ${manuals}/_raio ${manuals}/raio.fish
    COMMAND raio manual --man > ${manuals}/raio.1
    COMMAND raio completion bash > ${manuals}/raio.bash
    COMMAND raio completion zsh > ${manuals}/_raio
    COMMAND raio completion fish > ${manuals}/raio.fish
    DEPENDS raio COMMENT "Writing the manual page and the completions" VERBATIM)
  add_custom_target(raio_manuals ALL DEPENDS ${manuals}/raio.1)
endif()

install(TARGETS raio RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
if(RAIO_WINDOW)
  install(TARGETS raio_view_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
install(DIRECTORY scenes/ DESTINATION ${CMAKE_INSTALL_DATADIR}/raio/scenes)
if(RAIO_WINDOW)  # shows the lessons
  install(DIRECTORY docs/course DESTINATION ${CMAKE_INSTALL_DATADIR}/raio/docs FILES_MATCHING PATTERN "*.md")
  install(DIRECTORY docs/pictures/course DESTINATION ${CMAKE_INSTALL_DATADIR}/raio/docs/pictures)
endif()
install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
if(NOT CMAKE_CROSSCOMPILING)
  install(FILES ${manuals}/raio.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  install(FILES ${manuals}/raio.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME raio)
  install(FILES ${manuals}/_raio DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
  install(FILES ${manuals}/raio.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
endif()

if(RAIO_LIBRARY)
  install(TARGETS raio_library EXPORT raio LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(FILES include/raio/raio.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/raio)
  set(package ${CMAKE_INSTALL_LIBDIR}/cmake/raio)
  install(EXPORT raio NAMESPACE raio:: FILE raioTargets.cmake DESTINATION ${package})
  include(CMakePackageConfigHelpers)
  configure_package_config_file(cmake/raioConfig.cmake.in raioConfig.cmake INSTALL_DESTINATION ${package})
  write_basic_package_version_file(raioConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/raioConfig.cmake ${PROJECT_BINARY_DIR}/raioConfigVersion.cmake
          DESTINATION ${package})
  configure_file(cmake/raio.pc.in raio.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/raio.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endif()

if(PROJECT_IS_TOP_LEVEL)
  # `cpack` in the folder of a build makes a Debian package.
  set(CPACK_GENERATOR DEB)
  set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
  if(NOT CPACK_PACKAGE_CONTACT)  # distributors set their own
    set(CPACK_PACKAGE_CONTACT "The authors of Raio")
  endif()
  set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
  set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
  set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libcairo2, libembree3-3, librsvg2-2, fonts-dejavu-core")
  set(CPACK_STRIP_FILES ON)
  include(CPack)
endif()
