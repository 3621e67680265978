// The colours of the page, which are those of its style sheet, light or dark.

const NAMES = {
  ground: "--stage",
  faint: "--faint",
  ink: "--ink",
  rod: "--rod",
  even: "--body-even",
  odd: "--body-odd",
  mark: "--mark",
  trace: "--trace",
  ghost: "--ghost",
  force: "--force",
  momentum: "--momentum",
  omega: "--omega",
  torque: "--torque",
  change: "--torque",
};

/** The colours that hold for an element now. */
export function coloursOf(element) {
  const style = getComputedStyle(element);
  const colours = Object.fromEntries(
    Object.entries(NAMES).map(([name, property]) => [name, style.getPropertyValue(property).trim()]),
  );
  return { ...colours, body: [colours.even, colours.odd] };
}
