// The exact solution of a symmetric top without damping (Lagrange top): src/exact/exact_motion.f90.
//
// After its preparation it gives the motion at any time, forward or backward, at a cost that does not
// depend on the time span. The attitude is a product of theta functions (Jacobi 1850; Klein and Sommerfeld
// 1898). They are regular at the poles, and nothing has to be integrated or unwrapped.
//
//     const exact = new ExactMotion(body, start);
//     const { angle, rate, omega, quaternion } = exact.at(t);
//
// The formulas and their order are those of the Fortran, which has its constants and phases in extended
// precision; here they are in double precision. What is lost is a rounding of rate times time.

import {
  add, anint, argument, conjugate, modulo, modulus, multiply, scale, sign, subtract, timesI, unit,
} from "./arithmetic.js";
import { describeNutation } from "./nutation.js";
import { findRegularStart, halfOf } from "./regular_start.js";
import { RESTING, ThetaMotion } from "./theta_motion.js";
import { findTurningPoints } from "./turning_points.js";

const TURN = 2 * Math.PI;

export class ExactMotion {
  /** @param body as `makeBody` gives it @param start as `startFromAngles` gives it */
  constructor(body, start) {
    this.body = body;
    this.start = findRegularStart(body, start);
    this.points = findTurningPoints(this.start);
    this.theta = new ThetaMotion(this.start, this.points);
    this.nutation = describeNutation(this.start, this.points, this.theta);
    this.passesPole = this.nutation.passesTop || this.nutation.passesBottom;
    this.side = this.start.turnsAgainstAngles ? -1 : 1;
    this.topsBefore = 0;
    this.bottomsBefore = 0;
    if (this.theta.regime === RESTING) this.#rest();
    else this.#setPhases();
  }

