// The page's script: has tables saved, and gives every trajectory its moving top.

import { bindDownload, columnsOf, textOf } from "./data.js";
import { bindCards } from "./live/card.js";
import { Motion } from "./motion.js";
import { bindPrint } from "./print.js";
import { Viewer } from "./viewer.js";

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

bindCards();

const viewers = [];
bindPrint(viewers);

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
