# Installs the programs, the libraries format, player and pages with their public headers, the CMake package `splatlas`, and
# the pkg-config module of the same name.
# Other projects use find_package(splatlas), link splatlas::format, splatlas::player or splatlas::pages, and include
# <splatlas/player/renderer.h>. Headers include each other as "player/renderer.h", as in the source tree.

include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/splatlas)

# With the modules that are loaded at run time.
install(TARGETS splatlas-player splatlas_pictures splatlas_text COMPONENT player
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} LIBRARY DESTINATION ${SPLATLAS_MODULE_DIR})
if(SPLATLAS_BUILD_PREPROCESS)
  install(TARGETS splatlas-preprocess RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT preprocess)
  install(DIRECTORY preprocess/trees DESTINATION ${CMAKE_INSTALL_DATADIR}/splatlas COMPONENT preprocess)
endif()

set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME dev)
install(TARGETS splatlas_format splatlas_player splatlas_pages EXPORT splatlasTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/splatlas)
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

install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME player)
install(FILES README.md CHANGELOG.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR})
include(SplatlasPackages)
