# Language, warnings, sanitizers, compiler cache and the libraries that every part shares.

include(GNUInstallDirs)

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
set(CMAKE_INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")

find_program(SPLATLAS_CCACHE ccache)
if(SPLATLAS_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${SPLATLAS_CCACHE})
endif()

# Flags of our own code only: never of the interface that others link.
add_library(splatlas_flags INTERFACE)
target_compile_options(splatlas_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Wold-style-cast
  $<$<BOOL:${SPLATLAS_WERROR}>:-Werror>)
if(SPLATLAS_SANITIZE)
  add_compile_options(-fsanitize=${SPLATLAS_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${SPLATLAS_SANITIZE})
endif()

find_package(Threads REQUIRED)
find_package(tl-expected REQUIRED)
find_package(flatbuffers CONFIG QUIET)
if(NOT flatbuffers_FOUND)
  find_package(Flatbuffers CONFIG REQUIRED)
endif()
find_package(zstd REQUIRED)
find_package(meshoptimizer REQUIRED)
find_package(fmt REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(xxhash REQUIRED IMPORTED_TARGET libxxhash)

# splatlas_library(NAME SOURCES...): static library splatlas_NAME, exported as splatlas::NAME.
function(splatlas_library name)
  add_library(splatlas_${name} STATIC ${ARGN})
  add_library(splatlas::${name} ALIAS splatlas_${name})
  set_target_properties(splatlas_${name} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(splatlas_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/splatlas>)
  target_link_libraries(splatlas_${name} PRIVATE $<BUILD_INTERFACE:splatlas_flags>)
  target_compile_features(splatlas_${name} PUBLIC cxx_std_20)
endfunction()
