// The states of the presets of a live top. The dictionary has the title of each, and what one sees.

import { complete, linkOf } from "./scene.js";

const EXAMPLE_1 = { shape: "inertia", mass: 1, inertia1: 0.875, inertia3: 0.25, length: 0.8660254037844387, gravity: 9.81 };
const EXAMPLE_2 = { shape: "spinning_wheel", radius: 0.1, thickness: 0.01, density: 7800, rod_length: 1, gravity: 9.81 };
const AUTHORS = {
  shape: "inertia", mass: 2.450442269800039, inertia1: 0.00614652602674843, inertia3: 0.012252211349000194, length: 1,
  gravity: 9.81,
};
/** Half of the threshold of the sleeping top, 2 sqrt(m g l I1)/I3. */
const HALF_THRESHOLD = Math.sqrt(9.81 * EXAMPLE_1.length * EXAMPLE_1.inertia1) / EXAMPLE_1.inertia3;
/** Spin ratio 2 of the wheel: omega3 = 2 sqrt(4 m g l/I3), I3 = m r^2/2. */
const RATIO_2 = 2 * Math.sqrt((8 * 9.81 * EXAMPLE_2.rod_length) / EXAMPLE_2.radius ** 2);
const TOY = { shape: "cone", radius: 0.03, thickness: 0.06, density: 650, gravity: 9.81 };
const TIPS = { ...EXAMPLE_1, theta: 50, omega3: 30, t_end: 5 };

export const PRESETS = {
  cusp: TIPS,
  loop: { ...TIPS, phi_rate: -1.2 },
  wave: { ...TIPS, phi_rate: 0.8 },
  sleeping: { ...EXAMPLE_1, theta: 1, omega3: 25, t_end: 10 },
  falling: { ...EXAMPLE_1, theta: 1, omega3: 19.6, t_end: 8 },
  separatrix: { ...EXAMPLE_1, theta: 120, omega3: HALF_THRESHOLD, phi_rate: 6.231976237301238, t_end: 5 },
  slow: { ...EXAMPLE_1, theta: 60, omega3: 18, precession: "slow", t_end: 8 },
  fast: { ...EXAMPLE_1, theta: 60, omega3: 18, precession: "fast", t_end: 3 },
  rest: { ...TOY, theta: 2, omega3: 280, friction: 4e-4, t_end: 16 },
  damped: { ...EXAMPLE_1, theta: 20, omega3: 40, damping1: 0.1, damping3: 0.01, t_end: 60 },
  kapitza: {
    shape: "inertia", mass: 1, inertia1: 0.9, inertia3: 0.3, length: 0.5, gravity: 9.81, theta: 10, omega3: 0,
    amplitude: 0.15, vibration_rate: 60, t_end: 6,
  },
  chaotic: {
    shape: "body", mass: 1, inertia1: 0.9, inertia2: 0.6, inertia3: 0.35, centre_x: 0.1, centre_y: 0, centre_z: 0.4,
    gravity: 9.81, theta: 60, omega3: 8, t_end: 15,
  },
  example1: { ...EXAMPLE_1, theta: 11.25, omega3: 1, t_end: 6 },
  example2: { ...EXAMPLE_2, theta: 11.25, omega3: RATIO_2, t_end: 10 },
  figure11: { ...AUTHORS, theta: 11.25, omega3: RATIO_2, t_end: 0.6 },
  pendulum: { ...EXAMPLE_1, theta: 120, omega3: 0, t_end: 7 },
  cone: { ...TOY, theta: 5, omega3: 300, t_end: 2 },
};

/** The preset with which the page begins. */
export const FIRST = "cusp";

/** The preset that has a state; empty if none has. */
export function presetOf(state) {
  const link = linkOf(state);
  return Object.keys(PRESETS).find((key) => linkOf(complete(PRESETS[key])) === link) ?? "";
}
