// Jolt: a rigid body in single precision, with the gyroscopic force, which is off by default, and
// without; a top on a point constraint.

import initialise from "jolt-physics";
import { startOf, stateOf } from "./common.mjs";

export const METHODS = ["gyroscopic force", "default"];
const Jolt = await initialise();

/** An interface of one layer, in which nothing collides. */
function makeWorld() {
  const settings = new Jolt.JoltSettings();
  const filter = (settings.mObjectLayerPairFilter = new Jolt.ObjectLayerPairFilterTable(1));
  const layers = (settings.mBroadPhaseLayerInterface = new Jolt.BroadPhaseLayerInterfaceTable(1, 1));
  layers.MapObjectToBroadPhaseLayer(0, new Jolt.BroadPhaseLayer(0));
  settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(layers, 1, filter, 1);
  return new Jolt.JoltInterface(settings);
}

/** A body with this mass and inertia, without damping, sleep and a limit of its velocity. */
function makeBody(motion, isGyroscopic, bodies) {
  const { place, spin, velocity } = startOf(motion);
  const [w, x, y, z] = motion.quaternion;
  const shape = new Jolt.SphereShape(0.01, null);
  const start = [new Jolt.RVec3(...place), new Jolt.Quat(x, y, z, w)];
  const about = new Jolt.BodyCreationSettings(shape, ...start, Jolt.EMotionType_Dynamic, 0);
  about.mOverrideMassProperties = Jolt.EOverrideMassProperties_MassAndInertiaProvided;
  about.mMassPropertiesOverride.mMass = motion.mass;
  about.mMassPropertiesOverride.mInertia = Jolt.Mat44.prototype.sScaleVec3(new Jolt.Vec3(...motion.inertia));
  about.mApplyGyroscopicForce = isGyroscopic;
  about.mAllowSleeping = false;
  about.mLinearDamping = about.mAngularDamping = 0;
  about.mMaxLinearVelocity = about.mMaxAngularVelocity = 1e6;
  const body = bodies.CreateBody(about);
  bodies.AddBody(body.GetID(), Jolt.EActivation_Activate);
  bodies.SetLinearVelocity(body.GetID(), new Jolt.Vec3(...velocity));
  bodies.SetAngularVelocity(body.GetID(), new Jolt.Vec3(...spin));
  return body;
}

/** A world of one body. */
export function prepare(motion, method, step) {
  const world = makeWorld();
  const system = world.GetPhysicsSystem();
  system.SetGravity(new Jolt.Vec3(0, 0, -motion.gravity));
  const body = makeBody(motion, method !== "default", system.GetBodyInterface());
  if (motion.is_top) {
    const joint = new Jolt.PointConstraintSettings();
    joint.mPoint1 = joint.mPoint2 = new Jolt.RVec3(0, 0, 0);
    system.AddConstraint(joint.Create(Jolt.JoltInterface.prototype.sGetFixedToWorldBody(), body));
  }
  const advance = (n) => {
    for (let i = 0; i < n; i += 1) world.Step(step, 1);
  };
  const state = () => {
    const [q, v] = [body.GetRotation(), body.GetAngularVelocity()];
    return stateOf([q.GetX(), q.GetY(), q.GetZ(), q.GetW()], [v.GetX(), v.GetY(), v.GetZ()]);
  };
  return { advance, state, end: () => Jolt.destroy(world) };
}
