// Numbers and times as words.

const DEGREE = 180 / Math.PI;
const FIGURES = 7;

/** An angle in degrees. */
export function inDegrees(angle, decimals = 3) {
  return `${minus((angle * DEGREE).toFixed(decimals))}°`;
}

/** A number as it stands in the table, or with the figures that one can read while it moves. */
export function inFull(value, isOfTable) {
  return minus(isOfTable ? String(value) : value.toPrecision(FIGURES));
}

/** A number with a few figures. */
export function inShort(value) {
  return minus(String(Number(value.toPrecision(4))));
}

/** With a true minus sign, and none before a zero. */
function minus(text) {
  return Number(text) === 0 ? text.replace("-", "") : text.replaceAll("-", "\u2212");
}

function extremes(numbers) {
  let [low, high] = [Infinity, -Infinity];
  for (const number of numbers) {
    low = Math.min(low, number);
    high = Math.max(high, number);
  }
  return [low, high];
}

/** What one would see, for those who do not. */
export function accountOf(motion) {
  const [phi, theta, psi] = motion.angles;
  const [low, high] = extremes(theta);
  const words = [
    `From t = ${inShort(motion.start)} s to ${inShort(motion.end)} s the inclination θ stays between`,
    `${inDegrees(low, 2)} and ${inDegrees(high, 2)}.`,
  ];
  if (motion.countsTurns) {
    words.push(
      `Precession φ goes from ${inDegrees(phi[0], 1)} to ${inDegrees(phi.at(-1), 1)},`,
      `spin ψ from ${inDegrees(psi[0], 1)} to ${inDegrees(psi.at(-1), 1)}.`,
    );
  }
  const longest = [
    motion.force && `support force ${inShort(motion.largest(motion.force))} N`,
    motion.momentum && `angular momentum ${inShort(motion.largest(motion.momentum))} J s`,
  ].filter(Boolean);
  if (longest.length) words.push(`Longest arrows: ${longest.join(", ")}.`);
  return words.join(" ");
}

/** Where the motion is, in a sentence to be spoken. */
export function momentOf({ time, angles }) {
  const [phi, theta, psi] = angles.map((angle) => inDegrees(angle, 1));
  return `t ${inShort(time)} seconds, phi ${phi}, theta ${theta}, psi ${psi}`;
}
