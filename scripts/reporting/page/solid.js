// The body as three.js draws it: rod, solid, and marks by which one sees it turn.

import {
  BoxGeometry,
  CylinderGeometry,
  EdgesGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Matrix4,
  Mesh,
  MeshStandardMaterial,
  Quaternion,
  SphereGeometry,
  Vector3,
} from "three";

const SECTORS = 8;
const UP = new Vector3(0, 1, 0); // the axis of three's cylinders

function paint(colour, rest = {}) {
  return new MeshStandardMaterial({ color: colour, roughness: 0.55, metalness: 0.1, ...rest });
}

/** A rod from the pivot along a vector. */
function makeRod(vector, radius, material) {
  const rod = new Mesh(new CylinderGeometry(radius, radius, vector.length(), 24), material);
  rod.position.copy(vector).multiplyScalar(0.5);
  rod.quaternion.setFromUnitVectors(UP, vector.clone().normalize());
  return rod;
}

/** A cylinder about its z axis in sectors of two colours, one of them marked. */
function makeCylinder({ radius, height }, colours, rest) {
  const group = new Group();
  for (let i = 0; i < SECTORS; i += 1) {
    const from = (2 * Math.PI * i) / SECTORS;
    const geometry = new CylinderGeometry(radius, radius, height, 12, 1, false, from, 2 * Math.PI / SECTORS);
    geometry.rotateX(Math.PI / 2);
    group.add(new Mesh(geometry, paint(i === 0 ? colours.mark : colours.body[i % 2], rest)));
  }
  return group;
}

/** A cuboid, one pair of faces marked. */
function makeCuboid({ edges }, colours, rest) {
  const geometry = new BoxGeometry(...edges);
  const [even, odd] = colours.body;
  const faces = [colours.mark, even, odd, odd, even, even].map((colour) => paint(colour, rest));
  const lines = new LineSegments(
    new EdgesGeometry(geometry),
    new LineBasicMaterial({ color: colours.ink }),
  );
  return new Group().add(new Mesh(geometry, faces), lines);
}

/** How far a body reaches from the pivot, m. */
export function reachOf({ centre, solid }) {
  const length = Math.hypot(...centre);
  if (solid.kind === "cylinder") return Math.hypot(length + solid.height / 2, solid.radius);
  return length + girthOf({ solid }) || 1;
}

/** How far a body reaches from its centre of mass, m. */
export function girthOf({ solid }) {
  if (solid.kind === "cylinder") return Math.hypot(solid.height / 2, solid.radius);
  return solid.kind === "cuboid" ? Math.hypot(...solid.edges) / 2 : 0;
}

/** How far the tip of the axis is from the pivot, m: where the axis leaves the body, and a bit. */
export function tipOf({ centre, solid }) {
  const length = Math.hypot(...centre);
  const extent = { cylinder: solid.height / 2, cuboid: Math.max(...(solid.edges ?? [0])) / 2 };
  return 1.06 * (length + (extent[solid.kind] ?? 0)) || 1;
}

/** The body in its own axes. */
export function makeBody(body, colours) {
  const group = new Group();
  const centre = new Vector3(...body.centre);
  const reach = reachOf(body);
  const axis = new Vector3(...body.axis).multiplyScalar(tipOf(body));
  const metal = paint(colours.rod, { metalness: 0.5 });
  group.add(makeRod(axis, 0.012 * reach, metal));
  const knob = new Mesh(new SphereGeometry(0.024 * reach, 24, 16), metal);
  knob.position.copy(axis);
  group.add(knob);
  const { solid } = body;
  if (solid.kind === "none") return group;
  const around = solid.kind === "cuboid" && centre.length() < Math.min(...solid.edges) / 2;
  const rest = around ? { transparent: true, opacity: 0.72 } : {};
  const made = (solid.kind === "cylinder" ? makeCylinder : makeCuboid)(solid, colours, rest);
  const [x, y, z] = [0, 3, 6].map((i) => new Vector3().fromArray(solid.axes, i));
  made.quaternion.copy(new Quaternion().setFromRotationMatrix(new Matrix4().makeBasis(x, y, z)));
  made.position.copy(centre);
  return group.add(made);
}
