// Compare the trajectory of an engine with a reference motion of spintop, in JavaScript, without other packages.
//
//     import { check } from "./check.mjs";
//     console.log(check(times, quaternions, omega, json, csv));
//
// `json` and `csv` are the texts of the two files of a motion: readFileSync(...) of Node, (await fetch(...)).text() of a page.
// Conventions of the set: quaternions have the scalar first and turn body axes into space axes, angular velocities are in
// body axes, space z is up. Those of the engine are found: those that fit best. Public domain (CC0-1.0).

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
const distance = (a, b) => Math.hypot(...a.map((x, i) => x - b[i]));
const median = (list) => [...list].sort((a, b) => a - b)[Math.floor(list.length / 2)];

/** The columns of a table by name. */
export function columnsOf(csv) {
    const lines = csv.split("\n").filter((line) => line && !line.startsWith("#"));
    const rows = lines.slice(1).map((line) => line.split(",").map(Number));
    return Object.fromEntries(lines[0].split(",").map((name, i) => [name, rows.map((row) => row[i])]));
}

/** A vector turned by a quaternion from body to space axes, or back. */
export function turned(q, v, back = false) {
    const u = q.slice(1).map((x) => (back ? -x : x));
    const twice = cross(u, v).map((x) => 2 * x);
    const last = cross(u, twice);
    return v.map((x, i) => x + q[0] * twice[i] + last[i]);
}

/** The angle of the rotation from one attitude to another, rad; the signs of the quaternions do not matter. */
export function angle(p, q) {
    const c = cross(p.slice(1), q.slice(1));
    const v = [1, 2, 3].map((i) => p[0] * q[i] - q[0] * p[i] - c[i - 1]);
    return 2 * Math.atan2(Math.hypot(...v), Math.abs(dot(p, q)));
}

/**
 * Compare a trajectory with a motion. `quaternions` has four numbers for each time, `omega` three; it may be null. Times that the
 * reference does not have are left out. Returns the conventions of the trajectory, the errors at the common times, and the
 * largest: rotation from the reference, rad, difference of omega, rad/s, changes of energy (over the kinetic energy at the start
 * plus m g |r|) and momentum (over the largest) against the reference; `attitude_floor` is the error of the reference plus that
 * by rounding of the data, rad.
 */
export function check(times, quaternions, omega, json, csv) {
    const data = JSON.parse(json), columns = columnsOf(csv), t = columns.t;
    if (quaternions.length !== times.length || (omega && omega.length !== times.length)) {
        throw new RangeError("there must be a quaternion, and an omega if any, for each time");
    }
    const close = 1e-9 * (t[1] - t[0]);
    const pairs = times.map((time, i) => [i, t.findIndex((x) => Math.abs(x - time) <= close)]).filter((pair) => pair[1] >= 0);
    if (pairs.length < 2) throw new RangeError("fewer than two of the times are those of the motion");
    const pick = (names) => pairs.map(([, row]) => names.map((name) => columns[name][row]));
    const reference = pick(["q0", "q1", "q2", "q3"]), truth = pick(["omega1", "omega2", "omega3"]);
    const { mass, gravity, inertia, centre_of_mass: centre } = data.body;
    const momentum = (w) => inertia.map((row) => dot(row, w));
    const energy = (q, w) => dot(w, momentum(w)) / 2 + mass * gravity * turned(q, centre)[2];
    const least = (found, key) => found.reduce((best, each) => (median(each[key]) < median(best[key]) ? each : best));

    const attitudes = [];
    for (const direction of ["body to space", "space to body"]) {
        for (const scalar of ["first", "last"]) {
            const attitude = pairs.map(([i]) => {
                const [w, ...v] = scalar === "first" ? quaternions[i] : [quaternions[i][3], ...quaternions[i].slice(0, 3)];
                const length = Math.hypot(w, ...v), sign = direction === "body to space" ? 1 : -1;
                return [w / length, ...v.map((x) => (sign * x) / length)];
            });
            attitudes.push({ scalar, direction, attitude, errors: attitude.map((q, k) => angle(q, reference[k])) });
        }
    }
    const { attitude, errors, ...names } = least(attitudes, "errors");
    const report = {
        motion: data.name, ...names, t: pairs.map(([i]) => times[i]), attitude_errors: errors,
        attitude_error: Math.max(...errors),
        attitude_floor: Math.max(...pairs.map(([, row]) => data.errors.attitude.value + columns.inherent_error[row])),
    };
    if (!omega) return report;
    const found = [];
    for (const frame of ["body", "space"]) {
        for (const sign of ["plus", "minus"]) {
            const body = pairs.map(([i], k) => {
                const w = Array.from(omega[i], (x) => (sign === "plus" ? x : -x));
                return frame === "body" ? w : turned(attitude[k], w, true);
            });
            found.push({ frame, sign, body, omega_errors: body.map((w, k) => distance(w, truth[k])) });
        }
    }
    const { body, ...rest } = least(found, "omega_errors");
    const scale = dot(truth[0], momentum(truth[0])) / 2 + mass * gravity * Math.hypot(...centre);
    const momenta = reference.map((q, k) => turned(q, momentum(truth[k])));
    const changes = body.map((w, k) => Math.abs(energy(attitude[k], w) - energy(reference[k], truth[k])));
    const turns = body.map((w, k) => distance(turned(attitude[k], momentum(w)), momenta[k]));
    return {
        ...report, ...rest, omega_error: Math.max(...rest.omega_errors),
        energy_change: Math.max(...changes) / (scale || 1),
        momentum_change: Math.max(...turns) / (Math.max(...momenta.map((p) => Math.hypot(...p))) || 1),
    };
}

/** The order of convergence: the slope of log(error) over log(step), of three steps or more. */
export function order(steps, errors) {
    const x = steps.map(Math.log), y = errors.map(Math.log), n = x.length;
    const mean = (list) => list.reduce((sum, each) => sum + each, 0) / n;
    return (mean(x.map((a, i) => a * y[i])) - mean(x) * mean(y)) / (mean(x.map((a) => a * a)) - mean(x) ** 2);
}
