// The bifurcation diagram of the live top: where steady precessions, cusps and the sleeping top lie.

import { makeBody, startFromAngles } from "../../scripts/reporting/page/dynamics/body.js";
import { describeNutation } from "../../scripts/reporting/page/dynamics/nutation.js";
import { criticalOmega3, steadyRates } from "../../scripts/reporting/page/dynamics/steady_motion.js";
import { constantsOf, steadyOf } from "../../scripts/reporting/page/live/bifurcation.js";
import { equal, near, test } from "./check.js";

const body = makeBody({ mass: 1, inertia: [0.7, 0.7, 0.3], centre: [0, 0, 0.5] });

/** The constants of a motion. */
function constants(given) {
  const start = startFromAngles({ phiRate: 0, ...given });
  return constantsOf({ body, start, nutation: describeNutation(body, start) });
}

/** The ordinate of the steady precession with a ratio of the momenta. */
function ordinateAt({ strength, ratio }) {
  const { ratios, ordinates } = steadyOf(strength);
  const i = ratios.findIndex((x) => x >= ratio);
  const part = (ratio - ratios[i - 1]) / (ratios[i] - ratios[i - 1]);
  return ordinates[i - 1] + part * (ordinates[i] - ordinates[i - 1]);
}

test("steady precessions are on the curve, all other motions above it", () => {
  for (const omega3 of [-40, -12, 9, 15, 30]) {
    for (const theta of [0.3, 1.2, 1.7, 2.6]) {
      for (const phiRate of steadyRates(body, theta, omega3)) {
        const steady = constants({ theta, phiRate, omega3 });
        near(steady.excess, ordinateAt(steady), 2e-3 * (1 + Math.abs(steady.excess)), `steady ${omega3} ${theta}`);
        const other = constants({ theta, phiRate, thetaRate: 3, omega3 });
        equal(other.excess > ordinateAt(other), true, "whether it is above the curve");
      }
    }
  }
});

test("cusps are at zero, loops above, waves below", () => {
  const [loop, cusp, wave] = [-1, 0, 1].map((phiRate) => constants({ theta: 1, phiRate, omega3: 30 }));
  near(cusp.excess, 0, 1e-15, "energy of a cusp");
  equal([loop.excess > 0, wave.excess < 0], [true, true]);
});

test("the sleeping top is on the curve from its threshold on", () => {
  const threshold = criticalOmega3(body);
  for (const part of [0.9, 1.1]) {
    const upright = constants({ theta: 0, omega3: part * threshold });
    near(upright.ratio, 1, 1e-15);
    near(upright.strength, 2 * part ** 2, 1e-14);
    equal(ordinateAt({ ...upright, ratio: 1 }) < -1e-3, part < 1, "whether motions have less energy");
  }
  equal(constantsOf({ body, start: startFromAngles({ theta: 1, phiRate: 1, omega3: 0 }), nutation: null }), null);
});
