# Set-up of the WebAssembly module, in place of SplatlasSetup: the same names of targets and functions for libraries that
# are compiled from source here, or consist of headers.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
find_program(SPLATLAS_CCACHE ccache)
if(SPLATLAS_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${SPLATLAS_CCACHE})
  set(CMAKE_C_COMPILER_LAUNCHER ${SPLATLAS_CCACHE})
endif()

# Sources of libraries, once.
set(third_party ${PROJECT_BINARY_DIR}/third_party)
if(NOT EXISTS ${third_party}/meshoptimizer/src)
  execute_process(COMMAND ${PROJECT_SOURCE_DIR}/scripts/fetch_web_sources.sh ${third_party} COMMAND_ERROR_IS_FATAL ANY)
endif()
# Headers of libraries: links to those alone, because /usr/include has the system's.
set(headers ${PROJECT_BINARY_DIR}/headers)
file(MAKE_DIRECTORY ${headers})
foreach(name flatbuffers fmt hwy meshoptimizer.h nlohmann tl utf8cpp xxhash.h zstd.h zstd_errors.h)
  file(CREATE_LINK /usr/include/${name} ${headers}/${name} SYMBOLIC)
endforeach()

# splatlas_sources(NAME TARGET SOURCES...): static library of a third party's sources, as the target of its package.
function(splatlas_sources name target)
  list(TRANSFORM ARGN PREPEND ${third_party}/)
  add_library(${name} STATIC ${ARGN})
  target_include_directories(${name} SYSTEM PUBLIC ${headers})
  target_compile_options(${name} PRIVATE -w)
  add_library(${target} ALIAS ${name})
endfunction()
splatlas_sources(hwy hwy::hwy highway/hwy/aligned_allocator.cc highway/hwy/per_target.cc highway/hwy/targets.cc)
target_compile_definitions(hwy PUBLIC HWY_COMPILE_ONLY_STATIC HWY_STATIC_DEFINE)
splatlas_sources(zstd zstd::libzstd_shared
  libzstd/lib/common/debug.c libzstd/lib/common/entropy_common.c libzstd/lib/common/error_private.c
  libzstd/lib/common/fse_decompress.c libzstd/lib/common/xxhash.c libzstd/lib/common/zstd_common.c
  libzstd/lib/decompress/huf_decompress.c libzstd/lib/decompress/zstd_ddict.c
  libzstd/lib/decompress/zstd_decompress.c libzstd/lib/decompress/zstd_decompress_block.c)
splatlas_sources(meshoptimizer meshoptimizer::meshoptimizer
  meshoptimizer/src/allocator.cpp meshoptimizer/src/indexcodec.cpp meshoptimizer/src/vertexcodec.cpp)
add_library(headers INTERFACE)
target_include_directories(headers SYSTEM INTERFACE ${headers})
target_compile_definitions(headers INTERFACE FMT_HEADER_ONLY)
foreach(target flatbuffers::flatbuffers_shared fmt::fmt nlohmann_json::nlohmann_json PkgConfig::xxhash PNG::PNG
        Threads::Threads tl::expected utf8cpp)
  add_library(${target} ALIAS headers)
endforeach()
macro(splatlas_find)
endmacro()

add_library(splatlas_flags INTERFACE)
target_compile_options(splatlas_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  -Wnon-virtual-dtor -Wold-style-cast -Wno-shorten-64-to-32 -Wno-c++11-narrowing -Wno-pragma-clang-attribute $<$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>:-Wno-shadow>
  -include ${PROJECT_SOURCE_DIR}/player/web/compat/missing_library.h)
target_include_directories(splatlas_flags SYSTEM INTERFACE ${PROJECT_SOURCE_DIR}/player/web/compat)

function(splatlas_precompile)
endfunction()
function(splatlas_alone)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# What a page has no use for: it writes no files and compares no kernels. web_system.cpp replaces the rest.
set(SPLATLAS_NOT_IN_MODULE
  file/atlas_writer.cpp file/reader/atlas_copy.cpp io/input_file.cpp io/memory_limit.cpp io/output_file.cpp
  render/rays/march/march_scalar.cpp render/sheets/splat/splat_scalar.cpp write_png.cpp)
function(splatlas_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "HEADERS")
  list(REMOVE_ITEM arg_UNPARSED_ARGUMENTS ${SPLATLAS_NOT_IN_MODULE})
  add_library(splatlas_${name} STATIC ${arg_UNPARSED_ARGUMENTS})
  add_library(splatlas::${name} ALIAS splatlas_${name})
  target_include_directories(splatlas_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(splatlas_${name} PRIVATE splatlas_flags)
  set_target_properties(splatlas_${name} PROPERTIES UNITY_BUILD ${SPLATLAS_UNITY})
endfunction()