  /** An axis at rest: the body spins about it. */
  #rest() {
    const { start } = this;
    this.upperPhase = start.upperPhase;
    this.lowerPhase = start.lowerPhase;
    this.upperRate = start.omega3 / 2;
    this.lowerRate = -start.omega3 / 2;
    this.sumRate = 0;
    this.differenceRate = start.omega3;
  }

  /** Rates of the phases, and the constants that make the motion pass through the start. */
  #setPhases() {
    const { start, theta: motion } = this;
    const { clock } = motion;
    this.upperRate = halfOf(start) + clock.upperRate;
    this.lowerRate = -halfOf(start) + clock.lowerRate;
    this.sumRate = clock.sumRate;
    this.differenceRate = 2 * halfOf(start) + clock.upperRate - clock.lowerRate;

    const { z, fromTop, nutations } = motion.locate(0);
    this.topsBefore = nutations;
    this.bottomsBefore = z >= 0 ? nutations : nutations - 1;
    const theta = motion.evaluate(z, fromTop);
    const constant = (value, slope, rate, x, xRate) => this.#phaseConstant(theta, value, slope, rate, x, xRate);
    this.upperPhase = constant(theta.upper, theta.upperSlope, clock.upperRate, start.upper, start.upperRate);
    this.lowerPhase = constant(theta.lower, theta.lowerSlope, clock.lowerRate, start.lower, start.lowerRate);

    // Whole turns are added: phi and psi begin at their given values.
    const upperThen = this.upperPhase + argument(theta.upper);
    const lowerThen = this.lowerPhase + argument(theta.lower);
    this.upperPhase += -nutations * clock.upperStep + TURN * anint((start.upperPhase - upperThen) / TURN);
    this.lowerPhase += -nutations * clock.lowerStep + TURN * anint((start.lowerPhase - lowerThen) / TURN);
  }

  /**
   * The angle A for which exp(i A) times the formula of a component gives the start. It uses value and
   * rate together, because at a pole one of them may vanish.
   */
  #phaseConstant(theta, value, slope, rate, x, xRate) {
    const zRate = this.theta.clock.rate;
    const formula = scale(1 / theta.divisor, value);
    const formulaRate = add(
      scale(rate, timesI(formula)),
      scale(zRate / theta.divisor, subtract(slope, scale(theta.divisorSlope / theta.divisor, value))),
    );
    return argument(add(
      scale(this.points.frequency ** 2, multiply(conjugate(formula), x)),
      multiply(conjugate(formulaRate), xRate),
    ));
  }

  /**
   * The motion at time t, s: angles with all turns of phi and psi, their rates, the angular velocity in
   * body axes and its derivative, and the quaternion. At an exact passage of a pole the rates of phi and
   * psi do not exist; the result is their limit for passages that approach the pole.
   */
  at(t) {
    const { start } = this;
    const now = this.#attitude(t);
    const swing = this.#swing(now);
    const swingRate = add(
      scale(-(start.omega3 - start.a), timesI(swing)),
      scale(start.beta, multiply(now.lower, conjugate(now.upper))),
    );
    const { angle, rate } = this.#angles(now);
    return {
      t,
      angle,
      rate,
      omega: [swing[0], swing[1], start.omega3],
      omegaRate: [swingRate[0], swingRate[1], 0],
      quaternion: this.#quaternion(now),
    };
  }

  #quaternion({ upper, lower }) {
    return [this.side * upper[0], this.side * lower[0], this.side * lower[1], this.side * upper[1]];
  }

  /** The Cayley-Klein components at time t. */
  #attitude(t) {
    const elapsed = t - this.start.time;
    if (this.theta.regime === RESTING) {
      return {
        elapsed,
        upper: multiply(this.start.upper, unit(this.upperRate * elapsed)),
        lower: multiply(this.start.lower, unit(this.lowerRate * elapsed)),
      };
    }
    const { clock } = this.theta;
    const { z, fromTop, nutations } = this.theta.locate(elapsed);
    const theta = this.theta.evaluate(z, fromTop);
    const upperTurn = scale(
      clock.upperAmplitude / theta.divisor,
      unit(this.upperPhase + this.upperRate * elapsed + nutations * clock.upperStep),
    );
    const lowerTurn = scale(
      clock.lowerAmplitude / theta.divisor,
      unit(this.lowerPhase + this.lowerRate * elapsed + nutations * clock.lowerStep),
    );
    return {
      elapsed, nutations, theta, upperTurn, lowerTurn, rising: z >= 0,
      upper: multiply(upperTurn, theta.upper), lower: multiply(lowerTurn, theta.lower),
    };
  }

  /**
   * omega1 + i omega2 = 2 [conj(upper) lower' - conj(upper') lower], rad/s. The derivative of the divisor
   * and the spin that is linear in time cancel and are omitted.
   */
  #swing({ theta, upperTurn, lowerTurn }) {
    if (this.theta.regime === RESTING) return [0, 0];
    const { clock } = this.theta;
    const product = multiply(conjugate(theta.upper), theta.lower);
    const change = subtract(
      multiply(conjugate(theta.upper), theta.lowerSlope), multiply(conjugate(theta.upperSlope), theta.lower),
    );
    return multiply(
      scale(2, multiply(conjugate(upperTurn), lowerTurn)),
      add(scale(clock.sumRate, timesI(product)), scale(clock.rate, change)),
    );
  }

  /** Angles, with all turns of phi and psi, and their rates. */
  #angles(now) {
    const { start, points } = this;
    let total = this.upperPhase + this.lowerPhase + this.sumRate * now.elapsed;
    let difference = this.upperPhase - this.lowerPhase + this.differenceRate * now.elapsed;
    if (this.theta.regime === RESTING) {
      return {
        angle: [total, 2 * Math.atan2(modulus(start.lower), modulus(start.upper)), difference],
        rate: [0, 0, start.omega3],
      };
    }
    const { clock } = this.theta;
    const { theta } = now;
    const sn2 = theta.sn ** 2;
    const cn2 = theta.cn ** 2;
    const oneMinusU = points.oneMinusU2 + points.u2MinusU1 * cn2;
    const onePlusU = points.onePlusU1 + points.u2MinusU1 * sn2;
    const u = (onePlusU - oneMinusU) / 2;
    const sine = Math.sqrt(oneMinusU * onePlusU);

    if (this.passesPole) {
      const jumps = this.#jumps(now);
      total += jumps.bottom + jumps.top;
      difference += jumps.bottom - jumps.top;
    }
    total += now.nutations * (clock.upperStep + clock.lowerStep);
    difference += now.nutations * (clock.upperStep - clock.lowerStep);
    const [upper, lower] = [argument(theta.upper), argument(theta.lower)];

    const y = sn2 < cn2 ? points.y1 + points.u2MinusU1 * sn2 : points.y2 - points.u2MinusU1 * cn2;
    const turn = this.#turnAt(y, oneMinusU, onePlusU);
    let [phiRate, thetaRate] = [0, 0];
    if (sine > 0) {
      const dn = Math.sqrt(points.complementSquared + points.kSquared * cn2);
      phiRate = turn / (oneMinusU * onePlusU);
      thetaRate = -2 * points.u2MinusU1 * points.frequency * theta.sn * theta.cn * (dn / sine);
    } else {
      thetaRate = Math.sqrt(start.swingSquared - start.beta * y);
    }
    return {
      angle: [total + (upper + lower), Math.atan2(sine, u), difference + (upper - lower)],
      rate: [phiRate, thetaRate, start.omega3 - phiRate * u],
    };
  }

  /** phi' sin(theta)^2 = b - a u, rad/s, in the form that cancels least. */
  #turnAt(y, oneMinusU, onePlusU) {
    const { a, turn, bMinusA, bPlusA } = this.start;
    const fromStart = Math.abs(turn) + Math.abs(a * y);
    const fromTop = Math.abs(bMinusA) + Math.abs(a * oneMinusU);
    const fromBottom = Math.abs(bPlusA) + Math.abs(a * onePlusU);
    if (fromStart <= Math.min(fromTop, fromBottom)) return turn - a * y;
    return fromTop <= fromBottom ? bMinusA + a * oneMinusU : bPlusA - a * onePlusU;
  }

  /**
   * Half turns of phi and psi at exact passages of a pole. The theta functions turn in the same direction
   * each time; counted here are half turns of alternating sign.
   */
  #jumps({ nutations, rising }) {
    const jump = (count, momentum) => Math.PI * (modulo(count, 2) - sign(1, momentum) * count);
    const bottoms = (rising ? nutations : nutations - 1) - this.bottomsBefore;
    return {
      top: this.nutation.passesTop ? jump(nutations - this.topsBefore, this.start.bMinusA) : 0,
      bottom: this.nutation.passesBottom ? jump(bottoms, this.start.bPlusA) : 0,
    };
  }
}
