"""Rigid-body engines on the same six motions, each as its users would run it.

A script of an engine, in Python or JavaScript, has

* METHODS, the names of its methods, its best one among them;
* prepare(motion, method, step), which sets the body up at the start of a motion, and gives two
  functions: advance(n) takes n steps, state() gives the attitude and the angular velocity in the
  axes of the body; a NotImplementedError or Refusal says why the engine cannot do this motion;
* for methods whose settings are no step sizes, SETTINGS, which `step` then takes.

`common.py` and `common.mjs` run one script on one motion, in a process of its own.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Engine:
    """A row of the list: what the page calls an engine, its script, and its package."""

    name: str
    script: str
    package: str
    kind: str
    """What it is made for: `robots` (and mechanisms, vehicles), `games`, or `equations`."""

    @property
    def is_javascript(self) -> bool:
        """Whether node runs its script, and npm has its package."""
        return self.script.endswith(".mjs")


ENGINES = (
    Engine("spintop", "spintop.py", "", "equations"),
    Engine("SymPy and SciPy", "sympy_scipy.py", "scipy sympy", "equations"),
    Engine("MuJoCo", "mujoco.py", "mujoco", "robots"),
    Engine("MJX", "mjx.py", "mujoco-mjx", "robots"),
    Engine("Drake", "drake.py", "drake", "robots"),
    Engine("Exudyn", "exudyn.py", "exudyn", "robots"),
    Engine("Pinocchio", "pinocchio.py", "pin", "robots"),
    Engine("DART", "dart.py", "dartpy", "robots"),
    Engine("Brax", "brax.py", "brax", "robots"),
    Engine("Newton", "newton.py", "newton", "robots"),
    Engine("JSBSim", "jsbsim.py", "jsbsim", "robots"),
    Engine("PyBullet", "pybullet.py", "pybullet", "games"),
    Engine("ammo.js", "ammo.mjs", "ammo.js", "games"),
    Engine("Rapier", "rapier.mjs", "@dimforge/rapier3d-compat", "games"),
    Engine("Jolt", "jolt.mjs", "jolt-physics", "games"),
    Engine("Havok", "havok.mjs", "@babylonjs/havok", "games"),
    Engine("cannon-es", "cannon.mjs", "cannon-es", "games"),
)
