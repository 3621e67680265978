"""The motion of a symmetric top under gravity in ball arithmetic, with python-flint.

Every answer is a ball that holds the motion of the data, which are doubles taken as exact. The
roots of the cubic are found by interval Newton iteration, the phases by Carlson's R_F and K(m), the
attitude by theta functions at complex arguments.

Symbols: u = cos(theta), a = I3 omega3/I1, beta = 2 m g l/I1, b = Lz/I1, y = u - u at the start,
y1 <= y2 <= y3 the roots of the cubic; "plus" is q0 + i q3 and its pole, theta = pi; "minus" is
q1 + i q2 and theta = 0.
"""

from dataclasses import astuple, dataclass
from fractions import Fraction

from flint import acb, acb_poly, arb, ctx, fmpq

from random_tops import Start

BITS = (128, 192, 288, 432, 648, 972, 1458, 2187, 3280)
"""Precisions that are tried, one after the other."""
RADIUS = 1e-19
"""A ball with a larger radius is computed again with more bits."""


class UndecidedError(ArithmeticError):
    """The balls do not decide a sign or a branch at this precision."""


@dataclass(frozen=True)
class Answer:
    """The attitude at a time; phi and psi are None where they jump or do not exist."""

    quaternion: tuple[arb, arb, arb, arb]
    theta: arb
    phi: arb | None
    psi: arb | None


def ball(value: float) -> arb:
    """A double as an exact ball."""
    fraction = Fraction(value)
    return arb(fmpq(fraction.numerator, fraction.denominator))


def squared(value: arb) -> arb:
    """A square: a power of a ball that holds 0 would be `nan`."""
    return value * value


def sign(value: arb) -> int:
    """The sign of a ball that is decided; 1 for an exact 0."""
    if value.is_zero() or value > 0:
        return 1
    if value < 0:
        return -1
    raise UndecidedError("sign")


def motion_at(start: Start, times: list[float]) -> list[Answer]:
    """The attitude at some times, with as many bits as they need."""
    done: list[Answer] = []
    error: UndecidedError | None = None
    for bits in BITS:
        ctx.prec = bits
        try:
            motion = Motion(start)
            while len(done) < len(times):
                done.append(motion.at(times[len(done)]))
        except UndecidedError as undecided:
            error = undecided
        else:
            return done
    raise UndecidedError(f"{error} with {BITS[-1]} bits")


def enclose_root(coefficients: list[arb], guess: arb) -> arb:
    """The root near a guess: the only one in a ball, by interval Newton iteration."""
    g0, g1, g2, g3 = coefficients
    for _ in range(8):
        slope = (3 * g3 * guess + 2 * g2) * guess + g1
        step = ((((g3 * guess + g2) * guess + g1) * guess + g0) / slope).mid()
        if not step.is_finite():
            break
        guess = (guess - step).mid()
    for bits in range(ctx.prec - 16, 4, -8):
        trial = guess + arb(0, 1) * abs(guess) * arb(2) ** -bits
        slope = (3 * g3 * trial + 2 * g2) * trial + g1
        if slope.contains(0):
            continue
        image = guess - (((g3 * guess + g2) * guess + g1) * guess + g0) / slope
        if trial.contains_interior(image):
            return image
    raise UndecidedError("root")


