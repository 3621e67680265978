// The CRC-32 of gzip, PNG and zlib, of bytes that come in pieces. Any other program can compute it as well: it is
// zlib.crc32 of Python. Where the processor multiplies without carry, 64 bytes are folded at a time: Gopal et al., Fast
// CRC Computation for Generic Polynomials Using PCLMULQDQ Instruction, Intel 2009.

#include <stddef.h>
#include <stdint.h>
#include <string.h>

// Has its counterpart in crc32.f90.
struct crc32 {
    int64_t lines; // that do not begin with #
    uint32_t state;
    int32_t in_line;
};

void spintop_add_to_crc32(struct crc32 *self, const char *bytes, long long count);
void spintop_add_reals_to_crc32(struct crc32 *self, const double *values, long long count);

enum { polynomial = (int)0xEDB88320u, tables = 8 };

static uint32_t table[tables][256];

// Before main, so that threads find it made.
__attribute__((constructor)) static void make_tables(void) {
    for (uint32_t i = 0; i < 256; ++i) {
        uint32_t word = i;
        for (int bit = 0; bit < 8; ++bit) word = word >> 1 ^ (word & 1 ? (uint32_t)polynomial : 0);
        table[0][i] = word;
    }
    for (int k = 1; k < tables; ++k) {
        for (int i = 0; i < 256; ++i) table[k][i] = table[k - 1][i] >> 8 ^ table[0][table[k - 1][i] & 255];
    }
}

static uint32_t by_tables(uint32_t state, const unsigned char *bytes, size_t count) {
    for (; count >= tables; count -= tables, bytes += tables) {
        uint32_t word = 0;
        for (int i = 0; i < 4; ++i) word |= (uint32_t)bytes[i] << 8 * i;
        word ^= state;
        state = 0;
        for (int i = 0; i < 4; ++i) state ^= table[7 - i][word >> 8 * i & 255] ^ table[3 - i][bytes[4 + i]];
    }
    for (; count > 0; --count, ++bytes) state = state >> 8 ^ table[0][(state ^ *bytes) & 255];
    return state;
}

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>

enum { lanes = 4, lane = 16, stripe = lanes * lane };

__attribute__((target("pclmul"))) static __m128i fold(__m128i sum, __m128i next, __m128i by) {
    return _mm_xor_si128(next, _mm_xor_si128(_mm_clmulepi64_si128(sum, by, 0x00), _mm_clmulepi64_si128(sum, by, 0x11)));
}

// All whole stripes. Their remainder stays that of 16 bytes.
__attribute__((target("pclmul"))) static uint32_t by_folding(uint32_t state, const unsigned char *bytes, size_t count) {
    const __m128i by_stripe = _mm_set_epi64x(0x1c6e41596, 0x154442bd4), by_lane = _mm_set_epi64x(0x0ccaa009e, 0x1751997d0);
    const __m128i *next = (const __m128i *)(const void *)bytes;
    unsigned char last[lane];
    __m128i sum[lanes];
    for (int i = 0; i < lanes; ++i) sum[i] = _mm_loadu_si128(next++);
    sum[0] = _mm_xor_si128(sum[0], _mm_cvtsi32_si128((int)state));
    for (; count >= 2 * stripe; count -= stripe) {
        for (int i = 0; i < lanes; ++i) sum[i] = fold(sum[i], _mm_loadu_si128(next++), by_stripe);
    }
    for (int i = 1; i < lanes; ++i) sum[0] = fold(sum[0], sum[i], by_lane);
    _mm_storeu_si128((__m128i *)(void *)last, sum[0]);
    return by_tables(0, last, sizeof last);
}

static int can_fold(size_t count) { return count >= stripe && __builtin_cpu_supports("pclmul"); }
#else
enum { stripe = 1 };
static uint32_t by_folding(uint32_t state, const unsigned char *bytes, size_t count) { return by_tables(state, bytes, count); }
static int can_fold(size_t count) { return count == 0; }
#endif

// Lines that begin in these bytes with anything but #. The loop over a part of fixed length becomes one over vectors.
static int64_t lines_in(const char *bytes, long long count, int in_line) {
    enum { part = 128 };
    int64_t lines = !in_line && bytes[0] != '#';
    long long i = 1;
    for (; count - i >= part; i += part) {
        unsigned char found = 0;
        for (int k = 0; k < part; ++k) found = (unsigned char)(found + ((bytes[i + k - 1] == '\n') & (bytes[i + k] != '#')));
        lines += found;
    }
    for (; i < count; ++i) lines += (bytes[i - 1] == '\n') & (bytes[i] != '#');
    return lines;
}

static void add(struct crc32 *self, const unsigned char *bytes, size_t count) {
    const size_t whole = can_fold(count) ? count / stripe * stripe : 0;
    self->state = ~self->state;
    if (whole > 0) self->state = by_folding(self->state, bytes, whole);
    self->state = ~by_tables(self->state, bytes + whole, count - whole);
}

void spintop_add_reals_to_crc32(struct crc32 *self, const double *values, long long count) {
    add(self, (const unsigned char *)values, (size_t)count * sizeof *values);
}

void spintop_add_to_crc32(struct crc32 *self, const char *bytes, long long count) {
    if (count == 0) return;
    add(self, (const unsigned char *)bytes, (size_t)count);
    self->lines += lines_in(bytes, count, self->in_line);
    self->in_line = bytes[count - 1] != '\n';
}
