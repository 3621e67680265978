// Where the motion of a body without effects starts, for body_series.h and body_stages.h.

// The quaternion, the momentum and the vertical in body axes, of a quaternion of any length.
inlined void find_first_term(const double *state, half_vector *q, half_vector *momentum, half_vector *vertical) {
    const double q0 = state[0], q1 = state[1], q2 = state[2], q3 = state[3];
    const double upper = q0 * q0 + q3 * q3, lower = q1 * q1 + q2 * q2, inverse = 1 / (upper + lower);
    const half_vector g = {2 * (q1 * q3 - q0 * q2), 2 * (q2 * q3 + q0 * q1), upper - lower, 0};
    memcpy(q, state, sizeof *q), memcpy(momentum, state + half, sizeof *momentum);
    *vertical = inverse * g;
}