class Motion:
    """The motion of a top, set up at the precision of the moment."""

    def __init__(self, start: Start) -> None:
        (i1, i3, mass, gravity, length, phi, theta, psi, phi_rate, theta_rate, spin) = map(
            ball, astuple(start)[:11]
        )
        self.sine, self.cosine = (theta / 2).sin(), (theta / 2).cos()
        u0, s2 = theta.cos(), squared(theta.sin())
        self.sh, self.ch = 2 * squared(self.sine), 2 * squared(self.cosine)
        omega3 = spin if start.spin_is_omega3 else spin + phi_rate * u0
        a, beta = i3 * omega3 / i1, 2 * mass * gravity * length / i1
        self.half = (omega3 - a) / 2
        self.sum, self.difference = (phi + psi) / 2, (phi - psi) / 2
        self.theta_rate, self.omega3 = theta_rate, omega3
        self.b_minus_a = self.sh * (self.ch * phi_rate - a)
        self.b_plus_a = self.ch * (self.sh * phi_rate + a)
        if start.inertia1 == start.inertia3 and not start.spin_is_omega3:
            self.b_minus_a = self.sh * (phi_rate - spin)
            self.b_plus_a = self.ch * (phi_rate + spin)
        self.from_pole, self.is_steady = start.theta == 0, False
        self.is_free = start.gravity == 0
        if self.is_free:
            self.prepare_free(i1, i3, start)
        if self.is_free or (self.from_pole and start.theta_rate == 0):
            return
        swing = squared(theta_rate) + s2 * squared(phi_rate)
        g0 = s2 * squared(theta_rate)
        g1 = -2 * u0 * swing - beta * s2 + 2 * a * phi_rate * s2
        g2 = 2 * beta * u0 - swing - squared(a)
        self.is_steady = is_steady(start)
        if self.is_steady:
            self.phi_rate, self.psi_rate, self.phi, self.psi = phi_rate, spin, phi, psi
            return
        self.is_plane = start.phi_rate == 0 and start.spin == 0
        if self.is_plane:
            y1, y2, y3 = self.plane_start(swing / beta)
        elif start.theta_rate == 0 or self.from_pole:
            y1, y2, y3 = self.turning_start(g1, g2, beta)
        else:
            y1, y2, y3 = self.moving_start([g0, g1, g2, beta])
        if self.b_plus_a.is_zero():
            y1 = -self.ch
        if self.b_minus_a.is_zero():
            self.turns_round = not y2 < self.sh
            if self.turns_round and not y3 > self.sh:
                raise UndecidedError("whether the axis passes the upright")
            y2, y3 = (self.sh, y3) if self.turns_round else (y2, self.sh)
        self.set_up(y1, y2, y3, beta)

    def turning_start(self, g1: arb, g2: arb, beta: arb) -> tuple[arb, arb, arb]:
        """The roots for a start where theta turns, y = 0 one of them."""
        self.starts_high = sign(g1) < 0
        self.starts_moving = 0
        root = (squared(g2) - 4 * beta * g1).sqrt()
        far = -(g2 + sign(g2) * root) / 2
        low, high = sorted([far / beta, g1 / far], key=float)
        if not low < high:
            raise UndecidedError("roots")
        if self.starts_high:
            return low, arb(0), high
        return arb(0), low, high

    def moving_start(self, coefficients: list[arb]) -> tuple[arb, arb, arb]:
        """The roots for a start between them, in ascending order."""
        self.starts_moving = sign(self.theta_rate)
        try:
            found = acb_poly([acb(value.mid()) for value in coefficients]).roots()
        except ValueError as error:
            raise UndecidedError("roots") from error
        guesses = sorted(root.real.mid() for root in found)
        y1, y2, y3 = (enclose_root(coefficients, guess) for guess in guesses)
        if not (y1 < 0 < y2 < y3):
            raise UndecidedError("order of roots")
        return y1, y2, y3

    def plane_start(self, rise: arb) -> tuple[arb, arb, arb]:
        """The roots for a plane pendulum that can rise by `rise` above its start."""
        self.starts_moving = sign(self.theta_rate) * (not self.theta_rate.is_zero())
        self.starts_high = True
        if self.from_pole:
            self.starts_moving = 0
        return -self.ch, *((rise, self.sh) if rise < self.sh else (self.sh, rise))

    def prepare_free(self, i1: arb, i3: arb, start: Start) -> None:
        """A motion without gravity: the axis turns about the momentum, which is constant."""
        theta, psi = ball(start.theta), ball(start.psi)
        across, along = ball(start.phi_rate) * theta.sin(), self.theta_rate
        swing1 = across * psi.sin() + along * psi.cos()
        swing2 = across * psi.cos() - along * psi.sin()
        self.momentum = (swing1, swing2, i3 * self.omega3 / i1)

    def set_up(self, y1: arb, y2: arb, y3: arb, beta: arb) -> None:
        """Periods, phases and constants of both components."""
        d, e, up = y2 - y1, y3 - y2, y3 - y1
        m1, p2, below = self.sh - y1, self.ch + y2, self.sh - y2
        p1 = squared(self.b_plus_a) / (p2 * beta * (self.ch + y3))
        if self.b_minus_a.is_zero():
            below, above = (arb(0), y3 - self.sh) if self.turns_round else (below, arb(0))
        else:
            above = squared(self.b_minus_a) / (m1 * beta * below)
        self.s_plus, self.s_minus = sign(self.b_plus_a), sign(self.b_minus_a)
        k2, k2_dual = d / up, e / up
        omega = (beta * up).sqrt() / 2
        quarter, dual = acb(k2).elliptic_k().real, acb(k2_dual).elliptic_k().real
        v_plus = p1.sqrt() * carlson(d, d + k2 * p1, p2)
        v_minus = (below * up / (m1 * e)).sqrt() * carlson(d * above / (m1 * e), d / m1, arb(1))
        if self.starts_moving:
            x0 = (-y1 / d).sqrt() * carlson(y2 / d, 1 + k2 * y1 / d, arb(1)) * -self.starts_moving
        else:
            x0 = quarter if self.starts_high else arb(0)
        self.is_dual = bool(k2.mid() > 0.5)
        own, other = (dual, quarter) if self.is_dual else (quarter, dual)
        c = arb.pi() / (2 * own)
        self.tau = acb(0, 1) * (other / own)
        self.period = arb.pi() * quarter / dual if self.is_dual else arb.pi()
        self.nu_plus, self.nu_minus = c * v_plus, c * v_minus
        self.zeta, self.z0 = c * omega, c * x0
        if self.is_dual:
            self.jump_plus = self.s_plus * (arb.pi() - 2 * self.nu_plus)
            self.jump_minus = self.s_minus * (arb.pi() - 2 * self.nu_minus)
            shifted = acb(self.nu_plus, self.s_plus * self.period / 2)
            slope_plus = self.s_plus * self.log_slope(0, shifted).real
            slope_minus = self.s_minus * self.log_slope(3, acb(self.nu_minus)).real
        else:
            self.jump_plus, self.jump_minus = self.s_plus * arb.pi(), self.s_minus * arb.pi()
            shifted = acb(arb.pi() / 2, -self.s_plus * self.nu_plus)
            slope_plus = self.log_slope(0, shifted).imag
            slope_minus = self.log_slope(1, acb(0, -self.s_minus * self.nu_minus)).imag
        self.kappa_plus = self.half + self.b_plus_a / (2 * p2) - self.zeta * slope_plus
        self.kappa_minus = -self.half + self.b_minus_a / (2 * m1) - self.zeta * slope_minus
        if self.from_pole:
            self.kappa_minus = -self.half
        self.first_plus, self.first_minus = self.components(arb(0))

    def theta(self, which: int, z: acb, order: int = 0) -> acb:
        """A theta function, 0 to 3 for theta_1 to theta_4, or a derivative, by z with period pi."""
        value = (z / acb.pi()).modular_theta(self.tau, order)[which]
        return value / acb.pi() ** order

    def log_slope(self, which: int, z: acb) -> acb:
        """The derivative of the logarithm of a theta function."""
        return self.theta(which, z, 1) / self.theta(which, z)

    def components(self, time: arb) -> tuple[tuple[arb, arb | None, acb, int], ...]:
        """Modulus, continuous argument and value of M+ and M-, and the whole periods in them."""
        z = self.z0 + self.zeta * time
        turns = (z / self.period).mid().floor().unique_fmpz() if self.period.is_finite() else 0
        if turns is None:
            raise UndecidedError("turns")
        z -= int(turns) * self.period
        if z.mid() > self.period.mid() / 2:
            z -= self.period
            turns += 1
        turns = int(turns)
        if self.is_dual:
            down = self.theta(1, acb(0, z))
            plus = self.theta(0, acb(self.nu_plus, self.s_plus * z)) / down
            minus = self.theta(3, acb(self.nu_minus, self.s_minus * z)) / down
            lines = arb(0), arb(0)
        else:
            down = self.theta(3, acb(z))
            plus = self.theta(0, acb(z, -self.s_plus * self.nu_plus)) / down
            minus = self.theta(1, acb(z, -self.s_minus * self.nu_minus)) / down
            lines = self.s_plus * (z - arb.pi() / 2), self.s_minus * z
        return (
            (abs(plus), argument(plus, lines[0], turns * self.jump_plus), plus, turns),
            (
                abs(minus),
                argument(minus, lines[1], turns * self.jump_minus),
                minus * (-1) ** turns,
                turns,
            ),
        )

    def at(self, time: float) -> Answer:
        """The attitude at a time, s."""
        t = ball(time)
        if self.from_pole and self.theta_rate.is_zero():
            return self.sleeping(t)
        if self.is_free:
            return self.free(t)
        if self.is_steady:
            return self.steady(t)
        if self.is_plane:
            return self.plane(t)
        (plus, turn_plus, _, _), (minus, turn_minus, value, _) = self.components(t)
        (plus0, turn_plus0, _, _), (minus0, turn_minus0, _, _) = self.first_plus, self.first_minus
        if turn_plus is None or turn_plus0 is None:
            raise UndecidedError("argument at theta = pi")
        phase_plus = self.sum + self.kappa_plus * t + turn_plus - turn_plus0
        upper = self.cosine * plus / plus0 * acb(0, phase_plus).exp()
        phi = psi = None
        if self.from_pole:
            lower = self.lower_from_pole(t, value)
        else:
            if turn_minus is None or turn_minus0 is None:
                raise UndecidedError("argument at theta = 0")
            phase_minus = self.difference + self.kappa_minus * t + turn_minus - turn_minus0
            lower = self.sine * minus / minus0 * acb(0, phase_minus).exp()
            if not (self.b_minus_a.is_zero() or self.b_plus_a.is_zero()):
                phi, psi = phase_plus + phase_minus, phase_plus - phase_minus
        return checked(upper, lower, phi, psi)

    def lower_from_pole(self, t: arb, value: acb) -> acb:
        """q1 + i q2 of a motion that starts at theta = 0 and moves."""
        z = self.z0
        if self.is_dual:
            slope = self.s_minus * acb(0, 1) * self.theta(3, acb(0, self.s_minus * z), 1)
            start = self.theta(3, acb(0, self.s_minus * z))
            down = self.theta(1, acb(0, z))
        else:
            slope, start = self.theta(1, acb(z), 1), self.theta(1, acb(z))
            down = self.theta(3, acb(z))
        if not start.contains(0):
            raise AssertionError("M- is not 0 at a start on the pole")
        rate = slope / down * self.zeta
        turn = acb(0, self.difference - self.half * t).exp()
        return self.theta_rate / 2 * turn * value / rate

    def plane(self, t: arb) -> Answer:
        """A plane pendulum: both components keep their phases but for their signs."""
        (_, _, plus, turns), (minus, _, value, _) = self.components(t)
        (_, _, plus0, turns0), (minus0, _, value0, _) = self.first_plus, self.first_minus
        ratio = plus.imag / plus0.imag if self.is_dual else plus.real / plus0.real
        upper = self.cosine * ratio * (-1) ** (turns - turns0) * acb(0, self.sum).exp()
        if self.from_pole:
            lower = self.lower_from_pole(t, value)
        else:
            ratio = value.real / value0.real if self.turns_round else minus / minus0
            lower = self.sine * ratio * acb(0, self.difference).exp()
        return checked(upper, lower, None, None)

    def free(self, t: arb) -> Answer:
        """Without gravity: a turn about the momentum and one about the axis."""
        upper, lower = (
            self.cosine * acb(0, self.sum).exp(),
            self.sine * acb(0, self.difference).exp(),
        )
        start = (upper.real, lower.real, lower.imag, upper.imag)
        size = sum((squared(part) for part in self.momentum), arb(0)).sqrt()
        if not size.contains(0):
            sine, cosine = (size * t / 2).sin_cos()
            turn = (cosine, *(part / size * sine for part in self.momentum))
            start = product(start, turn)
        sine, cosine = (self.half * t).sin_cos()
        q0, q1, q2, q3 = product(start, (cosine, arb(0), arb(0), sine))
        return checked(acb(q0, q3), acb(q1, q2), None, None)

    def sleeping(self, t: arb) -> Answer:
        """A start upright and at rest but for the spin."""
        upper = acb(0, self.sum + self.omega3 * t / 2).exp()
        return checked(upper, acb(0), None, None)

    def steady(self, t: arb) -> Answer:
        """Steady precession."""
        phi, psi = self.phi + self.phi_rate * t, self.psi + self.psi_rate * t
        upper = self.cosine * acb(0, (phi + psi) / 2).exp()
        return checked(upper, self.sine * acb(0, (phi - psi) / 2).exp(), phi, psi)


