// What one keeps of a live top: a link, a picture, a film, an input.

import { inShort } from "../text.js";
import { say } from "./language.js";
import { canFilm, film, save } from "./record.js";

export const STILL = [1920, 1080]; // pixels of a picture

export class Keeper {
  #film = null;

  /** @param live the live top, whose buttons are wired */
  constructor(live) {
    this.live = live;
    const { parts } = live;
    parts.film.hidden = !canFilm();
    parts.link.hidden = !live.ownsLink;
    parts.picture.addEventListener("click", () => save(live.stage.still(...STILL), "spintop.png"));
    parts.film.addEventListener("click", () => (this.#film ? this.endFilm() : this.#beginFilm()));
    parts.link.addEventListener("click", () => this.#copy(location.href, say("copied_link")));
    parts.copy.addEventListener("click", () => this.#copy(parts.input.textContent, say("copied_input")));
  }

  #say(words) {
    this.live.parts.said.textContent = words;
  }

  /** Film the whole span from its start. */
  #beginFilm() {
    const { parts, clock } = this.live;
    clock.time = 0;
    this.#film = film(parts.stage.querySelector("canvas"));
    parts.film.textContent = say("film_stop");
    this.#say(say("filming", { seconds: inShort(clock.span / clock.speed) }));
    this.live.play();
  }

  /** Save the film that is being made, if there is one. */
  async endFilm() {
    if (!this.#film) return;
    const running = this.#film;
    this.#film = null;
    this.live.parts.film.textContent = say("film");
    save(URL.createObjectURL(await running.stop()), "spintop.webm");
    this.#say(say("film_saved"));
  }

  async #copy(text, done) {
    try {
      await navigator.clipboard.writeText(text);
      this.#say(done);
    } catch {
      this.#say(say("copy_refused"));
    }
  }
}
