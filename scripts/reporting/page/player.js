// Time: playing, pausing, going to an instant. Knows nothing of the page.

const LONGEST = 0.1; // s that a frame may take before an endless motion slows down

/** The speeds to choose from, in seconds of motion a second, and the one to begin with. */
export function speedsFor(duration) {
  const speeds = [];
  for (let power = Math.floor(Math.log10(duration)) - 3; speeds.length < 13; power += 1) {
    speeds.push(...[1, 2, 5].map((digit) => Number(`${digit}e${power}`)));
  }
  const usable = speeds.filter((speed) => duration / speed >= 1 && duration / speed <= 1000);
  const near = (speed) => Math.abs(Math.log(speed));
  const pleasant = usable.filter((speed) => duration / speed >= 5 && duration / speed <= 30);
  const initial = pleasant.reduce((best, speed) => (near(speed) < near(best) ? speed : best));
  return { speeds: usable, initial };
}

export class Player {
  #last = null; // when the last frame was, ms
  speed = 1; // seconds of motion a second
  playing = false;

  /** @param onChange called when it has begun or ended to play, or gone elsewhere @param isEndless begins again and again */
  constructor(start, end, onChange, { isEndless = false } = {}) {
    Object.assign(this, { start, end, onChange, isEndless, time: start });
  }

  /** From here on, or from the start again where it has come to its end. */
  play() {
    if (this.time >= this.end) this.time = this.start;
    this.playing = true;
    this.#last = null;
    this.onChange();
  }

  pause() {
    this.playing = false;
    this.onChange();
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  /** Pause at an instant, or at the end that is nearest to it. */
  seek(time) {
    this.time = Math.min(Math.max(time, this.start), this.end);
    this.pause();
  }

  /** A frame of the screen, at a time in ms; moves on by what has passed since the one before. */
  tick(now) {
    if (!this.playing) return;
    const passed = this.#last === null ? 0 : Math.max(0, now - this.#last) / 1000;
    this.#last = now;
    this.time += (this.isEndless ? Math.min(passed, LONGEST) : passed) * this.speed;
    if (this.time < this.end) return;
    if (this.isEndless) this.time = this.start;
    else this.seek(this.end);
  }
}
