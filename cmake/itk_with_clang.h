// Debian's ITK asks which compiler reads it and knows GCC alone. To be included before everything else (-include) by
// Clang and clang-tidy, which then pass for GCC 12 as long as ITK asks.
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
