// Bodies and arrows as three.js draws them.
//
// A body has `axis` (a unit vector), `centre`, and `solids`. A solid has a kind, its extents in metres, `place` (its
// centre of mass) and `axes` (its own x, y, z as rows), both in body axes:
//
//   cylinder   radius, height                 ring     radius, inner, height
//   cone       radius, height; apex below     sphere   radius
//   cuboid     edges

import * as THREE from "three";

const SECTORS = 8; // by which one sees a solid of revolution turn
const STEPS = 12; // of a sector
const ARC = 24; // pieces of half a circle
const SHARP = 30; // degrees between faces with an edge
const TURN = 2 * Math.PI;
const UP = new THREE.Vector3(0, 1, 0); // the axis of three's cylinders
const SOLID = { opacity: 0.4, wire: 0.75, rod: 0.01 };
const GHOST = { opacity: 0.14, wire: 0.6, rod: 0.007 };
const HEAD = 0.1; // length of the head of an arrow, of the way from the pivot to the tip
const SHORTEST = 1e-3; // of that way: shorter vectors are not drawn

/** Radius and height along the edge of a solid of revolution about its z, which is on the left of it. */
const OUTLINES = {
  cylinder: ({ radius: r, height: h }) => [[0, -h / 2], [r, -h / 2], [r, h / 2], [0, h / 2]],
  ring: ({ radius: r, inner: s, height: h }) => [[s, -h / 2], [r, -h / 2], [r, h / 2], [s, h / 2], [s, -h / 2]],
  cone: ({ radius: r, height: h }) => [[0, -0.75 * h], [r, h / 4], [0, h / 4]],
  sphere: ({ radius: r }) => Array.from({ length: ARC + 1 }, (_, i) => {
    const angle = (Math.PI * i) / ARC;
    return [i % ARC ? r * Math.sin(angle) : 0, -r * Math.cos(angle)];
  }),
};

/** The surface of a solid in its own axes, with a group for each colour: the marked one (0), even and odd ones. */
function surfaceOf(solid) {
  if (solid.kind === "cuboid") {
    const box = new THREE.BoxGeometry(...solid.edges);
    box.groups.forEach((group, side) => { group.materialIndex = side >> 1; });
    return box;
  }
  const outline = OUTLINES[solid.kind](solid).map(([radius, height]) => new THREE.Vector2(radius, height));
  // A corner that is there twice is an edge.
  const points = solid.kind === "sphere" ? outline : outline.flatMap((corner) => [corner, corner]).slice(1, -1);
  const surface = new THREE.LatheGeometry(points, SECTORS * STEPS).rotateX(Math.PI / 2);
  const count = surface.index.count / SECTORS;
  for (let i = 0; i < SECTORS; i += 1) surface.addGroup(i * count, count, i && 1 + (i % 2));
  return surface;
}

/** From a solid's own axes and centre to body axes. */
function frameOf({ axes, place }) {
  const [x, y, z] = [0, 3, 6].map((i) => new THREE.Vector3().fromArray(axes, i));
  return new THREE.Matrix4().makeBasis(x, y, z).setPosition(...place);
}

const measured = new WeakMap();

/**
 * What a body takes up, m: its `reach` from the pivot; where the `tip` of its axis is, just outside the body; and its
 * `rims`, points by their heights along the axis and their distances from it.
 */
export function measure(body) {
  if (!measured.has(body)) measured.set(body, measureAnew(body));
  return measured.get(body);
}

function measureAnew(body) {
  const axis = new THREE.Vector3(...body.axis);
  const rims = new Map();
  let [reach, top] = [Math.hypot(...body.centre), Math.hypot(...body.centre)];
  for (const solid of body.solids) {
    const places = surfaceOf(solid).applyMatrix4(frameOf(solid)).attributes.position;
    for (let i = 0; i < places.count; i += 1) {
      const point = new THREE.Vector3().fromBufferAttribute(places, i);
      const height = point.dot(axis);
      const radius = Math.sqrt(Math.max(0, point.lengthSq() - height ** 2));
      rims.set(`${height.toPrecision(4)},${radius.toPrecision(4)}`, [height, radius]);
      [reach, top] = [Math.max(reach, point.length()), Math.max(top, height)];
    }
  }
  return { reach: reach || 1, tip: 1.06 * top || 1, rims: [...rims.values()] };
}

