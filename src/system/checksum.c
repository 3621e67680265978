// The CRC-32 of gzip, PNG and zlib, of bytes that come in pieces, sixteen at a time by tables. Any other program can compute it
// as well: it is zlib.crc32 of Python.

#include <stddef.h>
#include <stdint.h>
#include <string.h>

// Has its counterpart in checksum.f90.
struct checksum {
    int64_t lines; // that do not begin with #
    uint32_t state;
    int32_t in_line;
};

void spintop_add_to_checksum(struct checksum *self, const char *bytes, long long count);
void spintop_add_reals_to_checksum(struct checksum *self, const double *values, long long count);

enum { polynomial = (int)0xEDB88320u, tables = 16 };

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
        uint32_t sum = 0;
        for (int i = 0; i < 4; ++i) sum ^= table[tables - 1 - i][bytes[i] ^ (state >> 8 * i & 255)];
#pragma GCC unroll 16
        for (int i = 4; i < tables; ++i) sum ^= table[tables - 1 - i][bytes[i]];
        state = sum;
    }
    for (; count > 0; --count, ++bytes) state = state >> 8 ^ table[0][(state ^ *bytes) & 255];
    return state;
}

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

static void add(struct checksum *self, const unsigned char *bytes, size_t count) {
    self->state = ~by_tables(~self->state, bytes, count);
}

void spintop_add_reals_to_checksum(struct checksum *self, const double *values, long long count) {
    add(self, (const unsigned char *)values, (size_t)count * sizeof *values);
}

void spintop_add_to_checksum(struct checksum *self, const char *bytes, long long count) {
    if (count == 0) return;
    add(self, (const unsigned char *)bytes, (size_t)count);
    self->lines += lines_in(bytes, count, self->in_line);
    self->in_line = bytes[count - 1] != '\n';
}
