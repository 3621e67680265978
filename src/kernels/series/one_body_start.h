// What the algebras of one body have in common.

// A power that is a polynomial has a series everywhere; another one, where s is zero, only if s is zero throughout: then its
// terms are zero.
inlined num inverse_of(num s) { return s > 0 ? 1 / s : 0; }
inlined num power_term(num b, num s, num y) { return b < 1 || b > 1 ? y : s; }

// Most of the amplitudes of a body are zero.
inlined void find_swing(num size, num x, num *even, num *odd) {
    *even = *odd = 0;
    if (!(size < 0 || size > 0)) return;
    find_circle(x, even, odd);
    *even *= size, *odd *= size;
}

// Space x, y and z in body axes, of a quaternion of any length: quadratic forms, divided by the squared norm 1 + s. Where s is
// small its share s/(1 + s) is subtracted: a factor that is rounded beside 1 errs to one side on average, since numbers below 1
// are denser than those above, and energy drifts.
inlined void find_axes(const element *q, num side, vec axes[3]) {
    const num q0 = q[0], q1 = q[1], q2 = q[2], q3 = q[3], s = ((q0 * q0 - 1) + q3 * q3) + q1 * q1 + q2 * q2;
    (void)side;
    axes[0] = vec_of((q0 * q0 + q1 * q1) - (q2 * q2 + q3 * q3), 2 * (q1 * q2 - q0 * q3), 2 * (q1 * q3 + q0 * q2));
    axes[1] = vec_of(2 * (q1 * q2 + q0 * q3), (q0 * q0 + q2 * q2) - (q1 * q1 + q3 * q3), 2 * (q2 * q3 - q0 * q1));
    axes[2] = vec_of(2 * (q1 * q3 - q0 * q2), 2 * (q2 * q3 + q0 * q1), (q0 * q0 + q3 * q3) - (q1 * q1 + q2 * q2));
    for_all(i, 3) {
        if (s > -0.5 && s < 0.5) {
            axes[i] = sub(axes[i], by(s / (1 + s), axes[i]));
        } else {
            axes[i] = by(1 / (q0 * q0 + q3 * q3 + q1 * q1 + q2 * q2), axes[i]);
        }
    }
}
