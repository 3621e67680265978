// cannon-es: a rigid body, in double precision; a top hangs on a point-to-point constraint.
//
// Its equations have no gyroscopic torque: a free body keeps its angular velocity in space.

import { Body, PointToPointConstraint, Vec3, World } from "cannon-es";
import { startOf, stateOf } from "./common.mjs";

export const METHODS = ["default"];

/** A world of one body. */
export function prepare(motion, method, step) {
  const world = new World({ gravity: new Vec3(0, 0, -motion.gravity), allowSleep: false });
  const { place, spin, velocity } = startOf(motion);
  const [w, x, y, z] = motion.quaternion;
  const body = new Body({ mass: motion.mass, linearDamping: 0, angularDamping: 0 });
  body.position.set(...place);
  body.quaternion.set(x, y, z, w);
  body.velocity.set(...velocity);
  body.angularVelocity.set(...spin);
  body.inertia.set(...motion.inertia);
  body.invInertia.set(...motion.inertia.map((i) => 1 / i));
  body.updateInertiaWorld(true);
  world.addBody(body);
  if (motion.is_top) {
    const ground = new Body({ mass: 0 });
    world.addBody(ground);
    const arm = new Vec3(...motion.arm.map((a) => -a));
    world.addConstraint(new PointToPointConstraint(body, arm, ground, new Vec3(0, 0, 0), 1e9));
  }
  const advance = (n) => {
    for (let i = 0; i < n; i += 1) world.step(step);
  };
  const state = () => stateOf(body.quaternion.toArray(), body.angularVelocity.toArray());
  return { advance, state };
}
