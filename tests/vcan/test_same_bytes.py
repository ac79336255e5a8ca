"""An arm of each family of drives over the kernel's CAN gives the bytes of the lab.

Frames on vcan have no stamps of the simulated wire: a reply between the end of the window and the
end of the period is in time there. These arms have none.
"""

import pytest

from same_bytes import expect_equal, of_the_lab, of_three_processes, shortened

BUSES = {
    "desktop2r_push": ["arm=socketcan:vcan0"],
    "planar2r_push": ["arm=socketcan:vcan0"],
    "iiwa14_push": ["shoulder=socketcan:vcan0", "wrist=socketcan:vcan1"],
}


@pytest.mark.parametrize("name", BUSES)
def test_same_bytes(name, tmp_path):
    scenario = shortened(name, 2.0, tmp_path)
    options = [word for bus in BUSES[name] for word in ("--bus", bus)]
    lab = of_the_lab(scenario, tmp_path)
    expect_equal(of_three_processes(scenario, tmp_path / "run", *options), lab, name)
