// The inclination against time, above the slider, with a mark at the present row.

const SPACE = "http://www.w3.org/2000/svg";
const WIDTH = 1000;
const HEIGHT = 100;
const MARGIN = 6;
const COLUMNS = 700; // the line has two points for each at most

/** An element of SVG. */
function element(name, attributes) {
  const made = document.createElementNS(SPACE, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

export class Chart {
  /** Called with the row where one points. */
  onPick = () => {};

  constructor(svg, motion) {
    this.svg = svg;
    this.motion = motion;
    this.cursor = element("line", { class: "cursor", y1: 0, y2: HEIGHT });
    svg.setAttribute("viewBox", `0 0 ${WIDTH} ${HEIGHT}`);
    this.draw();
    const pick = (event) => {
      if (event.buttons !== 1) return;
      const { left, width } = svg.getBoundingClientRect();
      this.onPick(Math.round(((event.clientX - left) / width) * (motion.count - 1)));
    };
    svg.addEventListener("pointerdown", pick);
    svg.addEventListener("pointermove", pick);
  }

  draw() {
    this.svg.replaceChildren(
      element("polyline", { class: "theta", points: this.#points() }),
      this.cursor,
    );
  }

  /** Least and largest value of each column of pixels, in the order in which they come. */
  #points() {
    const theta = this.motion.angles[1];
    const low = theta.reduce((a, b) => Math.min(a, b));
    const range = theta.reduce((a, b) => Math.max(a, b)) - low;
    const y = (value) => {
      const part = range > 1e-12 ? (value - low) / range : 0.5;
      return (HEIGHT - MARGIN - part * (HEIGHT - 2 * MARGIN)).toFixed(1);
    };
    const bin = Math.max(1, Math.ceil(theta.length / COLUMNS));
    const points = [];
    for (let first = 0; first < theta.length; first += bin) {
      let [least, most] = [first, first];
      for (let i = first; i < Math.min(first + bin, theta.length); i += 1) {
        if (theta[i] < theta[least]) least = i;
        if (theta[i] > theta[most]) most = i;
      }
      for (const i of new Set([Math.min(least, most), Math.max(least, most)])) {
        points.push(`${this.#x(i)},${y(theta[i])}`);
      }
    }
    return points.join(" ");
  }

  #x(row) {
    return ((WIDTH * row) / (this.motion.count - 1)).toFixed(1);
  }

  /** Move the mark to a row. */
  mark(row) {
    this.cursor.setAttribute("x1", this.#x(row));
    this.cursor.setAttribute("x2", this.#x(row));
  }
}
