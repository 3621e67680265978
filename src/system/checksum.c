// A 64-bit checksum of bytes that come in pieces of any size. It is to find what a broken disk, a
// copy that ended early or an editor did to a file, at the speed of memory; it is no protection
// against intent. Four independent lanes each take every fourth word of eight bytes by
// multiplication with an odd number, which loses nothing: a single changed word always shows.

#include <stdint.h>
#include <string.h>

enum { lanes = 4, stripe = 8 * lanes };

// Has its counterpart in checksum.f90.
struct checksum {
    uint64_t lane[lanes];
    int64_t length;
    char tail[stripe]; // the last length % stripe bytes
};

void spintop_add_to_checksum(struct checksum *self, const char *bytes, long long count);
int64_t spintop_checksum_value(const struct checksum *self);

static uint64_t mix(uint64_t lane, uint64_t word) {
    lane = (lane ^ word) * UINT64_C(0x9E3779B97F4A7C15); // 2^64 over the golden ratio
    return lane ^ lane >> 32;
}

static void add_stripe(uint64_t lane[lanes], const char *bytes) {
    uint64_t word[lanes];
    memcpy(word, bytes, stripe);
    for (int i = 0; i < lanes; ++i) lane[i] = mix(lane[i], word[i]);
}

void spintop_add_to_checksum(struct checksum *self, const char *bytes, long long count) {
    const size_t held = (size_t)(self->length % stripe);
    self->length += count;
    if (held > 0) {
        const size_t room = stripe - held;
        const size_t part = (size_t)count < room ? (size_t)count : room;
        memcpy(self->tail + held, bytes, part);
        if (part < room) return;
        add_stripe(self->lane, self->tail);
        bytes += part;
        count -= (long long)part;
    }
    for (; count >= stripe; count -= stripe, bytes += stripe) add_stripe(self->lane, bytes);
    memcpy(self->tail, bytes, (size_t)count);
}

int64_t spintop_checksum_value(const struct checksum *self) {
    const size_t held = (size_t)(self->length % stripe);
    uint64_t lane[lanes], value = (uint64_t)self->length;
    char last[stripe] = {0};
    memcpy(lane, self->lane, sizeof lane);
    memcpy(last, self->tail, held);
    add_stripe(lane, last);
    for (int i = 0; i < lanes; ++i) value = mix(value, lane[i]);
    return (int64_t)value;
}
