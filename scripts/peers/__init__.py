"""Other programs on the same problems, measured as spintop measures itself.

A peer is a module with

* NAME, and METHODS, the names of its methods in the table;
* FORMULATIONS, the names of the equations that it is tried with, of those that suit the problem;
* DEBIAN, the packages that it is in, where it is not from PyPI;
* SETTINGS, what its methods are tried with, the cheapest first;
* SETTING, what these are, `tolerance` or `steps`;
* absence(), why it cannot be had here, empty if it can, and versions(), what is used,
  made ready;
* solve(problem, method, formulation, setting), an Answer;
* where it integrates many bodies at once, BATCHES, the names of the ways it does so, and
  solve_batch(t_end, every, method, setting), a BatchAnswer.

`worker` runs one in a process of its own, so that it may crash or hang; `crew` starts and stops
these.
"""

PEERS = ("scipy", "heyoka", "odeint", "octave", "sundials", "mujoco")
"""The modules are of these names with `_peer` after them."""
