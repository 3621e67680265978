// The script of the page with the live top alone.

import { LANGUAGES, chooseLanguage, fillWords, linkOfLanguage, say, spoken } from "./live/language.js";
import { LiveTop } from "./live/live.js";

chooseLanguage(location);
document.title = `${say("live_top")} – spintop`;
fillWords(document.body);

const menu = document.querySelector("select.language");
menu.append(...Object.entries(LANGUAGES).map(([code, name]) => new Option(name, code, false, code === spoken())));
menu.hidden = false;
// The address holds what is set, so the page can be loaded anew in another language.
menu.addEventListener("change", () => {
  history.replaceState(null, "", `#${liveTop.link(linkOfLanguage(menu.value))}`);
  location.reload();
});

const section = document.querySelector("section.live");
globalThis.liveTop = new LiveTop(section, document.getElementById("live"), { ownsLink: true });
