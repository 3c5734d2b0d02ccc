# Debian packages by cpack, of a build for /usr (scripts/build_packages.sh): one per component, with what desktops and
# shells look for.

set(files ${PROJECT_SOURCE_DIR}/cmake/package)
install(FILES ${files}/splatlas-player.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications)
install(FILES ${files}/splatlas.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/mime/packages)
install(FILES ${files}/splatlas.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps)
install(FILES ${files}/splatlas.thumbnailer DESTINATION ${CMAKE_INSTALL_DATADIR}/thumbnailers)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_PACKAGE_SOURCE splatlas)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_PACKAGE_CONTACT "Splatlas contributors <splatlas@localhost>")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL player preprocess dev python)
# package(COMPONENT NAME SECTION TEXT DEPENDS)
function(package component name section text depends)
  string(TOUPPER ${component} key)
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_DEPENDS "${depends}" PARENT_SCOPE)
  set(CPACK_COMPONENT_${key}_DESCRIPTION "Splatlas draws any selection of structures of an anatomy atlas without a\nGPU. ${text}" PARENT_SCOPE)
  set(doc ${CMAKE_INSTALL_DATADIR}/doc/${name})
  install(FILES LICENSE RENAME copyright DESTINATION ${doc} COMPONENT ${component})
  install(FILES ${PROJECT_BINARY_DIR}/package/changelog.gz RENAME changelog.Debian.gz DESTINATION ${doc}
    COMPONENT ${component} OPTIONAL)
  if(name MATCHES "^splatlas-")
    install(FILES ${PROJECT_BINARY_DIR}/package/${name}.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1
      COMPONENT ${component} OPTIONAL)
    install(FILES ${files}/completion.bash RENAME ${name} COMPONENT ${component}
      DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  endif()
endfunction()
package(player splatlas-player science "This is the player, in the browser and for pictures."
  "fonts-liberation, fonts-dejavu-core")
package(preprocess splatlas-preprocess science "This program makes atlases from medical volumes." "")
package(dev libsplatlas-dev libdevel "These are its libraries and headers."
  "splatlas-player, libexpected-dev, libfmt-dev, libhwy-dev, libmeshoptimizer-dev, libpng-dev, libzstd-dev, zlib1g-dev")
package(python python3-splatlas python "This is the package for Python."
  "python3 (>= 3.11), python3 (<< 3.12), python3-numpy, splatlas-player")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${files}/python/prerm)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "splatlas-preprocess, python3-nibabel")
include(CPack)
