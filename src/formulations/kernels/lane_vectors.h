// Vectors of lanes, for the files of kernels that include this one for each level of the processor.

#define width LEVEL(width)
#define vector LEVEL(vector)
#define bits LEVEL(bits)
#define get LEVEL(get)
#define put LEVEL(put)
#define scaled LEVEL(scaled)

// As many lanes at once as the processor has room for in a vector.
typedef double vector __attribute__((vector_size(8 * width)));
typedef long long bits __attribute__((vector_size(8 * width)));

#define inlined static inline __attribute__((always_inline))

// A loop of few turns, which becomes none, and one of many, of which two become one.
#if defined(__clang__)
#define unrolled _Pragma("clang loop unroll_count(2)")
#define for_all(i, n) _Pragma("clang loop unroll(full)") for (int i = 0; i < (n); ++i)
#else
#define unrolled _Pragma("GCC unroll 2")
#define for_all(i, n) _Pragma("GCC unroll 8") for (int i = 0; i < (n); ++i)
#endif

// A row, which may lie anywhere.
inlined vector get(const double *rows_of_lanes, int row) {
    vector value;
    memcpy(&value, rows_of_lanes + lanes * row, sizeof value);
    return value;
}

inlined void put(double *rows_of_lanes, int row, vector value) {
    memcpy(rows_of_lanes + lanes * row, &value, sizeof value);
}

inlined vector scaled(vector rate, struct share s) {
    const vector value = s.first * rate;
    return s.is_sum ? value + s.rest * rate : value;
}
