// The script of the page with the live top alone.

import { LiveTop } from "./live/live.js";

const section = document.querySelector("section.live");
globalThis.liveTop = new LiveTop(section, document.getElementById("live"), { ownsLink: true });
