# WebAssembly by Debian's clang-14 and lld-14, with the C and C++ libraries of the package emscripten. Its driver em++
# is not used: it costs Python for each source, and half a minute to link.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR wasm32)
set(SPLATLAS_WASM ON)
set(CMAKE_SYSROOT /usr/share/emscripten/cache/sysroot)

set(CMAKE_C_COMPILER clang-14)
set(CMAKE_CXX_COMPILER clang++-14)
set(CMAKE_C_COMPILER_TARGET wasm32-unknown-emscripten)
set(CMAKE_CXX_COMPILER_TARGET wasm32-unknown-emscripten)
set(CMAKE_AR /usr/bin/llvm-ar-14)
set(CMAKE_RANLIB /usr/bin/llvm-ranlib-14)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)  # programs are linked with options of their own

set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)

# Exceptions are WebAssembly's own: the other kind calls through JavaScript. Without threads, statics need no guards.
set(wasm_flags "-D__EMSCRIPTEN__ -Xclang -iwithsysroot/include/compat -msimd128 -ffunction-sections")
set(CMAKE_C_FLAGS_INIT "${wasm_flags}")
set(CMAKE_CXX_FLAGS_INIT "${wasm_flags} -fwasm-exceptions -fno-threadsafe-statics -D_LIBCPP_ABI_VERSION=2")
