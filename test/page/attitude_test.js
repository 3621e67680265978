// Attitudes against the definition of Euler's angles, R = Rz(phi) Rx(theta) Rz(psi).

import { Matrix4, Quaternion, Vector3 } from "three";
import { fromAngles, toAngles, turnAbout, twistOf } from "../../scripts/reporting/page/attitude.js";
import { nearTo } from "../../scripts/reporting/page/dynamics/numbers.js";
import { near, test } from "./check.js";

const SOME = [[0.3, 1.1, -2], [-2.9, 0.01, 3], [1, 3.1, 0.2], [0, 1.5, 0]];

test("an attitude turns as three matrices do", () => {
  for (const [phi, theta, psi] of SOME) {
    const matrix = new Matrix4()
      .makeRotationZ(phi)
      .multiply(new Matrix4().makeRotationX(theta))
      .multiply(new Matrix4().makeRotationZ(psi));
    const expected = new Vector3(1, 2, 3).applyMatrix4(matrix);
    const found = new Vector3(1, 2, 3).applyQuaternion(fromAngles(phi, theta, psi));
    near(found.distanceTo(expected), 0, 1e-14, `turn by ${[phi, theta, psi]}`);
  }
});

test("angles come back from the attitude", () => {
  for (const angles of SOME) {
    toAngles(fromAngles(...angles)).forEach((angle, k) => near(angle, angles[k], 1e-13));
  }
});

test("at the poles the attitude is kept, if not the angles", () => {
  for (const theta of [0, Math.PI]) {
    const attitude = fromAngles(0.7, theta, 0.4);
    if (theta > 0) attitude.set(attitude.x, attitude.y, 0, 0);
    const again = fromAngles(...toAngles(attitude));
    near(Math.abs(again.dot(attitude)), 1, 1e-15);
  }
});

test("both quaternions of an attitude have its angles", () => {
  const { x, y, z, w } = fromAngles(0.3, 1.1, -2);
  const [phi, theta, psi] = toAngles(new Quaternion(-x, -y, -z, -w));
  [phi - 0.3, theta - 1.1, psi + 2].forEach((difference) => near(difference, 0, 1e-14));
});

test("turns are taken off and put on", () => {
  near(nearTo(7, 0), 7 - 2 * Math.PI, 1e-15);
  near(nearTo(0.5, 100), 0.5 + 32 * Math.PI, 1e-13);
});

test("a turn is a twist about an axis and a swing of it", () => {
  const [axis, across] = [new Vector3(0, 0.6, 0.8), new Vector3(1, 0, 0)];
  const turn = turnAbout(across, 0.7).multiply(turnAbout(axis, -1.3));
  near(twistOf(turn, axis), -1.3, 1e-15);
});
