"""JSBSim: an aircraft without wings over a planet that does not rotate, in double precision.

Methods of its rotation are set in pairs, one for the angular velocity and one for the quaternion.
"""

import tempfile
from pathlib import Path

import jsbsim
import numpy as np
from scipy.spatial.transform import Rotation

RATE, POSITION = (f"simulation/integrator/{name}/rotational" for name in ("rate", "position"))
METHODS = {
    "default": {},
    "Adams-Bashforth 4": {RATE: 5, POSITION: 5},
    "Adams-Bashforth 2, Buss 2": {RATE: 3, POSITION: 7},
}
AIRCRAFT = """\
<fdm_config name="body" version="2.0"> <metrics/>
  <mass_balance>
    <ixx unit="KG*M2">{0!r}</ixx> <iyy unit="KG*M2">{1!r}</iyy> <izz unit="KG*M2">{2!r}</izz>
    <emptywt unit="KG">{mass!r}</emptywt>
    <location name="CG" unit="M"> <x>0</x> <y>0</y> <z>0</z> </location>
  </mass_balance>
<ground_reactions/> <propulsion/> <aerodynamics/> </fdm_config>
"""
PLANET = '<planet><rotation_rate unit="RAD/SEC">0</rotation_rate></planet>\n'


def prepare(motion: dict, method: str, step: float) -> tuple:
    """A body that falls from a great height, where nothing else acts on it."""
    if motion["is_top"]:
        raise NotImplementedError("it has no joints")
    sim = jsbsim.FGFDMExec(None)
    sim.set_debug_level(0)
    with tempfile.TemporaryDirectory() as name:
        aircraft, planet = Path(name) / "body/body.xml", Path(name) / "planet.xml"
        aircraft.parent.mkdir()
        aircraft.write_text(AIRCRAFT.format(*motion["inertia"], mass=motion["mass"]))
        planet.write_text(PLANET)
        sim.load_planet(str(planet), False)
        sim.set_aircraft_path(name)
        sim.load_model("body")
    for key, value in METHODS[method].items():
        sim[key] = value
    sim.set_dt(step)
    sim["ic/h-sl-ft"] = 1e6
    for name, value in zip("pqr", motion["omega"], strict=True):
        sim[f"ic/{name}-rad_sec"] = value
    sim.run_ic()
    start = sim.get_propagate().get_Tec2b()

    def advance(n: int) -> None:
        for _ in range(n):
            sim.run()

    def state() -> list:
        turn = Rotation.from_matrix(np.array(start @ sim.get_propagate().get_Tec2b().T))
        rates = [sim[f"velocities/{name}i-rad_sec"] for name in "pqr"]
        return [*turn.as_quat(scalar_first=True), *rates]

    return advance, state
