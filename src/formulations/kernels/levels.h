// Builds of a file of kernels for the levels of the processor (processor.c). The file defines LEVELS_OF as its own name and
// includes this one, which includes the file again for each level. There LEVEL(name) is the name of the build for the
// level, and `LEVEL(width)` the number of doubles in a vector of the processor.
//
// BUILDS(name) are the builds of a function by level, HAS_BUILD(builds, level) tells whether there is one.

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)

#pragma GCC push_options
#pragma GCC target("arch=x86-64-v4")
#define LEVEL(name) name##_v4
enum { width_v4 = 8 };
#include LEVELS_OF
#undef LEVEL
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("arch=x86-64-v3")
#define LEVEL(name) name##_v3
enum { width_v3 = 4 };
#include LEVELS_OF
#undef LEVEL
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("arch=x86-64-v2")
#define LEVEL(name) name##_v2
enum { width_v2 = 2 };
#include LEVELS_OF
#undef LEVEL
#pragma GCC pop_options
#define BUILDS(name) {0, 0, name##_v2, name##_v3, name##_v4}

#else

#define LEVEL(name) name##_as_built
#if defined(__AVX512F__)
enum { width_as_built = 8 };
#elif defined(__AVX__)
enum { width_as_built = 4 };
#else
enum { width_as_built = 2 };
#endif
#include LEVELS_OF
#undef LEVEL
#define BUILDS(name) {name##_as_built}

#endif

#define HAS_BUILD(builds, level) \
    ((level) >= 0 && (level) < (int)(sizeof(builds) / sizeof *(builds)) && (builds)[level])
