// The keyboard of a moving top: what all tops obey, and the steps in time of the tops of a table.

const TURN = 0.15; // rad a press
const NEARER = 1.15;
const PAGES = 10; // of which PageUp and PageDown go one

const OWN_KEYS = "select, button, input:not([type=range]), summary, a, pre";
const MOVES_SLIDER = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Home", "End", "PageUp", "PageDown"];

/** What keys do to the view, by their names; with Shift the arrows turn it. */
function viewActions(look) {
  return {
    "+": () => look("zoom", NEARER),
    "=": () => look("zoom", NEARER),
    "-": () => look("zoom", 1 / NEARER),
    "0": () => look("reset"),
    "Shift+ArrowLeft": () => look("turn", -TURN, 0),
    "Shift+ArrowRight": () => look("turn", TURN, 0),
    "Shift+ArrowUp": () => look("turn", 0, TURN),
    "Shift+ArrowDown": () => look("turn", 0, -TURN),
  };
}

/**
 * Have a section obey keys, but for those that its own controls take.
 *
 * @param look changes the view @param changeSpeed takes a faster speed, or a slower one
 * @param steps what the keys that play, and go forth and back in time, do, by their names
 */
export function obeyKeys(section, { look, changeSpeed, steps }) {
  const actions = { ...viewActions(look), ...steps, ",": () => changeSpeed(-1), ".": () => changeSpeed(1) };
  section.addEventListener("keydown", (event) => {
    const { key, target } = event;
    if (event.ctrlKey || event.altKey || event.metaKey || target.closest(OWN_KEYS)) return;
    if (target.matches("input[type=range]") && !event.shiftKey && MOVES_SLIDER.includes(key)) return;
    const action = actions[event.shiftKey && key.startsWith("Arrow") ? `Shift+${key}` : key];
    if (!action) return;
    event.preventDefault();
    action();
  });
}

/** Have the section of a viewer obey keys, which go from row to row. */
export function bindKeys(section, viewer) {
  const { player, motion } = viewer;
  const page = Math.max(1, Math.round(motion.count / PAGES));
  obeyKeys(section, {
    look: (...how) => viewer.look(...how),
    changeSpeed: (by) => viewer.changeSpeed(by),
    steps: {
      " ": () => player.toggle(),
      ArrowLeft: () => player.step(-1),
      ArrowRight: () => player.step(1),
      PageDown: () => player.step(-page),
      PageUp: () => player.step(page),
      Home: () => player.goToRow(0),
      End: () => player.goToRow(motion.count - 1),
    },
  });
}
