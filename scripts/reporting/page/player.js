// Time: playing, pausing, going to a row. Knows nothing of the page.

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

export class Player extends EventTarget {
  #last = null; // when the last frame was, ms

  /** @param motion what is played @param speed seconds of motion a second */
  constructor(motion, speed) {
    super();
    this.motion = motion;
    this.speed = speed;
    this.time = motion.start;
    this.playing = false;
  }

  #say(what) {
    this.dispatchEvent(new Event(what));
  }

  /** From here on, or from the start again where it has come to its end. */
  play() {
    if (this.time >= this.motion.end) this.time = this.motion.start;
    this.playing = true;
    this.#last = null;
    this.#say("play");
  }

  pause() {
    if (!this.playing) return;
    this.playing = false;
    this.#say("pause");
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  /** A frame of the screen, at a time in ms; moves on by what has passed since the one before. */
  tick(now) {
    if (!this.playing) return;
    const passed = this.#last === null ? 0 : Math.max(0, now - this.#last) / 1000;
    this.#last = now;
    this.time = Math.min(this.time + passed * this.speed, this.motion.end);
    this.#say("time");
    if (this.time >= this.motion.end) this.pause();
  }

  /** Pauses at a row; one before the first or after the last is the first or the last. */
  goToRow(row) {
    this.pause();
    this.time = this.motion.t[Math.min(Math.max(row, 0), this.motion.count - 1)];
    this.#say("time");
  }

  /** Pauses so many rows further on, or back; between rows the next row counts as one. */
  step(rows) {
    const row = this.motion.rowBefore(this.time);
    const isBetween = this.motion.t[row] !== this.time;
    this.goToRow(row + rows + (isBetween && rows < 0 ? 1 : 0));
  }
}