def product(
    p: tuple[arb, arb, arb, arb], q: tuple[arb, arb, arb, arb]
) -> tuple[arb, arb, arb, arb]:
    """The product of two quaternions."""
    return (
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
        p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
    )


def is_steady(start: Start) -> bool:
    """Whether the motion is steady precession exactly: I1 = I3 and m g l = I1 phi' psi'."""
    if start.theta_rate != 0 or start.inertia1 != start.inertia3 or start.spin_is_omega3:
        return False
    product = Fraction(start.mass) * Fraction(start.gravity) * Fraction(start.length)
    rates = Fraction(start.phi_rate) * Fraction(start.spin)
    return product == Fraction(start.inertia1) * rates


def carlson(x: arb, y: arb, z: arb) -> arb:
    """Carlson's R_F of numbers that are not negative."""
    if not (x >= 0 and y >= 0 and z >= 0):
        raise UndecidedError("argument of R_F")
    return acb.elliptic_rf(x, y, z).real


def argument(value: acb, line: arb, jumps: arb) -> arb | None:
    """The continuous argument of a component; None where it may vanish."""
    turned = value * acb(0, -line).exp()
    if turned.contains(0):
        return None
    return jumps + line + turned.arg()


def checked(upper: acb, lower: acb, phi: arb | None, psi: arb | None) -> Answer:
    """The answer, unless its balls are too large."""
    theta = 2 * arb.atan2(abs(lower), abs(upper))
    values = [upper.real, lower.real, lower.imag, upper.imag, theta]
    if not all(value.is_finite() and value.rad() < RADIUS for value in values):
        raise UndecidedError("radius of the attitude")
    for angle in (phi, psi):
        if angle is not None and not angle.rad() < RADIUS * (1 + abs(angle).mid()):
            raise UndecidedError("radius of an angle")
    return Answer(tuple(values[:4]), theta, phi, psi)
