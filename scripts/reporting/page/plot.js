// A plot on a canvas: lines over time, and a mark at the present that moves without drawing anew.

import { extremesOf } from "./dynamics/numbers.js";
import { coloursOf } from "./stage/stage.js";
import { minus } from "./text.js";

const FULL = { left: 46, right: 16, top: 8, bottom: 22 }; // margins with axes
const BARE = { left: 0, right: 0, top: 4, bottom: 4 };
const TICKS = [1, 2, 2.5, 5, 10];
const COLOURS = ["rule", "quiet", "ink", "trace", "momentum", "kinetic", "potential"];
let colours = null; // to ask for them costs as much as to draw a plot

/** Have the colours of the page asked for again, which may have become dark. */
export function forgetColours() {
  colours = null;
}

/** Round numbers between two values, about so many. */
function ticksOf(low, high, wanted) {
  const rough = (high - low) / wanted;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * TICKS.find((digit) => digit * power >= rough * 0.999);
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1) ticks.push(k * step);
  const decimals = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9) + (step / power === 2.5 ? 1 : 0));
  return ticks.map((value) => ({ value, text: textOf(value, decimals) }));
}

function textOf(value, decimals) {
  const text = Math.abs(value) >= 1e5 || decimals > 5 ? value.toExponential(1) : value.toFixed(decimals);
  return Number(text) === 0 ? "0" : minus(text);
}

/** The least and the largest of some columns, with a little room. */
function rangeOf(columns, least) {
  const [low, high] = extremesOf(columns.flatMap(extremesOf));
  const middle = (low + high) / 2;
  const half = Math.max((high - low) / 2, least * Math.max(1, Math.abs(middle)));
  return [middle - 1.08 * half, middle + 1.08 * half];
}

export class Plot {
  /** @param pane the element that holds it @param onPick called with the time where one points @param isBare without axes */
  constructor(pane, onPick, { isBare = false } = {}) {
    this.pane = pane;
    this.margin = isBare ? BARE : FULL;
    this.isBare = isBare;
    this.canvas = Object.assign(document.createElement("canvas"), { ariaHidden: "true" });
    this.mark = Object.assign(document.createElement("i"), { className: "cursor" });
    pane.append(this.canvas, this.mark);
    this.pen = this.canvas.getContext("2d");
    const pick = (event) => {
      if (event.buttons === 1) onPick(this.at(event.clientX));
    };
    pane.addEventListener("pointerdown", (event) => {
      pane.setPointerCapture(event.pointerId);
      pick(event);
    });
    pane.addEventListener("pointermove", pick);
    new ResizeObserver(() => this.redraw()).observe(pane);
  }

  /**
   * Draw lines over a span of time.
   *
   * @param lines of each times `t`, `values`, and `colour`, a name of the style sheet; `width`, `dash`
   * @param range the values at bottom and top; else those of the lines, with at `least` so large a part of room
   */
  draw(span, lines, { range = null, least = 1e-6 } = {}) {
    this.drawn = { span, lines, range: range ?? rangeOf(lines.map(({ values }) => values), least) };
    this.redraw();
  }

  redraw() {
    if (!this.drawn || !this.pane.clientWidth) return;
    const { pen, margin, drawn: { span: [x0, x1], range: [y0, y1], lines } } = this;
    colours ??= coloursOf(this.pane, Object.fromEntries(COLOURS.map((name) => [name, name])));
    const ratio = Math.min(globalThis.devicePixelRatio, 2);
    [this.width, this.height] = [this.pane.clientWidth, this.pane.clientHeight];
    this.canvas.width = Math.round(this.width * ratio); // which empties it
    this.canvas.height = Math.round(this.height * ratio);
    this.perX = (this.width - margin.left - margin.right) / (x1 - x0);
    this.perY = (this.height - margin.top - margin.bottom) / (y1 - y0);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    if (!this.isBare) this.#drawAxes([x0, x1], [y0, y1]);
    pen.save();
    pen.beginPath();
    pen.rect(margin.left, margin.top - 1, this.width - margin.left - margin.right, this.height - margin.top - margin.bottom + 2);
    pen.clip();
    for (const line of lines) this.#drawLine(line);
    pen.restore();
    this.place(this.time ?? x0);
  }

  #drawAxes(xs, ys) {
    const { pen, width, height, margin } = this;
    Object.assign(pen, {
      font: "11px system-ui, sans-serif", lineWidth: 1, strokeStyle: colours.rule, fillStyle: colours.quiet,
      textBaseline: "middle", textAlign: "right",
    });
    pen.beginPath();
    for (const { value, text } of ticksOf(...ys, Math.max(2, height / 34))) {
      const y = Math.round(this.y(value)) + 0.5;
      pen.moveTo(margin.left, y);
      pen.lineTo(width - margin.right, y);
      pen.fillText(text, margin.left - 6, y);
    }
    Object.assign(pen, { textAlign: "center", textBaseline: "top" });
    for (const { value, text } of ticksOf(...xs, Math.max(2, width / 75))) {
      const x = Math.round(this.x(value)) + 0.5;
      pen.moveTo(x, margin.top);
      pen.lineTo(x, height - margin.bottom);
      pen.fillText(text, x, height - margin.bottom + 6);
    }
    pen.stroke();
  }

  x(value) {
    return this.margin.left + (value - this.drawn.span[0]) * this.perX;
  }

  y(value) {
    return this.height - this.margin.bottom - (value - this.drawn.range[0]) * this.perY;
  }

  #drawLine({ t, values, colour, width = 1.6, dash = [] }) {
    const { pen } = this;
    Object.assign(pen, { strokeStyle: colours[colour], lineWidth: width, lineJoin: "round" });
    pen.setLineDash(dash);
    pen.beginPath();
    for (let i = 0; i < t.length; i += 1) pen.lineTo(this.x(t[i]), this.y(values[i]));
    pen.stroke();
  }

  /** Move the mark to a time. */
  place(time) {
    this.time = time;
    if (!this.perX) return;
    const x = Math.min(Math.max(this.x(time), this.margin.left), this.width - this.margin.right);
    this.mark.style.transform = `translate(${x}px, ${this.margin.top}px)`;
  }

  /** The time at a place on the screen. */
  at(clientX) {
    return this.drawn.span[0] + (clientX - this.pane.getBoundingClientRect().left - this.margin.left) / this.perX;
  }
}
