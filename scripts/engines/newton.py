"""Newton, on the processor (Warp), in single precision; without damping.

Its solver of MuJoCo Warp is left out: it is built for many worlds on a GPU.
"""

import newton
import warp as wp

from peers.quaternion import conjugate, to_space

METHODS = ("Featherstone", "SemiImplicit", "XPBD")


def make_model(motion: dict) -> newton.Model:
    """One body, on a ball joint if it has a fixed point."""
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, -motion["gravity"]))
    w, x, y, z = motion["quaternion"]
    inertia = wp.mat33(
        *(motion["inertia"][i] if i == j else 0.0 for i in range(3) for j in range(3))
    )
    settings = {"com": wp.vec3(*motion["arm"]), "inertia": inertia, "mass": motion["mass"]}
    start = wp.transform((0.0, 0.0, 0.0), wp.quat(x, y, z, w))
    if motion["is_top"]:
        body = builder.add_link(xform=start, **settings)
        builder.add_articulation([builder.add_joint_ball(-1, body)])
    else:
        body = builder.add_body(xform=start, **settings)
    builder.joint_q[-4:] = [x, y, z, w]
    return builder.finalize(device="cpu")


def make_solver(model: newton.Model, method: str) -> object:
    """The solver of this name."""
    return getattr(newton.solvers, f"Solver{method}")(model, angular_damping=0.0)


def prepare(motion: dict, method: str, step: float) -> tuple:
    """The body at its start. Coordinates are those of joints, or of bodies, as the solver has."""
    model = make_model(motion)
    solver = make_solver(model, method)
    states = [model.state(), model.state()]
    control = model.control()
    for state in states:
        joint = state.joint_qd.numpy()
        joint[-3:] = to_space(motion["quaternion"], motion["omega"])
        state.joint_qd.assign(joint)
        newton.eval_fk(model, state.joint_q, state.joint_qd, state)

    def advance(n: int) -> None:
        for _ in range(n):
            states[0].clear_forces()
            solver.step(states[0], states[1], control, None, step)
            states.reverse()

    def state() -> list:
        x, y, z, w = (float(part) for part in states[0].body_q.numpy()[0][3:])
        spin = [float(part) for part in states[0].body_qd.numpy()[0][3:]]
        return [w, x, y, z, *to_space(conjugate([w, x, y, z]), spin)]

    return advance, state
