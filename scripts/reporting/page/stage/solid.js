// The solids that bodies are drawn as. A solid has a kind, its extents in metres, `place` (its
// centre of mass) and `axes` (its own x, y, z as rows), both in body axes:
//
//   cylinder   radius, height                 ring       radius, inner, height
//   cone       radius, height; apex below     sphere     radius
//   cuboid     edges                          ellipsoid  semiaxes

import { Matrix4, Vector2, Vector3 } from "three";

const TURN = 2 * Math.PI;
const ARC = 24; // pieces of half a circle
const CIRCLE = 72;
const MERIDIANS = 4; // that are drawn of a solid of revolution

/** Half a circle from the lowest point to the highest: radius and height. */
function arc(radius) {
  return Array.from({ length: ARC + 1 }, (_, i) => {
    const angle = (Math.PI * i) / ARC;
    return new Vector2(i % ARC ? radius * Math.sin(angle) : 0, -radius * Math.cos(angle));
  });
}

/** Pieces of an outline through these points, with edges between them. */
function edged(...points) {
  const corners = points.map(([radius, height]) => new Vector2(radius, height));
  return corners.slice(1).map((corner, i) => [corners[i], corner]);
}

const OUTLINES = {
  cylinder: ({ radius: r, height: h }) => edged([0, -h / 2], [r, -h / 2], [r, h / 2], [0, h / 2]),
  ring: ({ radius: r, inner: s, height: h }) =>
    edged([s, -h / 2], [r, -h / 2], [r, h / 2], [s, h / 2], [s, -h / 2]),
  cone: ({ radius: r, height: h }) => edged([0, -0.75 * h], [r, h / 4], [0, h / 4]),
  sphere: ({ radius }) => [arc(radius)],
};

/**
 * The outline of a solid of revolution about its z: smooth pieces, each of points (radius, height)
 * with the solid on their left; null for another solid.
 */
export function outlineOf(solid) {
  return OUTLINES[solid.kind]?.(solid) ?? null;
}

/** From a solid's own axes and centre to body axes. */
export function frameOf({ axes, place }) {
  const [x, y, z] = [0, 3, 6].map((i) => new Vector3().fromArray(axes, i));
  return new Matrix4().makeBasis(x, y, z).setPosition(...place);
}

function circle(point) {
  return Array.from({ length: CIRCLE + 1 }, (_, i) => point((TURN * i) / CIRCLE));
}

/** Edges and outlines of a cuboid. */
function wiresOfCuboid({ edges }) {
  const [x, y, z] = edges.map((edge) => edge / 2);
  const face = (h) => [[x, y], [-x, y], [-x, -y], [x, -y], [x, y]].map(([a, b]) => new Vector3(a, b, h));
  const posts = face(-z).slice(0, 4).map((low) => [low, low.clone().setZ(z)]);
  return [face(-z), face(z), ...posts];
}

/** Lines by which a solid is recognized, through points in its own axes. */
export function wiresOf(solid) {
  if (solid.kind === "cuboid") return wiresOfCuboid(solid);
  if (solid.kind === "ellipsoid") {
    const [a, b, c] = solid.semiaxes;
    return [
      circle((t) => new Vector3(a * Math.cos(t), b * Math.sin(t), 0)),
      circle((t) => new Vector3(0, b * Math.cos(t), c * Math.sin(t))),
      circle((t) => new Vector3(a * Math.cos(t), 0, c * Math.sin(t))),
    ];
  }
  const pieces = outlineOf(solid) ?? [];
  const corners = pieces.flatMap((piece) => (piece.length > 2 ? [piece[ARC / 2]] : piece));
  const rings = new Map(corners.filter(({ x }) => x > 0).map((corner) => [`${corner.x},${corner.y}`, corner]));
  const circles = [...rings.values()].map(({ x: r, y: h }) =>
    circle((t) => new Vector3(r * Math.cos(t), r * Math.sin(t), h)));
  if (solid.kind !== "sphere" && solid.kind !== "cone") return circles;
  const [way] = pieces;
  const meridians = Array.from({ length: MERIDIANS }, (_, i) => {
    const angle = (TURN * i) / MERIDIANS;
    return way.map(({ x: r, y: h }) => new Vector3(r * Math.cos(angle), r * Math.sin(angle), h));
  });
  return [...circles, ...meridians];
}

/** The points of the wires of all solids of a body, in body axes. */
function* pointsOf(body) {
  for (const solid of body.solids) {
    const frame = frameOf(solid);
    for (const wire of wiresOf(solid)) {
      for (const point of wire) yield point.clone().applyMatrix4(frame);
    }
  }
}

/** How far a body reaches from the pivot, m. */
export function reachOf(body) {
  let reach = Math.hypot(...body.centre);
  for (const point of pointsOf(body)) reach = Math.max(reach, point.length());
  return reach || 1;
}

/** The points of a body, in its axes, by their heights along its axis and distances from it, m. */
export function rimsOf(body) {
  const axis = new Vector3(...body.axis);
  const rims = new Map();
  for (const point of pointsOf(body)) {
    const height = point.dot(axis);
    const radius = Math.sqrt(Math.max(0, point.lengthSq() - height ** 2));
    rims.set(`${height.toPrecision(4)},${radius.toPrecision(4)}`, [height, radius]);
  }
  return [...rims.values()];
}

const tips = new WeakMap();

/** How far the tip of the axis is from the pivot, m: where the axis leaves the body, and a bit. */
export function tipOf(body) {
  if (!tips.has(body)) tips.set(body, findTip(body));
  return tips.get(body);
}

function findTip(body) {
  const axis = new Vector3(...body.axis);
  let height = Math.hypot(...body.centre);
  for (const point of pointsOf(body)) height = Math.max(height, point.dot(axis));
  return 1.06 * height || 1;
}
