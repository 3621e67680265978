// The keyboard of a live top, whose steps are parts of the span.

import { obeyKeys } from "../keys.js";

const STEP = 1 / 200;
const PAGE = 1 / 10;

/** Have the section of a live top obey keys. */
export function bindKeys(section, live) {
  const go = (part) => live.seek(live.clock.time + part * live.track.span);
  obeyKeys(section, {
    look: (...how) => live.stage.look(...how),
    changeSpeed: (by) => live.changeSpeed(by),
    steps: {
      " ": () => live.toggle(),
      ArrowLeft: () => go(-STEP),
      ArrowRight: () => go(STEP),
      PageDown: () => go(-PAGE),
      PageUp: () => go(PAGE),
      Home: () => live.seek(0),
      End: () => live.seek(live.track.span),
    },
  });
}
