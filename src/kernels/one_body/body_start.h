// Where the motion of a body without effects starts, for body_series.h and body_stages.h.

// A quadratic form of a quaternion, divided by the squared norm 1 + s. Where s is small its share s/(1 + s) is subtracted: a
// factor that is rounded beside 1 errs to one side on average, since numbers below 1 are denser than those above, and energy
// drifts.
inlined half_vector divided_by_square(half_vector form, const double *q) {
    const double s = ((q[0] * q[0] - 1) + q[3] * q[3]) + q[1] * q[1] + q[2] * q[2];
    if (fabs(s) < 0.5) return form - s / (1 + s) * form;
    return form / (q[0] * q[0] + q[3] * q[3] + q[1] * q[1] + q[2] * q[2]);
}

// The quaternion, the momentum and the vertical in body axes, of a quaternion of any length.
inlined void find_first_term(const double *state, half_vector *q, half_vector *momentum, half_vector *vertical) {
    const double q0 = state[0], q1 = state[1], q2 = state[2], q3 = state[3];
    const half_vector g = {2 * (q1 * q3 - q0 * q2), 2 * (q2 * q3 + q0 * q1), (q0 * q0 + q3 * q3) - (q1 * q1 + q2 * q2), 0};
    memcpy(q, state, sizeof *q), memcpy(momentum, state + half, sizeof *momentum);
    *vertical = divided_by_square(g, state);
}
