// Runs one engine on all motions in this process: a question in JSON comes, lines of JSON go back.
//
// usage: node common.mjs SCRIPT < QUESTION; in a folder whose node_modules has the packages

import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const LEAST = 0.1; // a run is repeated for so many seconds, the fastest counts
const MOST_ROUNDS = 5; // or so many times

/** A motion that an engine cannot do, or not by one of its methods. */
export class Refusal extends Error {}

/** A vector in the axes of the body, of a quaternion with the scalar part first, in space axes. */
export function toSpace([w, x, y, z], v) {
  const t = cross([x, y, z], v).map((a) => 2 * a);
  const u = cross([x, y, z], t);
  return v.map((a, i) => a + w * t[i] + u[i]);
}

/** A vector in space axes, in those of the body. */
export function toBody([w, x, y, z], v) {
  return toSpace([w, -x, -y, -z], v);
}

/** The vector product. */
export function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/** Where a body starts: the place and velocity of its centre of mass, and omega in space axes. */
export function startOf({ quaternion, arm, omega }) {
  const [place, spin] = [toSpace(quaternion, arm), toSpace(quaternion, omega)];
  return { place, spin, velocity: cross(spin, place) };
}

/** The state of a body whose engine has the scalar part last, and omega in space axes. */
export function stateOf([x, y, z, w], spin) {
  return [w, x, y, z, ...toBody([w, x, y, z], spin)];
}

const now = () => (({ user, system }) => (user + system) / 1e6)(process.cpuUsage()); // processor time, s
const say = (answer) => process.stdout.write(`${JSON.stringify(answer)}\n`);

/** The version of a package, which its file says. */
function versionOf(name) {
  const path = join(dirname(fileURLToPath(import.meta.url)), "node_modules", name, "package.json");
  return JSON.parse(readFileSync(path, "utf8")).version;
}

/** The states at the samples, and the processor time of all steps, s. */
async function run(engine, motion, method, step, stride) {
  const { advance, state, end } = await engine.prepare(motion, method, step);
  const states = [];
  let seconds = 0;
  for (let i = 0; i < motion.samples; i += 1) {
    const start = now();
    advance(stride);
    seconds += now() - start;
    states.push(state());
  }
  end?.();
  return { states, seconds };
}

/** One method with smaller and smaller steps, until the time is up. */
async function measure(engine, motion, method, { rates, budget }) {
  const end = now() + budget;
  let last = 0;
  for (const rate of rates) {
    if (now() + 2.5 * last > end) break;
    const stride = Math.round((rate * motion.t_end) / motion.samples);
    const begun = now();
    let best = null;
    for (let round = 0; round < 2 || (round < MOST_ROUNDS && now() - begun < LEAST); round += 1) {
      const begin = now();
      const result = await run(engine, motion, method, 1 / rate, stride);
      last = now() - begin;
      best = best && best.seconds < result.seconds ? best : result;
      if (last > budget / 4) break;
    }
    say({ motion: motion.name, method, rate, ...best });
  }
}

/** Answer the question: first which versions there are, or what is lacking. */
async function main(script) {
  const question = JSON.parse(readFileSync(0, "utf8"));
  let engine;
  try {
    const versions = question.packages.map(versionOf).join(" and ");
    engine = await import(`./${script}`);
    say({ versions });
  } catch (error) {
    say({ absence: error.message.split("\n")[0] });
    return;
  }
  for (const motion of question.motions) {
    for (const method of engine.METHODS) {
      try {
        await measure(engine, motion, method, question);
      } catch (error) {
        if (!(error instanceof Refusal)) throw error;
        say({ motion: motion.name, method, refusal: error.message });
      }
    }
  }
}

main(process.argv[2]); // not awaited here: the script imports this module
