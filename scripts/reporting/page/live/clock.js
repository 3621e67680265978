// The time of a live top: it plays from the start to the end of the span, again and again.

const LONGEST = 0.1; // s that a frame may take before the motion slows down

export class Clock {
  #last = null; // when the last frame was, ms
  time = 0;
  span = 1;
  speed = 1; // seconds of motion a second
  playing = false;

  play() {
    this.playing = true;
    this.#last = null;
  }

  pause() {
    this.playing = false;
  }

  /** A frame of the screen, at a time in ms; whether the end was reached, and the start is next. */
  tick(now) {
    if (!this.playing) return false;
    const passed = this.#last === null ? 0 : Math.min(Math.max(0, now - this.#last) / 1000, LONGEST);
    this.#last = now;
    this.time += passed * this.speed;
    if (this.time < this.span) return false;
    this.time = 0;
    return true;
  }
}
