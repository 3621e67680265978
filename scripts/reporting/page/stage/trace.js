// The way of the axis tip up to the present: the older, the fainter. What is to come is not drawn.

import { Color, InstancedInterleavedBuffer, InterleavedBufferAttribute } from "three";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { countUpTo } from "../dynamics/numbers.js";

/** How strong a trace is at an age, as a part of the whole duration: 1 now, FAINTEST long ago. */
const FAINTEST = 0.5;
const FADES_IN = 0.12; // of the duration: the age at which most of its strength is gone
const FADE = `
  if (vColor.r > now) discard;
  float strength = ${FAINTEST} + ${1 - FAINTEST} * exp(-(now - vColor.r) / ${FADES_IN});
  diffuseColor.rgb = mix(ground, diffuseColor.rgb, strength);
`;

/** A material that fades with age; the red part of a vertex' colour is its time, 0 to 1. */
function fadingMaterial(color, ground, linewidth, now) {
  const material = new LineMaterial({ color, linewidth, vertexColors: true, transparent: true });
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, { now, ground: { value: new Color(ground) } });
    shader.fragmentShader = `uniform float now;\nuniform vec3 ground;\n${shader.fragmentShader}`.replace(
      "#include <color_fragment>",
      FADE,
    );
  };
  return material;
}

export class Trace extends Line2 {
  /**
   * @param trace times, and unit vectors side by side @param tip metres from the pivot to the tip
   * @param look colour, ground and width in pixels
   */
  constructor(trace, tip, { colour, ground, width }) {
    const now = { value: 0 };
    super(new LineGeometry(), fadingMaterial(colour, ground, width, now));
    Object.assign(this, { tip, now, renderOrder: 5, frustumCulled: false }); // above the body
    this.setPath(trace);
  }

  /** Another path of the tip. */
  setPath({ times, points }) {
    const [start, end] = [times[0], times[times.length - 1]];
    this.times = times;
    this.partOf = (time) => (end > start ? (time - start) / (end - start) : 0);
    const ways = new Float32Array(points).map((value) => value * this.tip);
    this.geometry.dispose(); // of the path before
    this.geometry.setPositions(times.length > 1 ? ways : [0, 0, 0, 0, 0, 0]);
    const pieces = Math.max(times.length - 1, 1);
    const parts = new Float32Array(6 * pieces); // of a piece the times of its ends, each as a colour
    for (let i = 0; i + 1 < times.length; i += 1) {
      [parts[6 * i], parts[6 * i + 3]] = [this.partOf(times[i]), this.partOf(times[i + 1])];
    }
    const buffer = new InstancedInterleavedBuffer(parts, 6, 1);
    this.geometry.setAttribute("instanceColorStart", new InterleavedBufferAttribute(buffer, 3, 0));
    this.geometry.setAttribute("instanceColorEnd", new InterleavedBufferAttribute(buffer, 3, 3));
  }

  /** Up to a time. */
  show(time) {
    this.now.value = this.partOf(time);
    this.geometry.instanceCount = countUpTo(this.times, time); // pieces; of the last one the shader leaves out a part
  }
}
