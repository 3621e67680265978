// The page's script: has tables saved, and gives every trajectory its moving top.

import { momentOf } from "./account.js";
import { bindDownload, columnsOf, textOf } from "./data.js";
import { LiveTop } from "./live/live.js";
import { stateOfLink } from "./live/scene.js";
import { Motion } from "./motion.js";
import { Viewer } from "./viewer.js";

const [WIDTH, HEIGHT] = [960, 640]; // pixels of a still on paper

for (const link of document.querySelectorAll("a.data")) bindDownload(link);

const tops = [...document.querySelectorAll("section.top")].map((section) => {
  const facts = JSON.parse(section.querySelector("script").textContent);
  let motion = null;
  const load = () => {
    const link = document.getElementById(facts.data);
    motion ??= textOf(link).then((text) => new Motion(facts, columnsOf(text, facts.columns)));
    return motion;
  };
  return { section, facts, load, title: facts.title, isExact: facts.exact };
});

// The cards by which the live top is opened with the scene of a table; it takes their place.
const template = document.getElementById("live");
for (const card of document.querySelectorAll("section.live.closed")) {
  card.querySelector("button").addEventListener("click", () => {
    card.classList.remove("closed");
    card.replaceChildren();
    card.top = new LiveTop(card, template, { state: stateOfLink(card.dataset.link) });
    card.focus({ preventScroll: true });
  });
}

const viewers = [];
// On paper every top is a still, in the colours of paper.
addEventListener("beforeprint", () => {
  document.documentElement.dataset.paper = "yes";
  for (const viewer of viewers) {
    viewer.stage.recolour();
    const { address, moment } = viewer.still(WIDTH, HEIGHT);
    if (!address) continue;
    const still = viewer.parts.still.querySelector("img") ?? document.createElement("img");
    Object.assign(still, { src: address, alt: momentOf("still_at", moment) });
    viewer.parts.still.prepend(still);
    viewer.parts.moment.textContent = momentOf("still_words", moment);
  }
  delete document.documentElement.dataset.paper;
  for (const viewer of viewers) viewer.stage.recolour();
});

/** Until the screen has been drawn once more, or soon where it is not drawn. */
function frame() {
  return new Promise((go) => {
    requestAnimationFrame(() => setTimeout(go));
    setTimeout(go, 100);
  });
}

/** One after the other, from the top of the page; what is there is seen while the rest is made. */
async function begin() {
  for (const top of tops) {
    const peers = tops.filter((other) => other !== top && other.facts.scene === top.facts.scene);
    viewers.push(new Viewer(top.section, await top.load(), peers));
    await frame();
  }
  document.documentElement.dataset.ready = "yes";
}

if ("DecompressionStream" in globalThis) begin();
else for (const { section } of tops) section.classList.add("old-browser");
