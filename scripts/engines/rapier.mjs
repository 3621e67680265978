// Rapier: a rigid body in single precision; a top on a spherical joint, by impulses or as a
// multibody. Its package in JavaScript has no switch for the gyroscopic forces, which are on.

import RAPIER from "@dimforge/rapier3d-compat";
import { Refusal, startOf, stateOf } from "./common.mjs";

export const METHODS = ["impulse joint", "multibody joint"];
const vector = ([x, y, z]) => ({ x, y, z });
await RAPIER.init();

/** A world of one body. */
export function prepare(motion, method, step) {
  if (!motion.is_top && method !== METHODS[0]) throw new Refusal("a free body has no joint");
  const world = new RAPIER.World({ x: 0, y: 0, z: -motion.gravity });
  world.timestep = step;
  const { place, spin, velocity } = startOf(motion);
  const [w, x, y, z] = motion.quaternion;
  const inertia = [vector([0, 0, 0]), vector(motion.inertia), { x: 0, y: 0, z: 0, w: 1 }];
  const body = world.createRigidBody(
    RAPIER.RigidBodyDesc.dynamic()
      .setTranslation(...place)
      .setRotation({ x, y, z, w })
      .setLinvel(...velocity)
      .setAngvel(vector(spin))
      .setAdditionalMassProperties(motion.mass, ...inertia)
      .setCanSleep(false),
  );
  if (motion.is_top) {
    const ground = world.createRigidBody(RAPIER.RigidBodyDesc.fixed());
    const pivot = vector(motion.arm.map((a) => -a));
    const joint = RAPIER.JointData.spherical(vector([0, 0, 0]), pivot);
    if (method === METHODS[0]) world.createImpulseJoint(joint, ground, body, true);
    else world.createMultibodyJoint(joint, ground, body, true);
  }
  const advance = (n) => {
    for (let i = 0; i < n; i += 1) world.step();
  };
  const state = () => {
    const [q, v] = [body.rotation(), body.angvel()];
    return stateOf([q.x, q.y, q.z, q.w], [v.x, v.y, v.z]);
  };
  return { advance, state, end: () => world.free() };
}
