// The keyboard of a moving top.

const TURN = 0.15; // rad a press
const NEARER = 1.15;
const PAGES = 10; // of which PageUp and PageDown go one

const OWN_KEYS = "select, button, input[type=checkbox], summary, a, pre";
const MOVES_SLIDER = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Home", "End", "PageUp", "PageDown"];

/** What the keys do, by their names; with Shift the arrows turn the view. */
function actionsOf({ player, look, motion }) {
  const page = Math.max(1, Math.round(motion.count / PAGES));
  return {
    " ": () => player.toggle(),
    ArrowLeft: () => player.step(-1),
    ArrowRight: () => player.step(1),
    PageDown: () => player.step(-page),
    PageUp: () => player.step(page),
    Home: () => player.goToRow(0),
    End: () => player.goToRow(motion.count - 1),
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

/** Have a section obey keys, but for those that its own controls take. */
export function bindKeys(section, viewer) {
  const { player, motion } = viewer;
  const actions = {
    ...actionsOf({ player, motion, look: viewer.look.bind(viewer) }),
    ",": () => viewer.changeSpeed(-1),
    ".": () => viewer.changeSpeed(1),
  };
  section.addEventListener("keydown", (event) => {
    const { key, target } = event;
    if (event.ctrlKey || event.altKey || event.metaKey || target.closest(OWN_KEYS)) return;
    const isArrow = key.startsWith("Arrow");
    if (target.matches("input[type=range]") && !event.shiftKey && MOVES_SLIDER.includes(key)) return;
    const action = actions[event.shiftKey && isArrow ? `Shift+${key}` : key];
    if (!action) return;
    event.preventDefault();
    action();
  });
}
