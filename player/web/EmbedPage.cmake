# Embeds the page for browsers in splatlas-player, with the WebAssembly module where it is configured (docs/web.md).
set(SPLATLAS_WEB_MODULE AUTO CACHE STRING
  "splatlas.wasm that the player embeds; AUTO: that of the preset web if it is configured; OFF: none")
set(web_module ${SPLATLAS_WEB_MODULE})
if(web_module STREQUAL AUTO)
  set(web_folder ${PROJECT_SOURCE_DIR}/build/web)
  set(web_module "")
  if(EXISTS ${web_folder}/build.ninja)
    set(web_module ${web_folder}/splatlas.wasm)
    add_custom_target(splatlas-web-module COMMAND ${CMAKE_COMMAND} --build ${web_folder} --target splatlas-web
      BYPRODUCTS ${web_module} COMMENT "Building splatlas.wasm" VERBATIM)
  endif()
elseif(NOT web_module)
  set(web_module "")
elseif(NOT EXISTS ${web_module})
  message(FATAL_ERROR "SPLATLAS_WEB_MODULE: ${web_module}: no such file; build it (cmake --preset web), or give OFF")
endif()
set_property(GLOBAL PROPERTY SPLATLAS_EMBEDDED_MODULE "${web_module}")  # for tests

set(embedding ${CMAKE_CURRENT_LIST_DIR}/html_page.cpp)
file(GLOB embedded CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/page/*)
list(APPEND embedded ${CMAKE_CURRENT_LIST_DIR}/splatlas.js)
set(definitions SPLATLAS_WEB_FOLDER="${CMAKE_CURRENT_LIST_DIR}")
if(web_module)
  set(module_gzip ${CMAKE_CURRENT_BINARY_DIR}/splatlas.wasm.gz)
  add_custom_command(OUTPUT ${module_gzip}
    COMMAND gzip -9 --no-name --stdout ${web_module} > ${module_gzip}
    DEPENDS ${web_module}
    COMMENT "Compressing splatlas.wasm"
    VERBATIM)
  list(APPEND embedded ${module_gzip})
  list(APPEND definitions SPLATLAS_WEB_MODULE_GZIP="${module_gzip}")
else()
  message(STATUS "No splatlas.wasm: splatlas-player export --html will explain how to get it (docs/web.md)")
endif()
set_source_files_properties(${embedding} PROPERTIES
  COMPILE_DEFINITIONS "${definitions}" OBJECT_DEPENDS "${embedded}" SKIP_UNITY_BUILD_INCLUSION ON)
