// The rows of the terms of motions in lanes, one number of each lane in a row, as lane_series.f90 has
// them.

enum { lanes = 8, rows = 9, term = lanes * rows, more_rows = 36, more = lanes * more_rows };

// The rows of a term of the series.
enum { w1, w2, w3, g1, g2, g3, angle, quotient, numerator };

// Further rows: rotation of the frame, torque in space axes, acceleration of the pivot and its other part, the angular
// velocity with that of the frame, drags; and of a drag: u = Q w, s = w.u, j s_j, y = s^b, v = y u.
enum { frame, torque = 3, push = 6, pull_back = 9, total = 12, drags = 15, of_drag = 9 };
enum { drag_u, drag_s = 3, drag_t, drag_y, drag_v };
enum { most_drags = 2, most_turning = 4 };
