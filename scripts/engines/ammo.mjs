// ammo.js: Bullet's rigid body in single precision; a top on a point-to-point constraint.
//
// Its gyroscopic torque is implicit, as in PyBullet.

import Ammo from "ammo.js";
import { startOf, stateOf } from "./common.mjs";

export const METHODS = ["default"];
const vector = (v) => new Ammo.btVector3(...v);

/** A world of one body. */
export function prepare(motion, method, step) {
  const configuration = new Ammo.btDefaultCollisionConfiguration();
  const parts = [
    new Ammo.btCollisionDispatcher(configuration),
    new Ammo.btDbvtBroadphase(),
    new Ammo.btSequentialImpulseConstraintSolver(),
    configuration,
  ];
  const world = new Ammo.btDiscreteDynamicsWorld(...parts);
  world.setGravity(vector([0, 0, -motion.gravity]));
  const { place, spin, velocity } = startOf(motion);
  const [w, x, y, z] = motion.quaternion;
  const start = new Ammo.btTransform();
  start.setIdentity();
  start.setOrigin(vector(place));
  start.setRotation(new Ammo.btQuaternion(x, y, z, w));
  const body = new Ammo.btRigidBody(
    new Ammo.btRigidBodyConstructionInfo(
      motion.mass,
      new Ammo.btDefaultMotionState(start),
      new Ammo.btSphereShape(0.01),
      vector(motion.inertia),
    ),
  );
  body.setDamping(0, 0);
  body.setActivationState(4); // never sleeps
  body.setLinearVelocity(vector(velocity));
  body.setAngularVelocity(vector(spin));
  world.addRigidBody(body);
  if (motion.is_top) {
    const pivot = vector(motion.arm.map((a) => -a));
    world.addConstraint(new Ammo.btPoint2PointConstraint(body, pivot), true);
  }
  const advance = (n) => {
    for (let i = 0; i < n; i += 1) world.stepSimulation(step, 0);
  };
  const state = () => {
    const [q, v] = [body.getWorldTransform().getRotation(), body.getAngularVelocity()];
    return stateOf([q.x(), q.y(), q.z(), q.w()], [v.x(), v.y(), v.z()]);
  };
  const end = () => [world, body, ...parts].forEach((part) => Ammo.destroy(part)); // memory is small
  return { advance, state, end };
}
