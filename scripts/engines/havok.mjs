// Havok: a rigid body in single precision; a top on a constraint whose linear axes are locked.

import initialise from "@babylonjs/havok";
import { readFileSync } from "node:fs";
import { startOf, stateOf } from "./common.mjs";

export const METHODS = ["default"];
const place = new URL("./node_modules/@babylonjs/havok/lib/esm/HavokPhysics.wasm", import.meta.url);
const hk = await initialise({ wasmBinary: readFileSync(place) });
const AXES = ["LINEAR_X", "LINEAR_Y", "LINEAR_Z"];

/** A body at the start of a motion. */
function makeBody(motion, world) {
  const { place, spin, velocity } = startOf(motion);
  const [w, x, y, z] = motion.quaternion;
  const [, body] = hk.HP_Body_Create();
  hk.HP_Body_SetShape(body, hk.HP_Shape_CreateSphere([0, 0, 0], 0.01)[1]);
  hk.HP_Body_SetMotionType(body, hk.MotionType.DYNAMIC);
  hk.HP_Body_SetMassProperties(body, [[0, 0, 0], motion.mass, motion.inertia, [0, 0, 0, 1]]);
  hk.HP_Body_SetQTransform(body, [place, [x, y, z, w]]);
  hk.HP_World_AddBody(world, body, false);
  hk.HP_Body_SetLinearDamping(body, 0);
  hk.HP_Body_SetAngularDamping(body, 0);
  hk.HP_Body_SetActivationControl(body, hk.ActivationControl.ALWAYS_ACTIVE);
  hk.HP_Body_SetLinearVelocity(body, velocity);
  hk.HP_Body_SetAngularVelocity(body, spin);
  return body;
}

/** A world of one body. */
export function prepare(motion, method, step) {
  const [, world] = hk.HP_World_Create();
  hk.HP_World_SetGravity(world, [0, 0, -motion.gravity]);
  hk.HP_World_SetIdealStepTime(world, step);
  hk.HP_World_SetSpeedLimit(world, 1e6, 1e6);
  const body = makeBody(motion, world);
  if (motion.is_top) {
    const [, ground] = hk.HP_Body_Create();
    hk.HP_Body_SetMotionType(ground, hk.MotionType.STATIC);
    hk.HP_World_AddBody(world, ground, false);
    const [, joint] = hk.HP_Constraint_Create();
    hk.HP_Constraint_SetParentBody(joint, ground);
    hk.HP_Constraint_SetChildBody(joint, body);
    hk.HP_Constraint_SetAnchorInParent(joint, [0, 0, 0], [1, 0, 0], [0, 1, 0]);
    hk.HP_Constraint_SetAnchorInChild(joint, motion.arm.map((a) => -a), [1, 0, 0], [0, 1, 0]);
    for (const axis of AXES) {
      hk.HP_Constraint_SetAxisMode(joint, hk.ConstraintAxis[axis], hk.ConstraintAxisLimitMode.LOCKED);
    }
    hk.HP_Constraint_SetEnabled(joint, true);
  }
  const advance = (n) => {
    for (let i = 0; i < n; i += 1) hk.HP_World_Step(world, step);
  };
  const state = () => stateOf(hk.HP_Body_GetOrientation(body)[1], hk.HP_Body_GetAngularVelocity(body)[1]);
  return { advance, state, end: () => hk.HP_World_Release(world) };
}
