// Bodies of common shapes: mass properties from dimensions and density: src/top/shapes.f90.
//
// Every shape is a homogeneous solid of revolution about body z, on a massless support.

/** Of each shape its solid, and how far the centre of mass is from the pivot. */
const SHAPES = {
  spinning_wheel: ({ radius, thickness, rod_length: rod }) => [{ kind: "cylinder", radius, height: thickness }, rod],
  ring: ({ radius, inner_radius: inner, thickness, rod_length: rod }) => [{ kind: "ring", radius, inner, height: thickness }, rod],
  cylinder: ({ radius, thickness }) => [{ kind: "cylinder", radius, height: thickness }, thickness / 2],
  sphere: ({ radius, rod_length: rod }) => [{ kind: "sphere", radius }, rod],
  cone: ({ radius, thickness }) => [{ kind: "cone", radius, height: thickness }, (3 * thickness) / 4],
};

/** Volume of a solid, and squares of its radii of inertia about the centre of mass, across the axis and along it. */
const ring = ({ radius: r, inner: s = 0, height: h }) => [
  Math.PI * (r - s) * (r + s) * h, (3 * (r ** 2 + s ** 2) + h ** 2) / 12, (r ** 2 + s ** 2) / 2,
];
const SOLIDS = {
  ring,
  cylinder: ring,
  sphere: ({ radius: r }) => [(4 * Math.PI * r ** 3) / 3, (2 * r ** 2) / 5, (2 * r ** 2) / 5],
  cone: ({ radius: r, height: h }) => [(Math.PI * r ** 2 * h) / 3, (3 * (4 * r ** 2 + h ** 2)) / 80, (3 * r ** 2) / 10],
};

/** Mass properties of a state's shape about the pivot, and its solid; null if it has no shape. */
export function buildShape(state) {
  if (!SHAPES[state.shape]) return null;
  const [solid, length] = SHAPES[state.shape](state);
  const [volume, across, along] = SOLIDS[solid.kind](solid);
  const mass = state.density * volume;
  const transverse = mass * (across + length ** 2);
  return { mass, inertia: [transverse, transverse, mass * along], centre: [0, 0, length], solid };
}
