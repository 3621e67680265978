// The way of the axis tip up to the present: the older, the fainter. What is to come is not drawn.

import { Color, Group, InstancedInterleavedBuffer, InterleavedBufferAttribute } from "three";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";

/** How strong a trace is at an age, as a part of the whole duration: 1 now, FAINTEST long ago. */
export const FAINTEST = 0.5;
export const FADES_IN = 0.12; // of the duration: the age at which most of its strength is gone

export function strengthAt(age) {
  return FAINTEST + (1 - FAINTEST) * Math.exp(-age / FADES_IN);
}

const FADE = `
  float strength = ${FAINTEST} + ${1 - FAINTEST} * exp(-max(now - vColor.r, 0.0) / ${FADES_IN});
  diffuseColor.rgb = mix(ground, diffuseColor.rgb, strength);
`;

/** How many of ascending times are not later than a time. */
export function countUpTo(times, time) {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = Math.floor((low + high) / 2);
    if (times[middle] <= time) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** A material that fades with age; the red part of a vertex' colour is its time, 0 to 1. */
function fadingMaterial(colour, ground, width, uniforms) {
  const material = new LineMaterial({ color: colour, linewidth: width, vertexColors: true, transparent: true });
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms, { ground: { value: new Color(ground) } });
    shader.fragmentShader = `uniform float now;\nuniform vec3 ground;\n${shader.fragmentShader}`.replace(
      "#include <color_fragment>",
      FADE,
    );
  };
  return material;
}

/** Give every piece of a line the times of its ends. */
function setTimes(geometry, parts) {
  const values = new Float32Array(6 * (parts.length - 1));
  for (let i = 0; i + 1 < parts.length; i += 1) {
    values[6 * i] = parts[i];
    values[6 * i + 3] = parts[i + 1];
  }
  const buffer = new InstancedInterleavedBuffer(values, 6, 1);
  geometry.setAttribute("instanceColorStart", new InterleavedBufferAttribute(buffer, 3, 0));
  geometry.setAttribute("instanceColorEnd", new InterleavedBufferAttribute(buffer, 3, 3));
}

export class Trace extends Group {
  /**
   * @param trace times, and unit vectors side by side @param tip metres from the pivot to the tip
   * @param look colour, ground and width in pixels
   */
  constructor(trace, tip, { colour, ground, width }) {
    super();
    this.tip = tip;
    this.now = { value: 0 };
    const material = fadingMaterial(colour, ground, width, { now: this.now });
    this.past = new Line2(new LineGeometry(), material);
    this.setPath(trace);
    this.last = new Line2(new LineGeometry().setPositions([0, 0, 0, 0, 0, 0]), material);
    setTimes(this.last.geometry, [1, 1]);
    this.add(this.past, this.last);
    for (const line of this.children) {
      line.renderOrder = 5; // above the body
      line.frustumCulled = false;
    }
  }

  /** Another path of the tip. */
  setPath({ times, points }) {
    this.times = times;
    this.points = new Float32Array(points).map((value) => value * this.tip);
    const [start, end] = [times[0], times[times.length - 1]];
    this.partOf = (time) => (end > start ? (time - start) / (end - start) : 0);
    this.past.geometry.dispose(); // of the path before
    this.past.geometry.setPositions(times.length > 1 ? this.points : [0, 0, 0, 0, 0, 0]);
    setTimes(this.past.geometry, times.length > 1 ? new Float64Array(times).map(this.partOf) : [0, 0]);
  }

  /** Up to a time, at which the axis is a unit vector. */
  show(time, axis) {
    const count = countUpTo(this.times, time);
    this.now.value = this.partOf(time);
    this.past.geometry.instanceCount = Math.max(0, count - 1);
    this.past.visible = count > 1;
    this.last.visible = count > 0;
    if (!count) return;
    const ends = this.last.geometry.attributes.instanceStart.data;
    ends.array.set(this.points.subarray(3 * (count - 1), 3 * count));
    ends.array.set([axis.x * this.tip, axis.y * this.tip, axis.z * this.tip], 3);
    ends.needsUpdate = true;
  }
}
