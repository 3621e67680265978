// The least that tests of the page's modules need: names, checks, and results for the browser's driver.

export const results = [];

/** Run a test; what it throws is its failure. */
export function test(name, body) {
  try {
    body();
    results.push({ name, failure: "" });
  } catch (error) {
    results.push({ name, failure: String(error.message ?? error) });
  }
}

export function equal(found, expected, what = "value") {
  const [a, b] = [found, expected].map((value) => JSON.stringify(value));
  if (a !== b) throw new Error(`${what} is ${a}, not ${b}`);
}

export function near(found, expected, tolerance, what = "value") {
  if (!(Math.abs(found - expected) <= tolerance)) {
    throw new Error(`${what} is ${found}, not ${expected} within ${tolerance}`);
  }
}
