// The cards of a report by which the live top is opened with the scene of a table.

import { LiveTop } from "./live.js";
import { stateOfLink } from "./scene.js";

/** Give every card its button; a live top takes the place of what stands on the card. */
export function bindCards() {
  const template = document.getElementById("live");
  for (const card of document.querySelectorAll("section.live.closed")) {
    card.querySelector("button").addEventListener("click", () => {
      card.classList.remove("closed");
      card.replaceChildren();
      card.top = new LiveTop(card, template, { state: stateOfLink(card.dataset.link) });
      card.focus({ preventScroll: true });
    });
  }
}
