"""Record a push at full rate, then draw force and displacement."""

import sys
import time
from pathlib import Path

import matplotlib.pyplot as plt

from limber import Arm
from limber.log.reader import Log, time_s

folder = Path(sys.argv[1] if len(sys.argv) > 1 else f"out/push-{time.strftime('%H%M%S')}")
with Arm() as arm:
    arm.activate()
    arm.gains(law="cartesian_impedance", K_x_translation_N_per_m=400)
    with arm.record(folder / "push.lcmlog.zst") as recording:
        arm.push([0, 9, 0], for_s=1.0, ramp_s=0.1)
        arm.wait(for_s=2.0)
print(f"{recording.path}: {recording.lost or 'no message'} lost")

log = Log(recording.path)
status, truth = log.read("CONTROLLER_STATUS"), log.read("SIM_TRUTH")
figure, (above, below) = plt.subplots(2, sharex=True, layout="constrained")
above.plot(time_s(truth), truth["F_push"][:, 1])
above.set_ylabel("push along y, N")
below.plot(time_s(status), 1e3 * status["e"][:, 1])
below.set(ylabel="pose error along y, mm", xlabel="arm time, s")
figure.savefig(folder / "push.png", dpi=120)
print(f"{folder / 'push.png'}: drawn")
