# Language, warnings, sanitizers, compiler cache and shared libraries.

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
set(SPLATLAS_MODULE_DIR ${CMAKE_INSTALL_LIBDIR}/splatlas)  # of what programs load at run time
set(CMAKE_INSTALL_RPATH "$ORIGIN/../${SPLATLAS_MODULE_DIR}")

# With relative paths and precompiled headers, all presets and clones share equal objects.
find_program(SPLATLAS_CCACHE ccache)
if(SPLATLAS_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}
    CCACHE_SLOPPINESS=pch_defines,time_macros ${SPLATLAS_CCACHE})
endif()

set(CMAKE_UNITY_BUILD ${SPLATLAS_UNITY})

# Flags of this project's own code, never of exported interfaces.
add_library(splatlas_flags INTERFACE)
target_compile_options(splatlas_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Wold-style-cast
  # In unity batches: a local name of another source; false alarms of GCC 12 (its bugs 105651 and 105329).
  $<$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>:-Wno-shadow>
  $<$<AND:$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>,$<CXX_COMPILER_ID:GNU>>:-Wno-array-bounds;-Wno-restrict;-Wno-stringop-overflow;-Wno-stringop-overread>
  $<$<BOOL:${SPLATLAS_WERROR}>:-Werror>)
if(SPLATLAS_SANITIZE)
  add_compile_definitions(SPLATLAS_SANITIZED)
  add_compile_options(-fsanitize=${SPLATLAS_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${SPLATLAS_SANITIZE})
endif()

# Instruction sets of kernels, by the names of player/render/simd/simd_choice.h.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64)$")
  # NEON with AES. Kernels for SVE do not compile with Debian 12's Highway. Fused operations would change bits.
  add_compile_options(-march=armv8-a+crypto -ffp-contract=off)
  set(disabled HWY_SVE HWY_SVE2 HWY_SVE_256 HWY_SVE2_128)
else()
  set(SPLATLAS_SIMD sse4 avx2 avx3 CACHE STRING "Instruction sets of the kernels: sse4, avx2, avx3 (AVX-512)")
  set(disabled HWY_SSSE3)
  foreach(name sse4 avx2 avx3)
    if(NOT name IN_LIST SPLATLAS_SIMD)
      string(TOUPPER HWY_${name} target)
      list(APPEND disabled ${target})
    endif()
  endforeach()
  # No kernel needs AES, which i3 laptops before 2013 lack.
  add_compile_definitions(HWY_DISABLE_PCLMUL_AES)
endif()
list(JOIN disabled "|" disabled)
# Without Highway's emulated vectors: the scalar reference takes their place.
add_compile_definitions("HWY_DISABLED_TARGETS=(${disabled})" HWY_BROKEN_EMU128=1)

# splatlas_alone(SOURCE...): sources outside unity batches, because their local names clash with another source's, or
# because they are measured.
function(splatlas_alone)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# splatlas_precompile(TARGET): the headers that most sources include, compiled once. Sources with options of their own
# take the headers as they are.
function(splatlas_precompile target)
  get_target_property(sources ${target} SOURCES)
  foreach(source ${sources})
    get_source_file_property(options ${source} COMPILE_OPTIONS)
    if(options)
      set_source_files_properties(${source} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
    endif()
  endforeach()
  target_precompile_headers(${target} PRIVATE <algorithm> <array> <cstdint> <filesystem> <functional> <memory> <optional>
    <span> <string> <string_view> <unordered_map> <vector> <fmt/format.h> <tl/expected.hpp>)
endfunction()

# splatlas_find(PACKAGE): finds a package that an exported library is linked with. The installed CMake package finds it
# too.
macro(splatlas_find package)
  find_package(${package} REQUIRED)
  set_property(GLOBAL APPEND PROPERTY SPLATLAS_DEPENDENCIES ${package})
endmacro()

splatlas_find(Threads)
splatlas_find(fmt)
splatlas_find(hwy)
splatlas_find(meshoptimizer)
splatlas_find(tl-expected)
splatlas_find(zstd)
# Headers of the implementation only.
find_package(FlatBuffers CONFIG REQUIRED)
find_package(utf8cpp REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(xxhash REQUIRED IMPORTED_TARGET libxxhash)

# splatlas_library(NAME SOURCES... [HEADERS PUBLIC_HEADERS...]): static library splatlas_NAME, exported as
# splatlas::NAME. Only public headers are installed.
function(splatlas_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "HEADERS")
  add_library(splatlas_${name} STATIC ${arg_UNPARSED_ARGUMENTS})
  add_library(splatlas::${name} ALIAS splatlas_${name})
  set_target_properties(splatlas_${name} PROPERTIES EXPORT_NAME ${name})
  target_sources(splatlas_${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${arg_HEADERS})
  target_link_libraries(splatlas_${name} PRIVATE $<BUILD_INTERFACE:splatlas_flags>)
  target_compile_features(splatlas_${name} PUBLIC cxx_std_20)
endfunction()
