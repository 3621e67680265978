// Paper: every top as a still, in the colours of paper.

import { inDegrees, inShort } from "./text.js";

const [WIDTH, HEIGHT] = [960, 640]; // pixels

/** Before the page is printed, put a still of each top into it. */
export function bindPrint(viewers) {
  addEventListener("beforeprint", () => {
    document.documentElement.dataset.paper = "yes";
    for (const viewer of viewers) {
      viewer.stage.recolour();
      const { address, moment } = viewer.still(WIDTH, HEIGHT);
      if (!address) continue;
      const [phi, theta, psi] = moment.angles.map((angle) => inDegrees(angle, 1));
      const still = viewer.parts.still.querySelector("img") ?? document.createElement("img");
      Object.assign(still, { src: address, alt: `The top at t = ${inShort(moment.time)} s` });
      viewer.parts.still.prepend(still);
      viewer.parts.moment.textContent =
        `The top at t = ${inShort(moment.time)} s: φ = ${phi}, θ = ${theta}, ψ = ${psi}. ` +
        "The trace of its tip up to then; the older, the fainter.";
    }
    delete document.documentElement.dataset.paper;
    for (const viewer of viewers) viewer.stage.recolour();
  });
}
