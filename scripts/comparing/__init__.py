"""Other programs on the motions of spintop, each in a process of its own, measured in one way.

`programs/NAME.py` imports what it measures, and has

* VERSIONS, what is used;
* where it solves initial value problems: METHODS, FORMULATIONS (the equations that it gets) and
  SETTINGS, the cheapest first; solve(problem, method, formulation, setting), an Answer;
* where it is an engine: STEPPERS, the names of its methods, and prepare(problem, method, step),
  which sets the body up and gives two functions: advance(n) takes n steps, state() gives the
  attitude and the angular velocity in body axes. A NotImplementedError says why it cannot do it.
  Settings are steps per second, unless OWN_SETTINGS has those of a method, and step() takes them;
* where it integrates many bodies at once: BATCHES, and solve_batch(t_end, every, method, setting).
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Program:
    """A program that is measured: its name, its module, and what it is installed from."""

    name: str
    module: str
    pip: tuple[str, ...] = ()
    debian: tuple[str, ...] = ()


SOLVERS = (
    Program("SciPy", "scipy", ("scipy==1.17.1",)),
    Program("heyoka", "heyoka", ("heyoka==7.13.2", "numpy")),
    Program("Boost.odeint", "odeint", (), ("g++", "libboost-dev")),
    Program("SUNDIALS", "sundials", (), ("gcc", "libsundials-dev")),
    Program("MuJoCo", "mujoco", ("mujoco==4.0.0",)),
)
"""Those that solve initial value problems, beside spintop's own study."""
ENGINES = (
    Program("spintop", "spintop"),
    SOLVERS[0],
    SOLVERS[-1],
    Program("Drake", "drake", ("drake==1.51.1",)),
    Program("Exudyn", "exudyn", ("exudyn==1.13.6", "scipy==1.17.1")),
)
"""Those that step a rigid body of their own."""
