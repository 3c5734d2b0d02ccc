# Installs the programs, the libraries format, player and pages with their public headers, the CMake package `splatlas`, and
# the pkg-config module of the same name.
# Other projects use find_package(splatlas), link splatlas::format, splatlas::player or splatlas::pages, and include
# <splatlas/player/renderer.h>. Headers include each other as "player/renderer.h", as in the source tree.

include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/splatlas)

foreach(program splatlas-preprocess splatlas-player)
  if(TARGET ${program})
    install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  endif()
endforeach()

foreach(module splatlas_pictures splatlas_text)  # loaded at run time
  if(TARGET ${module})
    install(TARGETS ${module} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  endif()
endforeach()

foreach(library splatlas_format splatlas_player splatlas_pages)
  if(TARGET ${library})
    install(TARGETS ${library} EXPORT splatlasTargets
      ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
      INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
      FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/splatlas)
  endif()
endforeach()
install(EXPORT splatlasTargets NAMESPACE splatlas:: DESTINATION ${package_dir})

get_property(dependencies GLOBAL PROPERTY SPLATLAS_DEPENDENCIES)
list(REMOVE_DUPLICATES dependencies)
list(TRANSFORM dependencies REPLACE "(.+)" "find_dependency(\\1)")
list(JOIN dependencies "\n" SPLATLAS_FIND_DEPENDENCIES)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/splatlasConfig.cmake.in
  ${PROJECT_BINARY_DIR}/splatlasConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/splatlasConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/splatlasConfig.cmake ${PROJECT_BINARY_DIR}/splatlasConfigVersion.cmake
  DESTINATION ${package_dir})

# From the folder of splatlas.pc to the prefix: `cmake --install --prefix` may change the prefix.
set(pkgconfig_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
cmake_path(RELATIVE_PATH CMAKE_INSTALL_PREFIX BASE_DIRECTORY ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig
  OUTPUT_VARIABLE SPLATLAS_PC_TO_PREFIX)
configure_file(${PROJECT_SOURCE_DIR}/cmake/splatlas.pc.in ${PROJECT_BINARY_DIR}/splatlas.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/splatlas.pc DESTINATION ${pkgconfig_dir})

if(SPLATLAS_BUILD_PREPROCESS)
  install(DIRECTORY preprocess/trees DESTINATION ${CMAKE_INSTALL_DATADIR}/splatlas)
endif()
install(FILES README.md CHANGELOG.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DOCDIR})
