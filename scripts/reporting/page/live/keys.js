// The keyboard of a live top.

const TURN = 0.15; // rad a press
const NEARER = 1.15;
const STEP = 1 / 200; // of the span
const PAGE = 1 / 10;

const OWN_KEYS = "select, button, input:not([type=range]), summary, a, pre";
const MOVES_SLIDER = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Home", "End", "PageUp", "PageDown"];

/** Have a section obey keys, but for those that its own controls take. */
export function bindKeys(section, live) {
  const go = (part) => live.seek(live.clock.time + part * live.track.span);
  const actions = {
    " ": () => live.toggle(),
    ArrowLeft: () => go(-STEP),
    ArrowRight: () => go(STEP),
    PageDown: () => go(-PAGE),
    PageUp: () => go(PAGE),
    Home: () => live.seek(0),
    End: () => live.seek(live.track.span),
    "+": () => live.stage.look("zoom", NEARER),
    "=": () => live.stage.look("zoom", NEARER),
    "-": () => live.stage.look("zoom", 1 / NEARER),
    "0": () => live.stage.look("reset"),
    "Shift+ArrowLeft": () => live.stage.look("turn", -TURN, 0),
    "Shift+ArrowRight": () => live.stage.look("turn", TURN, 0),
    "Shift+ArrowUp": () => live.stage.look("turn", 0, TURN),
    "Shift+ArrowDown": () => live.stage.look("turn", 0, -TURN),
    ",": () => live.changeSpeed(-1),
    ".": () => live.changeSpeed(1),
  };
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
