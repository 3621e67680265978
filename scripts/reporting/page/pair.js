// Two motions of one scene: the angles between them.

import { Quaternion, Vector3 } from "three";

const MOST = 4000; // points of a series

/** The angle of the turn from one attitude to another, rad; exact also where it is small. */
export function angleBetween(one, other) {
  const { x, y, z, w } = new Quaternion().copy(one).conjugate().multiply(other);
  return 2 * Math.atan2(Math.hypot(x, y, z), Math.abs(w));
}

/** The angle between two vectors, rad; exact also where it is small. */
export function angleOf(one, other) {
  return Math.atan2(new Vector3().crossVectors(one, other).length(), one.dot(other));
}

export class Pair {
  /** @param motion the one whose rows are taken @param other the one it is compared with */
  constructor(motion, other) {
    this.motion = motion;
    this.other = other;
    this.start = Math.max(motion.start, other.start);
    this.end = Math.min(motion.end, other.end);
  }

  /** The moment of the other motion that belongs to a time: its first or last one outside its span. */
  otherAt(time) {
    return this.other.at(Math.min(Math.max(time, this.other.start), this.other.end));
  }

  /** The angles between the attitudes and between the axes of the bodies at a moment, rad. */
  anglesAt({ time, attitude }) {
    const other = this.otherAt(time).attitude;
    return [angleBetween(attitude, other), angleOf(this.motion.axisOf(attitude), this.other.axisOf(other))];
  }

  /**
   * The angles against time at the rows of the motion, of attitudes and of axes; and whether all of
   * them are rows of the other motion too, which is else interpolated.
   */
  series() {
    const { motion, start, end } = this;
    const stride = Math.ceil(motion.count / MOST);
    const times = [...motion.t].filter((time, row) => row % stride === 0 && time >= start && time <= end);
    const moments = times.map((time) => motion.at(time));
    const angles = moments.map((moment) => this.anglesAt(moment));
    const hasRows = times.every((time) => this.otherAt(time).row !== null);
    return { times, attitudes: angles.map(([attitude]) => attitude), axes: angles.map(([, axis]) => axis), hasRows };
  }
}
