// The page's script: gives every trajectory its moving top.

import { Motion } from "./motion.js";
import { Viewer } from "./viewer.js";

for (const section of document.querySelectorAll("section.top")) {
  const data = JSON.parse(section.querySelector("script").textContent);
  new Viewer(section, new Motion(data));
}
