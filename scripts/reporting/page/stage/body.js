// A body as three.js draws it: rod, translucent solids, and marks by which one sees it turn.

import {
  BackSide,
  BoxGeometry,
  BufferGeometry,
  CylinderGeometry,
  FrontSide,
  Group,
  LatheGeometry,
  Line,
  LineBasicMaterial,
  Mesh,
  MeshLambertMaterial,
  SphereGeometry,
  Vector3,
} from "three";
import { mergeGeometries } from "three/addons/utils/BufferGeometryUtils.js";
import { frameOf, outlineOf, reachOf, tipOf, wiresOf } from "./solid.js";

const SECTORS = 8;
const STEPS = 12; // of a sector
const TURN = 2 * Math.PI;
const UP = new Vector3(0, 1, 0); // the axis of three's cylinders
const SOLID = { opacity: 0.4, wire: 0.75 };
const GHOST = { opacity: 0.14, wire: 0.6 };

function paint(colour, rest = {}) {
  return new MeshLambertMaterial({ color: colour, ...rest });
}

/** A rod from the pivot along a vector. */
function makeRod(vector, radius, material) {
  const rod = new Mesh(new CylinderGeometry(radius, radius, vector.length(), 24), material);
  rod.position.copy(vector).multiplyScalar(0.5);
  rod.quaternion.setFromUnitVectors(UP, vector.clone().normalize());
  return rod;
}

/** The geometries of the sectors of a solid about its z, by colour: the marked one, even, odd. */
function sectorsOf(solid) {
  const groups = [[], [], []];
  const outline = outlineOf(solid);
  for (let i = 0; i < SECTORS; i += 1) {
    const from = (TURN * i) / SECTORS;
    const group = groups[i === 0 ? 0 : 1 + (i % 2)];
    if (outline) {
      for (const piece of outline) {
        group.push(new LatheGeometry(piece, STEPS, from, TURN / SECTORS).rotateX(Math.PI / 2));
      }
    } else {
      const ball = new SphereGeometry(1, STEPS, 32, from, TURN / SECTORS).rotateX(Math.PI / 2);
      group.push(ball.scale(...solid.semiaxes));
    }
  }
  return groups.map((group) => mergeGeometries(group));
}

/** The faces of a cuboid, by colour: one pair is marked. */
function facesOf({ edges: [x, y, z] }) {
  const thin = 1e-3;
  const sides = [
    [[x * (1 + thin), y, z], 0],
    [[x, y * (1 + thin), z], 1],
    [[x, y, z * (1 + thin)], 2],
  ];
  return sides.map(([size, axis]) => {
    const box = new BoxGeometry(...size).toNonIndexed();
    const keep = new BufferGeometry();
    for (const [name, attribute] of Object.entries(box.attributes)) {
      const from = axis * 12 * attribute.itemSize; // a pair of faces has 12 corners of triangles
      keep.setAttribute(name, attribute.clone());
      const part = attribute.array.slice(from, from + 12 * attribute.itemSize);
      keep.setAttribute(name, new attribute.constructor(part, attribute.itemSize));
    }
    return keep;
  });
}

/** A solid, translucent: what is behind it is seen through it. */
function makeSolid(solid, colours, { opacity, wire }, isGhost) {
  const group = new Group();
  const geometries = solid.kind === "cuboid" ? facesOf(solid) : sectorsOf(solid);
  const [even, odd] = colours.body;
  const paints = isGhost ? [colours.ghost, colours.ghost, colours.ghost] : [colours.mark, even, odd];
  [BackSide, FrontSide].forEach((side, order) => {
    geometries.forEach((geometry, i) => {
      const look = { side, opacity, transparent: true, depthWrite: false };
      const mesh = new Mesh(geometry, paint(paints[i], look));
      mesh.renderOrder = order;
      group.add(mesh);
    });
  });
  const ink = new LineBasicMaterial({
    color: isGhost ? colours.ghost : colours.ink,
    transparent: true,
    opacity: wire,
    depthWrite: false,
  });
  for (const points of wiresOf(solid)) {
    const line = new Line(new BufferGeometry().setFromPoints(points), ink);
    line.renderOrder = 2;
    group.add(line);
  }
  group.applyMatrix4(frameOf(solid));
  return group;
}

/** A body in its own axes; a ghost has one colour. */
export function makeBody(body, colours, isGhost = false) {
  const group = new Group();
  const reach = reachOf(body);
  const axis = new Vector3(...body.axis).multiplyScalar(tipOf(body));
  const metal = paint(isGhost ? colours.ghost : colours.rod);
  group.add(makeRod(axis, (isGhost ? 0.007 : 0.01) * reach, metal));
  const knob = new Mesh(new SphereGeometry((isGhost ? 0.015 : 0.02) * reach, 24, 16), metal);
  knob.position.copy(axis);
  group.add(knob);
  for (const solid of body.solids) {
    group.add(makeSolid(solid, colours, isGhost ? GHOST : SOLID, isGhost));
  }
  return group;
}
