// Logarithm and power to base 2 for step sizes, which need few digits.

// clang-format off: the brackets of the polynomials would get a line each.

// Logarithm to base 2, to 5e-8: step sizes do not depend on the unit of time. Of zero: about -1023. A polynomial
// interpolates at Chebyshev points.
static inline double binary_logarithm(double x) {
    const long long mantissa = 0x000fffffffffffffLL, one = 0x3ff0000000000000LL;
    long long bits, of_rest;
    double rest;
    memcpy(&bits, &x, sizeof bits);
    of_rest = (bits & mantissa) | one;
    memcpy(&rest, &of_rest, sizeof rest);
    rest -= 1.5;
    const double square = rest * rest, fourth = square * square;
    return ((double)((bits >> 52) - 1023) + (0.5849624944956765 + 0.9617959717013141 * rest))
           + square * (-0.320597665920493 + 0.142526370168855 * rest)
           + fourth * ((-0.0712830113499598 + 0.037462937512856016 * rest)
                       + square * ((-0.02068585496342283 + 0.014778720766070565 * rest) - 0.008874696645114751 * square));
}

// Power of 2, to 6e-9, for |y| < 1000.
static inline double power_of_two(double y) {
    const double whole = nearbyint(y), x = y - whole, square = x * x;
    const long long bits = (long long)(whole + 1023) << 52;
    double power;
    memcpy(&power, &bits, sizeof power);
    return power * ((1 + 0.69314718055994531 * x)
                    + square * ((0.24022650695910072 + 0.055504108664821580 * x)
                                + square * ((0.0096181291076284772 + 0.0013333558146428443 * x)
                                            + square * (0.00015403530393381609 + 0.000015252733804059841 * x))));
}

// clang-format on
