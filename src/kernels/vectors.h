// Vectors of the processor for all kernels, and of four numbers; see kernels_of_level.h.

// Numbers in a vector of the processor.
#if defined(__AVX512F__)
enum { width = 8 };
#elif defined(__AVX__)
enum { width = 4 };
#else
enum { width = 2 };
#endif

typedef double vector __attribute__((vector_size(8 * width)));
typedef long long bits __attribute__((vector_size(8 * width)));
typedef double half_vector __attribute__((vector_size(8 * half)));

#define inlined static inline __attribute__((always_inline))
#define shuffle __builtin_shufflevector
#define component(v, i) shuffle(v, v, i, i, i, i)

// A loop of few turns, which becomes none, and those of many, of which two or four become one.
#if defined(__clang__)
#define unrolled_for _Pragma("clang loop unroll_count(2)") for
#define far_unrolled_for _Pragma("clang loop unroll_count(4)") for
#define for_all(i, n) _Pragma("clang loop unroll(full)") for (int i = 0; i < (n); ++i)
#else
#define unrolled_for _Pragma("GCC unroll 2") for
#define far_unrolled_for _Pragma("GCC unroll 4") for
#define for_all(i, n) _Pragma("GCC unroll 8") for (int i = 0; i < (n); ++i)
#endif

// A row of numbers lies in one vector, or in more where the processor has no room for it in one.
enum { parts = numbers / width };

inlined vector load(const double *from) {
    vector value;
    memcpy(&value, from, sizeof value);
    return value;
}
inlined void store(double *to, vector value) { memcpy(to, &value, sizeof value); }

// A row of lanes, which may lie anywhere.
inlined vector get(const double *rows_of_lanes, int row) { return load(rows_of_lanes + lanes * row); }
inlined void put(double *rows_of_lanes, int row, vector value) { memcpy(rows_of_lanes + lanes * row, &value, sizeof value); }

inlined void get_parts(vector *v, const double *from) {
    for_all(p, parts) v[p] = load(from + width * p);
}

inlined half_vector get_half(const double *from) {
    half_vector value;
    memcpy(&value, from, sizeof value);
    return value;
}

inlined void put_half(double *to, const half_vector *value) { memcpy(to, value, sizeof *value); }

// The share of a term of a series in the one before: 1/(k + 1), or 1/((k + 1) (k + 2)) of a second derivative. A factor that is
// rounded in the same way in every step makes energy and momentum drift, so it is the sum of two numbers in the first terms: of
// one in single precision and a remainder. A remainder of a double would be smaller than the rounding error of the product, and
// therefore lost where products and sums are not fused.
enum { exact_shares = 8 };

struct share {
    double first, rest;
    int is_sum;
};

#define sum_for(n) {1 / (float)n, (1 - n * (double)(1 / (float)n)) / n}
static const double exact_share[exact_shares][2] = {sum_for(1), sum_for(2), sum_for(3), sum_for(4),
                                                    sum_for(5), sum_for(6), sum_for(7), sum_for(8)};
inlined struct share share_of_term(int is_sum, int k) {
    return is_sum ? (struct share){exact_share[k][0], exact_share[k][1], 1} : (struct share){1.0 / (k + 1), 0, 0};
}

// Share k of a table of first numbers and one of rests.
inlined struct share share_of(const double *share, const double *share_rest, int k) {
    return k < exact_shares ? (struct share){share[k], share_rest[k], 1} : (struct share){share[k] + share_rest[k], 0, 0};
}

inlined vector scaled(vector rate, struct share s) {
    const vector value = s.first * rate;
    return s.is_sum ? value + s.rest * rate : value;
}

// The vector product.
inlined half_vector cross(const half_vector *first, const half_vector *last) {
    const half_vector a = *first, b = *last, c = a * shuffle(b, b, 1, 2, 0, 3) - shuffle(a, a, 1, 2, 0, 3) * b;
    return shuffle(c, c, 1, 2, 0, 3);
}

// One value where a condition holds, another elsewhere.
inlined vector where(bits holds, vector value, vector other) {
    return (vector)(((bits)value & holds) | ((bits)other & ~holds));
}

inlined vector magnitude(vector x) { return (vector)((bits)x & 0x7fffffffffffffffLL); }
