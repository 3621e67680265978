// Logarithm and power to base 2 for step sizes, which need few digits.

// clang-format off: the brackets of the polynomials would get a line each.

// Logarithm to base 2, to 5e-8: step sizes do not depend on the unit of time. Of zero: about -1023. A polynomial
// interpolates at Chebyshev points. The exponent becomes a number behind the last digit of 2^52.
inlined vector binary_logarithm(vector x) {
    const vector exponent = (vector)(((bits)x >> 52) | 0x4330000000000000LL) - (0x1p52 + 1023);
    const vector rest = (vector)(((bits)x & 0x000fffffffffffffLL) | 0x3ff0000000000000LL) - 1.5;
    const vector square = rest * rest, fourth = square * square;
    return (exponent + (0.5849624944956765 + 0.9617959717013141 * rest))
           + square * (-0.320597665920493 + 0.142526370168855 * rest)
           + fourth * ((-0.0712830113499598 + 0.037462937512856016 * rest)
                       + square * ((-0.02068585496342283 + 0.014778720766070565 * rest) - 0.008874696645114751 * square));
}

// Power of 2, to 6e-9, for |y| < 1000.
inlined vector power_of_two(vector y) {
    const double round = 0x1.8p52;
    const vector shifted = y + round, x = y - (shifted - round), square = x * x;
    return (vector)(((bits)shifted + 1023) << 52) * ((1 + 0.69314718055994531 * x)
                    + square * ((0.24022650695910072 + 0.055504108664821580 * x)
                                + square * ((0.0096181291076284772 + 0.0013333558146428443 * x)
                                            + square * (0.00015403530393381609 + 0.000015252733804059841 * x))));
}

// clang-format on
