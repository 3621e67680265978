// Where polynomials pass zero, one in each lane of a vector; see bernstein.f90, which has the method.

// Rounds of the change to Bernstein form at once.
enum { most_rounds = 6 };

// In round k each coefficient from b_n down to b_k gets the one below it added: some rounds from k on at once. `p` are the last
// values in them, each one place further up than in the round before.
inlined void add_below(int rounds, int k, int n, vector *b) {
    vector p[most_rounds];
    for_all(r, rounds) p[r] = b[n - r];
    for_all(r, rounds - 1) {
        for_all(i, rounds - 1) {
            if (i < rounds - 1 - r) p[i] += p[i + 1];
        }
    }
    // Now p[r] is of round rounds - 1 - r, at the place n - r.
    unrolled_for(int j = n; j > k + rounds - 2; --j) {
        vector below = b[j - rounds], sum;
        for_all(i, rounds) {
            sum = p[rounds - 1 - i] + below;
            p[rounds - 1 - i] = below;
            below = sum;
        }
        b[j] = below;
    }
    for_all(r, rounds - 1) b[k + rounds - 2 - r] = p[r];
}

inlined void to_bernstein(int n, vector *b) {
    int k = 1;
    for (; k + most_rounds - 1 <= n; k += most_rounds) add_below(most_rounds, k, n, b);
    for (; k + 1 <= n; k += 2) add_below(2, k, n, b);
    if (k <= n) add_below(1, k, n, b);
}

static void find_changes(int n, const double *share, double rounding, const double *a, double *noise, double *sign,
                         double *changes, double *near) {
    for (int lane = 0; lane < lanes; lane += width) {
        const vector none = {0}, one = none + 1;
        vector b[most_terms], least = get(noise + lane, 0), before = get(sign + lane, 0);
        vector found = none, total = none, index = none, place = none, here = none, last = none, ahead;

        unrolled_for(int k = 0; k <= n; ++k) {
            const vector term_k = get(a + lane, k);
            total += magnitude(term_k);
            b[k] = share[k] * term_k;
        }
        least += rounding * total;
        put(noise + lane, 0, least);
        to_bernstein(n, b);
        ahead = magnitude(b[0]);
        unrolled_for(int k = 0; k <= n; ++k, index += one) {
            const vector is = magnitude(b[k]);
            const bits has_sign = is > least;
            const vector now = (vector)((bits)b[k] & has_sign);
            const bits differs = now * before < none;
            found += (vector)((bits)one & differs);
            place = where(differs, index, place);
            here = where(differs, is, here);
            last = where(differs, ahead, last);
            before = where(has_sign, (vector)(((bits)one) | ((bits)now & ~0x7fffffffffffffffLL)), before);
            ahead = is;
        }
        put(sign + lane, 0, before);
        put(changes + lane, 0, found);
        // Between the coefficients before and behind the last change, as by a straight line.
        put(near + lane, 0, where(place > none, (place - here / (here + last)) / n, none));
    }
}

// Newton's method. The polynomial is E(v) + u O(v) with v = u^2: sums of half the length, which do not wait for each other.
static void refine_root(int n, int iterations, double still, const double *a, double *u, double *doubt) {
    for (int lane = 0; lane < lanes; lane += width) {
        const vector none = {0}, one = none + 1;
        vector root = get(u + lane, 0), far = none;
        for (int i = 0; i < iterations; ++i) {
            const vector v = root * root;
            int k = n / 2 * 2;
            vector even = get(a + lane, k), odd = k < n ? get(a + lane, k + 1) : none;
            vector even_rate = none, odd_rate = none;
            for (k -= 2; k >= 0; k -= 2) {
                even_rate = even_rate * v + even;
                odd_rate = odd_rate * v + odd;
                even = even * v + get(a + lane, k);
                odd = odd * v + get(a + lane, k + 1);
            }
            const vector slope = odd + 2 * root * (even_rate + root * odd_rate);
            vector new = root - (even + root * odd) / where(magnitude(slope) > none, slope, one);
            new = where(new > none, new, none);
            new = where(new < one, new, one);
            far = where(magnitude(new - root) <= none + still, none, one);
            root = new;
        }
        put(u + lane, 0, root);
        put(doubt + lane, 0, far);
    }
}
