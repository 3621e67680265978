// A heavy top by the explicit midpoint rule with three step sizes, compared with the reference.
import { readFileSync } from "node:fs";
import { check, columnsOf, order } from "./check.mjs";

const [json, csv] = ["json", "csv"].map((end) => readFileSync(new URL(`motions/loop.${end}`, import.meta.url), "utf8"));
const { body, start } = JSON.parse(json), times = columnsOf(csv).t;
const moments = body.inertia.map((row, i) => row[i]); // this body's axes are principal ones
const weight = body.mass * body.gravity, centre = body.centre_of_mass;
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/** The derivatives of quaternion (scalar first, body to space) and omega (body axes). */
function rates([w, x, y, z, ...omega]) {
    const [a, b, c] = omega.map((each) => each / 2);
    const up = [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z];
    const gyro = cross(omega.map((each, i) => moments[i] * each), omega), pull = cross(up, centre);
    return [
        -x * a - y * b - z * c, w * a + y * c - z * b, w * b + z * a - x * c, w * c + x * b - y * a,
        ...gyro.map((each, i) => (each + weight * pull[i]) / moments[i]),
    ];
}

const moved = (state, h, rate) => state.map((x, i) => x + h * rate[i]);
const sizes = [], errors = [];
let report;
for (const steps of [50, 100, 200]) {
    const states = [[...start.quaternion, ...start.omega]], h = (times[1] - times[0]) / steps;
    while (states.length < times.length) {
        let state = states.at(-1);
        for (let i = 0; i < steps; i++) state = moved(state, h, rates(moved(state, h / 2, rates(state))));
        states.push(state);
    }
    report = check(times, states.map((s) => s.slice(0, 4)), states.map((s) => s.slice(4)), json, csv);
    sizes.push(h), errors.push(report.attitude_error);
}
for (const [name, value] of Object.entries(report)) {
    if (!Array.isArray(value)) console.log(name.padEnd(18), typeof value === "number" ? value.toPrecision(2) : value);
}
console.log("order of convergence", order(sizes, errors).toFixed(2));
