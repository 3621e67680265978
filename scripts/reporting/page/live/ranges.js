// The ranges of the sliders.

import { roundUp } from "./controls.js";
import { resolve } from "./scene.js";

/** Give the sliders ranges that suit a state. */
export function suitRanges(controls, state) {
  const { body, threshold, roots } = resolve(state);
  for (const [name, control] of Object.entries(controls)) control.suit(state[name]);
  const natural = Math.SQRT2 * body.naturalRate || 1;
  const largest = Math.max(...body.inertia);
  const reach = Math.hypot(...body.centre) || 1;
  const losses = {
    damping1: 0.1 * largest * natural, damping2: 0.1 * largest * natural, damping3: 0.1 * body.inertia3 * natural,
    friction: 0.1 * largest * natural ** 2, amplitude: 0.3 * reach, vibration_rate: 40 * natural,
  };
  for (const [name, most] of Object.entries(losses)) controls[name].setRange(0, roundUp(Math.max(most, state[name])));
  for (const name of ["centre_x", "centre_y", "centre_z", "product23", "product31", "product12"]) {
    const most = roundUp(Math.max(name.startsWith("centre") ? reach : 0.3 * largest, Math.abs(state[name])));
    controls[name].setRange(-most, most);
  }
  const symmetric = (...values) => {
    const most = roundUp(Math.max(...values.map(Math.abs), 1e-3));
    return [-most, most];
  };
  const spin = roundUp(Math.max(1.6 * threshold, 1.5 * Math.abs(state.omega3), 1));
  controls.omega3.setRange(state.omega3 < 0 ? -spin : 0, spin);
  const fast = state.precession === "fast" ? 1.2 * (roots[1] ?? 0) : 0;
  controls.phi_rate.setRange(...symmetric(1.2 * natural, 1.5 * state.phi_rate, fast));
  controls.theta_rate.setRange(...symmetric(2 * natural, 1.5 * state.theta_rate));
}
