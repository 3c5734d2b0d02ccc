// Compiler detection of Debian's ITK, which knows GCC alone. Clang and clang-tidy include this file first (-include)
// and identify themselves as GCC 12 while ITK asks.
#pragma once

#if defined(__clang__) && __has_include(<itk_compiler_detection.h>)
#pragma push_macro("__clang__")
#pragma push_macro("__GNUC__")
#undef __clang__
#undef __GNUC__
#define __GNUC__ 12
#include <itk_compiler_detection.h>
#pragma pop_macro("__GNUC__")
#pragma pop_macro("__clang__")
#endif
