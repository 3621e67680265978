// The share of a term of a series in the one before: 1/(k + 1), or 1/((k + 1) (k + 2)) of a second derivative. A factor that is
// rounded in the same way in every step makes energy and momentum drift, so it is the sum of two numbers in the first terms.

enum { exact_shares = 8 };

struct share {
    double first, rest;
    int is_sum;
};

// Share k of a table of first numbers and one of rests.
inlined struct share share_of(const double *share, const double *share_rest, int k) {
    return k < exact_shares ? (struct share){share[k], share_rest[k], 1} : (struct share){share[k] + share_rest[k], 0, 0};
}

inlined vector scaled(vector rate, struct share s) {
    const vector value = s.first * rate;
    return s.is_sum ? value + s.rest * rate : value;
}

inlined half_vector scaled_half(half_vector rate, struct share s) {
    const half_vector value = s.first * rate;
    return s.is_sum ? value + s.rest * rate : value;
}
