// Lines against time as SVG, with a mark at the present: the least and largest value of each column of
// pixels are drawn, so that nothing is lost.

const SPACE = "http://www.w3.org/2000/svg";
const WIDTH = 1000;
const HEIGHT = 100;
const MARGIN = 6;
const COLUMNS = 700; // a line has two points for each at most

/** An element of SVG. */
function element(name, attributes) {
  const made = document.createElementNS(SPACE, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

/** The least and the largest of numbers; nan is none. */
export function extremesOf(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return [low, high];
}

/** The places to draw: of each column of pixels those of its least and its largest value, in order. */
function placesOf(values) {
  const bin = Math.max(1, Math.ceil(values.length / COLUMNS));
  const places = [];
  for (let first = 0; first < values.length; first += bin) {
    let [least, most] = [first, first];
    for (let i = first; i < Math.min(first + bin, values.length); i += 1) {
      if (values[i] < values[least]) least = i;
      if (values[i] > values[most]) most = i;
    }
    for (const i of new Set([Math.min(least, most), Math.max(least, most)])) places.push(i);
  }
  return places;
}

export class Plot {
  /** Called with the time where one points. */
  onPick = () => {};

  /**
   * @param svg where to draw @param times of the values, ascending
   * @param lines of each its `values` and its `name`, a class of the style sheet
   * @param span the times at both ends @param range the values at bottom and top, else the extremes
   */
  constructor(svg, times, lines, { span, range = null }) {
    this.span = span;
    this.range = range ?? extremesOf(lines.flatMap(({ values }) => extremesOf(values)));
    this.cursor = element("line", { class: "cursor", y1: 0, y2: HEIGHT });
    svg.setAttribute("viewBox", `0 0 ${WIDTH} ${HEIGHT}`);
    svg.replaceChildren(
      ...lines.map(({ name, values }) =>
        element("polyline", { class: name, points: this.#points(times, values) })),
      this.cursor,
    );
    const pick = (event) => {
      if (event.buttons !== 1) return;
      const { left, width } = svg.getBoundingClientRect();
      const [start, end] = this.span;
      this.onPick(start + ((event.clientX - left) / width) * (end - start));
    };
    svg.onpointerdown = pick;
    svg.onpointermove = pick;
  }

  #points(times, values) {
    const [low, high] = this.range;
    const flat = !(high - low > 1e-12 * Math.max(Math.abs(low), Math.abs(high)));
    const y = (value) => {
      const part = flat ? 0.5 : (value - low) / (high - low);
      return (HEIGHT - MARGIN - part * (HEIGHT - 2 * MARGIN)).toFixed(1);
    };
    return placesOf(values).map((i) => `${this.#x(times[i])},${y(values[i])}`).join(" ");
  }

  #x(time) {
    const [start, end] = this.span;
    return ((WIDTH * (time - start)) / (end - start)).toFixed(1);
  }

  /** Move the mark to a time. */
  mark(time) {
    this.cursor.setAttribute("x1", this.#x(time));
    this.cursor.setAttribute("x2", this.#x(time));
  }
}
