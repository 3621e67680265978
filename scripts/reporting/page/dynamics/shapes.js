// Bodies of common shapes: mass properties from dimensions and density: src/top/shapes.f90.
//
// Every shape is a homogeneous solid of revolution about body z, on a massless support.

/** Volume, distance of the centre of mass from the pivot, and squares of the radii of inertia about it. */
const SOLIDS = {
  spinning_wheel: ({ radius, thickness, rodLength }) => disc(0, radius, thickness, rodLength),
  ring: ({ radius, innerRadius, thickness, rodLength }) => disc(innerRadius, radius, thickness, rodLength),
  cylinder: ({ radius, thickness }) => disc(0, radius, thickness, thickness / 2),
  sphere: ({ radius: r, rodLength }) => ({
    volume: (4 * Math.PI * r ** 3) / 3, length: rodLength, across: (2 * r ** 2) / 5, along: (2 * r ** 2) / 5,
  }),
  cone: ({ radius: r, thickness: h }) => ({
    volume: (Math.PI * r ** 2 * h) / 3, length: (3 * h) / 4,
    across: (3 * (4 * r ** 2 + h ** 2)) / 80, along: (3 * r ** 2) / 10,
  }),
};

/** A disc with a round hole. */
function disc(inner, outer, height, length) {
  return {
    volume: Math.PI * (outer - inner) * (outer + inner) * height,
    length,
    across: (3 * (outer ** 2 + inner ** 2) + height ** 2) / 12,
    along: (outer ** 2 + inner ** 2) / 2,
  };
}

/** Mass properties of a shape about the pivot. */
export function buildShape(name, size, density) {
  const { volume, length, across, along } = SOLIDS[name](size);
  const mass = density * volume;
  const transverse = mass * (across + length ** 2);
  return { mass, inertia: [transverse, transverse, mass * along], centre: [0, 0, length] };
}