/** A solid, translucent: what is behind it is seen through it. */
function makeSolid(solid, paints, ink, { opacity, wire }) {
  const group = new THREE.Group();
  const surface = surfaceOf(solid);
  [THREE.BackSide, THREE.FrontSide].forEach((side, order) => {
    const look = { side, opacity, transparent: true, depthWrite: false };
    const mesh = new THREE.Mesh(surface, paints.map((color) => new THREE.MeshLambertMaterial({ color, ...look })));
    mesh.renderOrder = order;
    group.add(mesh);
  });
  const pen = new THREE.LineBasicMaterial({ color: ink, transparent: true, opacity: wire, depthWrite: false });
  const lines = [new THREE.LineSegments(new THREE.EdgesGeometry(surface, SHARP), pen)];
  if (solid.kind === "sphere" || solid.kind === "cone") { // by which one sees a ghost turn
    const half = OUTLINES[solid.kind](solid).slice(0, solid.kind === "cone" ? 2 : undefined);
    for (let k = 0; k < 4; k += 1) {
      const [c, s] = [Math.cos((k * TURN) / 4), Math.sin((k * TURN) / 4)];
      const points = half.map(([radius, height]) => new THREE.Vector3(radius * c, radius * s, height));
      lines.push(new THREE.Line(new THREE.BufferGeometry().setFromPoints(points), pen));
    }
  }
  for (const line of lines) line.renderOrder = 2;
  group.add(...lines);
  group.applyMatrix4(frameOf(solid));
  return group;
}

/** A body in its own axes: rod, knob and solids; a ghost has one colour. */
export function makeBody(body, colours, isGhost = false) {
  const group = new THREE.Group();
  const { reach, tip } = measure(body);
  const look = isGhost ? GHOST : SOLID;
  const { ghost } = colours;
  const end = new THREE.Vector3(...body.axis).multiplyScalar(tip);
  const metal = new THREE.MeshLambertMaterial({ color: isGhost ? ghost : colours.rod });
  const rod = new THREE.Mesh(new THREE.CylinderGeometry(look.rod * reach, look.rod * reach, tip, 24), metal);
  rod.position.copy(end).multiplyScalar(0.5);
  rod.quaternion.setFromUnitVectors(UP, new THREE.Vector3(...body.axis));
  const knob = new THREE.Mesh(new THREE.SphereGeometry(2 * look.rod * reach, 24, 16), metal);
  knob.position.copy(end);
  group.add(rod, knob);
  const paints = isGhost ? [ghost, ghost, ghost] : [colours.mark, colours.even, colours.odd];
  for (const solid of body.solids) group.add(makeSolid(solid, paints, isGhost ? ghost : colours.ink, look));
  return group;
}

/** A vector that starts at the pivot, or at another point; it is in front of what is translucent. */
export class Arrow extends THREE.Group {
  wanted = true;

  /** @param size how far the tip is from the pivot, by which thickness and head go */
  constructor(color, size) {
    super();
    const paint = new THREE.MeshLambertMaterial({ color, transparent: true });
    this.size = size;
    this.shaft = new THREE.Mesh(new THREE.CylinderGeometry(0.014 * size, 0.014 * size, 1, 16), paint);
    this.head = new THREE.Mesh(new THREE.ConeGeometry(0.038 * size, 1, 24), paint);
    this.add(this.shaft, this.head);
    for (const part of this.children) part.renderOrder = 6; // above the body
  }

  /** Point along a vector from an origin (m), so many metres for a unit of it; nothing is drawn for null. */
  point(vector, metres, origin) {
    const length = vector ? Math.hypot(...vector) * metres : 0;
    this.visible = this.wanted && length > SHORTEST * this.size;
    if (!this.visible) return;
    this.position.copy(origin);
    const head = Math.min(HEAD * this.size, length);
    const shaft = Math.max(length - head, 1e-6 * this.size);
    this.shaft.scale.y = shaft;
    this.shaft.position.y = shaft / 2;
    this.head.scale.y = head;
    this.head.position.y = length - head / 2;
    this.quaternion.setFromUnitVectors(UP, new THREE.Vector3(...vector).normalize());
  }
}
