// A plot on a canvas: axes, lines, and a mark that moves over it without drawing anew.

import { extremesOf } from "../plot.js";
import { minus } from "../text.js";

const MARGIN = { left: 46, right: 10, top: 8, bottom: 22 };
const FONT = "11px system-ui, sans-serif";
const TICKS = [1, 2, 2.5, 5, 10];

/** Round numbers between two values, about so many. */
export function ticksOf(low, high, wanted) {
  const rough = (high - low) / wanted;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * TICKS.find((digit) => digit * power >= rough * 0.999);
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1) ticks.push(k * step);
  const decimals = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9) + (step / power === 2.5 ? 1 : 0));
  return ticks.map((value) => ({ value, text: textOf(value, decimals) }));
}

function textOf(value, decimals) {
  const size = Math.abs(value);
  const text = size >= 1e5 || decimals > 5 ? value.toExponential(1) : value.toFixed(decimals);
  return Number(text) === 0 ? "0" : minus(text);
}

/** The least and the largest of some columns, with a little room. */
export function rangeOf(columns, least = 1e-6) {
  const [low, high] = extremesOf(columns.flatMap(extremesOf));
  const middle = (low + high) / 2;
  const half = Math.max((high - low) / 2, least * Math.max(1, Math.abs(middle)));
  return [middle - 1.08 * half, middle + 1.08 * half];
}

export class Plot {
  /** @param pane the element that holds the canvas */
  constructor(pane) {
    this.pane = pane;
    this.canvas = Object.assign(document.createElement("canvas"), { ariaHidden: "true" });
    this.mark = document.createElement("i");
    this.mark.className = pane.dataset.mark;
    pane.append(this.canvas, this.mark);
    this.pen = this.canvas.getContext("2d");
    this.resize();
  }

  resize() {
    const ratio = Math.min(globalThis.devicePixelRatio, 2);
    this.width = this.pane.clientWidth;
    this.height = this.pane.clientHeight;
    this.canvas.width = Math.round(this.width * ratio);
    this.canvas.height = Math.round(this.height * ratio);
    this.ratio = ratio;
  }

  /** Empty axes over these ranges. */
  begin([x0, x1], [y0, y1], colours) {
    const { pen, width, height, ratio } = this;
    Object.assign(this, { colours, x0, y0 });
    this.perX = (width - MARGIN.left - MARGIN.right) / (x1 - x0);
    this.perY = (height - MARGIN.top - MARGIN.bottom) / (y1 - y0);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = FONT;
    pen.lineWidth = 1;
    pen.strokeStyle = colours.rule;
    pen.fillStyle = colours.quiet;
    pen.textBaseline = "middle";
    pen.textAlign = "right";
    pen.beginPath();
    for (const { value, text } of ticksOf(y0, y1, Math.max(2, height / 34))) {
      const y = Math.round(this.y(value)) + 0.5;
      pen.moveTo(MARGIN.left, y);
      pen.lineTo(width - MARGIN.right, y);
      pen.fillText(text, MARGIN.left - 6, y);
    }
    pen.textAlign = "center";
    pen.textBaseline = "top";
    for (const { value, text } of ticksOf(x0, x1, Math.max(2, width / 75))) {
      const x = Math.round(this.x(value)) + 0.5;
      pen.moveTo(x, MARGIN.top);
      pen.lineTo(x, height - MARGIN.bottom);
      pen.fillText(text, x, height - MARGIN.bottom + 6);
    }
    pen.stroke();
    pen.save();
    pen.beginPath();
    pen.rect(MARGIN.left, MARGIN.top - 1, width - MARGIN.left - MARGIN.right, height - MARGIN.top - MARGIN.bottom + 2);
    pen.clip();
  }

  end() {
    this.pen.restore();
  }

  x(value) {
    return MARGIN.left + (value - this.x0) * this.perX;
  }

  y(value) {
    return this.height - MARGIN.bottom - (value - this.y0) * this.perY;
  }

  /** A line through points; it is broken where a value is not finite. */
  line(xs, ys, colour, width = 1.6, dash = []) {
    const { pen } = this;
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.lineJoin = "round";
    pen.setLineDash(dash);
    pen.beginPath();
    let isDown = false;
    for (let i = 0; i < xs.length; i += 1) {
      const y = ys[i];
      if (!Number.isFinite(y)) {
        isDown = false;
        continue;
      }
      const [px, py] = [this.x(xs[i]), Math.min(Math.max(this.y(y), -1e4), 1e4)];
      if (isDown) pen.lineTo(px, py);
      else pen.moveTo(px, py);
      isDown = true;
    }
    pen.stroke();
    pen.setLineDash([]);
  }

  /** Move the mark: to an abscissa, or to a point. */
  place(x, y = null) {
    const px = Math.min(Math.max(this.x(x), MARGIN.left), this.width - MARGIN.right);
    const py = y === null ? MARGIN.top : Math.min(Math.max(this.y(y), MARGIN.top), this.height - MARGIN.bottom);
    this.mark.style.transform = `translate(${px}px, ${py}px)`;
  }

  /** The abscissa at a place on the screen. */
  at(clientX) {
    return this.x0 + (clientX - this.pane.getBoundingClientRect().left - MARGIN.left) / this.perX;
  }
}
