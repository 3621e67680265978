// Angles with their turns, places among ascending numbers, and extremes.

const TURN = 2 * Math.PI;

/** The same angle as near as can be to another. */
export function nearTo(angle, other) {
  return angle + TURN * Math.round((other - angle) / TURN);
}

/** How many of ascending numbers are not above a value. */
export function countUpTo(numbers, value) {
  let [low, high] = [0, numbers.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (numbers[middle] <= value) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** The least and the largest of numbers; nan is none. */
export function extremesOf(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return [low, high];
}
