# Embeds the page for browsers in splatlas-player, and the WebAssembly module if it is built (preset web, docs/web.md).
set(default_module ${PROJECT_SOURCE_DIR}/build/web/splatlas.wasm)
if(NOT EXISTS ${default_module})
  set(default_module "")
endif()
set(SPLATLAS_WEB_MODULE "${default_module}" CACHE FILEPATH "splatlas.wasm that the player embeds; empty: none")
if(NOT SPLATLAS_WEB_MODULE AND default_module)  # built since the first configuration
  set(SPLATLAS_WEB_MODULE ${default_module} CACHE FILEPATH "" FORCE)
endif()

set(embedding ${CMAKE_CURRENT_LIST_DIR}/page_files.cpp)
file(GLOB page_files CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/page/*)
set(embedded ${page_files} ${CMAKE_CURRENT_LIST_DIR}/splatlas.js)
set_property(SOURCE ${embedding} APPEND PROPERTY COMPILE_DEFINITIONS SPLATLAS_WEB_FOLDER="${CMAKE_CURRENT_LIST_DIR}")
if(SPLATLAS_WEB_MODULE)
  set(module_gzip ${CMAKE_CURRENT_BINARY_DIR}/splatlas.wasm.gz)
  add_custom_command(OUTPUT ${module_gzip}
    COMMAND gzip -9 --no-name --stdout ${SPLATLAS_WEB_MODULE} > ${module_gzip}
    DEPENDS ${SPLATLAS_WEB_MODULE}
    COMMENT "Compressing splatlas.wasm"
    VERBATIM)
  list(APPEND embedded ${module_gzip})
  set_property(SOURCE ${embedding} APPEND PROPERTY COMPILE_DEFINITIONS SPLATLAS_WEB_MODULE_GZIP="${module_gzip}")
else()
  message(STATUS "No splatlas.wasm: `splatlas-player export --html` will not work (docs/web.md)")
endif()
set_source_files_properties(${embedding} PROPERTIES OBJECT_DEPENDS "${embedded}" SKIP_UNITY_BUILD_INCLUSION ON)
