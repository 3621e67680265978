// A vector that starts at the pivot, or at another point; it is in front of what is translucent.

import { ConeGeometry, CylinderGeometry, Group, Mesh, MeshLambertMaterial, Vector3 } from "three";

const UP = new Vector3(0, 1, 0);
const HEAD = 0.1; // length of the head, of that
const SHORTEST = 1e-3; // of the size: shorter vectors are not drawn

export class Arrow extends Group {
  /** @param size how far the tip is from the pivot, by which thickness and head go */
  constructor(colour, size) {
    super();
    const paint = new MeshLambertMaterial({ color: colour, transparent: true });
    this.size = size;
    this.wanted = true;
    this.shaft = new Mesh(new CylinderGeometry(0.014 * size, 0.014 * size, 1, 16), paint);
    this.head = new Mesh(new ConeGeometry(0.038 * size, 1, 24), paint);
    this.add(this.shaft, this.head);
    for (const part of this.children) part.renderOrder = 6; // above the body
  }

  /** Point along a vector from an origin (m), so many metres for a unit of it; nothing is drawn for null. */
  point(vector, metres, origin) {
    const length = vector ? vector.length() * metres : 0;
    this.visible = this.wanted && length > SHORTEST * this.size;
    if (!this.visible) return;
    this.position.copy(origin);
    const head = Math.min(HEAD * this.size, length);
    const shaft = Math.max(length - head, 1e-6 * this.size);
    this.shaft.scale.y = shaft;
    this.shaft.position.y = shaft / 2;
    this.head.scale.y = head;
    this.head.position.y = length - head / 2;
    this.quaternion.setFromUnitVectors(UP, vector.clone().normalize());
  }
}
