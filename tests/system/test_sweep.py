"""`limber sweep` on a real scheduler and workers, each in a process of its own, that are killed."""

import io
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from limber import __version__
from limber.paths import programs_folder, robots_root

pytest.importorskip("distributed", reason="comes with ./limber test")
parquet = pytest.importorskip("pyarrow.parquet", reason="comes with ./limber test")

pytestmark = pytest.mark.lockstep
RUNS = 18
SCENARIO = """format: limber-scenario/1
robot: mine
duration_s: 2.2
friction: false
timeline:
  - {at_s: 0.3, mode: hold}
  - {at_s: 0.5, mode: active}
  - at_s: 0.7
    gains: {law: cartesian_impedance, K_x_translation_N_per_m: 300, K_x_rotation_Nm_per_rad: 0}
  - {at_s: 1.1, push: {force_N: [3, 0, 0], ramp_s: 0.1, for_s: 1}}
"""
VARY = ["--vary", "gains.K_x=20..3000:log", "--vary", "payload_kg=0..0.5", "--vary", "loss=0,2e-4"]
# Counts the labs: a worker's limber-lab is this script. With a gate none begins beyond its number.
COUNTED = """#!/bin/sh
while [ -e "{gate}" ] && [ "$(wc -l < "{counts}")" -ge "$(cat "{gate}")" ]; do sleep 0.02; done
"{program}" "$@"
code=$?
sed -n 's/^seed: //p' "$1" >> "{counts}"
exit $code
"""


class Bench:
    """Scheduler and workers; programs whose labs are counted, and an arm that no worker has."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.counts, self.gate = folder, folder / "counts", folder / "gate"
        self.counts.touch()
        shutil.copytree(robots_root() / "desktop2r", folder / "mine")
        self.scenario = folder / "soft.yaml"
        self.scenario.write_text(SCENARIO, encoding="utf-8")
        programs = folder / "programs"
        programs.mkdir()
        for program in programs_folder().glob("limber-*"):
            (programs / program.name).symlink_to(program)
        lab = programs / "limber-lab"
        lab.unlink()
        program = programs_folder() / lab.name
        lab.write_text(COUNTED.format(program=program, counts=self.counts, gate=self.gate))
        lab.chmod(0o755)
        (programs.parent / "lib").symlink_to(programs_folder().parent / "lib")
        self.environment = {**os.environ, "LIMBER_BIN": str(programs)}
        self.processes: list[subprocess.Popen] = []

    def start(self, *words: str, **environment: str) -> subprocess.Popen:
        with open(self.folder / f"process-{len(self.processes)}.log", "wb") as log:
            process = subprocess.Popen(
                [sys.executable, "-m", *words],
                stdout=log,
                stderr=subprocess.STDOUT,
                cwd=self.folder,
                env={**self.environment, **environment},
                start_new_session=True,
            )
        self.processes.append(process)
        return process

    def output(self, process: subprocess.Popen) -> str:
        number = self.processes.index(process)
        return (self.folder / f"process-{number}.log").read_text(encoding="utf-8")

    def scheduler(self) -> tuple[subprocess.Popen, str]:
        file = self.folder / f"scheduler-{len(self.processes)}.json"
        words = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--no-show")
        process = self.start("dask", "scheduler", *words, "--scheduler-file", str(file))
        self.until(file.exists, process)
        address = json.loads(file.read_text(encoding="utf-8"))["address"]
        return process, address

    def worker(self, address: str, **environment: str) -> subprocess.Popen:
        words = ("--nthreads", "1", "--no-nanny", "--no-dashboard")
        return self.start("dask", "worker", address, *words, **environment)

    def sweep(self, *words: str) -> subprocess.Popen:
        return self.start("limber", "sweep", *words)

    def begin(self, out: str, *words: str) -> subprocess.Popen:
        how = ("--runs", str(RUNS), "--out", out, *words)
        return self.sweep(str(self.scenario), *VARY, *how)

    def done(self, out: str) -> set[int]:
        """Runs that are on the disk. A piece may be replaced meanwhile, so each is opened once."""
        pieces = (self.folder / out / "runs").glob("piece-*.parquet")
        tables = [parquet.ParquetFile(io.BytesIO(piece.read_bytes())).read() for piece in pieces]
        return {run for table in tables for run in table["run"].to_pylist()}

    def whole(self, out: str) -> Path:
        return self.folder / out / "runs.parquet"

    def until(self, condition, process: subprocess.Popen) -> None:
        """As long as the process lives; nothing depends on how long it takes."""
        while not condition():
            assert process.poll() is None, self.output(process)
            time.sleep(0.02)

    def end(self, process: subprocess.Popen, code: int) -> str:
        assert process.wait(timeout=300) == code, self.output(process)
        return self.output(process)

    def close(self) -> None:
        for process in self.processes:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()


@pytest.fixture
def bench(tmp_path):
    made = Bench(tmp_path)
    yield made
    made.close()


def test_no_kill_loses_a_run_or_does_it_twice(bench):
    """Worker, client and scheduler are killed; the table is that of one local worker."""
    scheduler, address = bench.scheduler()
    first, _second = bench.worker(address), bench.worker(address)
    bench.gate.write_text("8", encoding="utf-8")
    client = bench.begin("killed", "--on", address)
    bench.until(lambda: len(bench.done("killed")) >= 2, client)
    first.kill()
    bench.until(lambda: len(bench.done("killed")) >= 5, client)
    client.kill()
    client.wait()
    kept = bench.done("killed")
    assert 5 <= len(kept) < RUNS
    counted = len(bench.counts.read_text(encoding="utf-8").split())

    bench.gate.write_text(str(counted + 5), encoding="utf-8")
    client = bench.sweep("killed", "--resume", "--on", address)
    bench.until(lambda: len(bench.done("killed")) >= len(kept) + 2, client)
    scheduler.kill()
    told = bench.end(client, 3)
    assert f"limber sweep killed --resume --on {address}" in told, told
    assert f"limber: the scheduler at {address} has gone" in told, told
    assert "Traceback" not in told, told

    bench.gate.unlink()
    told = bench.end(bench.sweep("killed", "--resume", "--processes", "2"), 0)
    assert f"of {RUNS} runs are there" in told and "holds" in told, told
    assert (bench.folder / "killed" / "sweep.png").exists()
    rows = parquet.read_table(bench.whole("killed")).to_pylist()
    assert [row["run"] for row in rows] == list(range(RUNS))
    again = bench.counts.read_text(encoding="utf-8").split()[counted:]
    assert not {str(row["seed"]) for row in rows if row["run"] in kept} & set(again)
    assert {row["outcome"] for row in rows} >= {"holds", "out of tolerance"}

    bench.end(bench.begin("alone", "--processes", "1"), 0)
    assert bench.whole("alone").read_bytes() == bench.whole("killed").read_bytes()

    told = bench.end(bench.sweep("killed", "--replay", "3"), 0)
    assert "not as in the table" not in told
    assert {"summary.json", "run.lcmlog.zst", "overview.png"} <= {
        path.name for path in (bench.folder / "killed" / "run_3-1").iterdir()
    }


def test_ctrl_c_ends_in_good_order_and_the_same_words_go_on(bench):
    """Half of the runs have a law that the controller refuses: rows as all others."""
    laws = ("--vary", "gains.law=cartesian_impedance,admittance")
    client = bench.begin("stopped", *laws, "--processes", "2")
    bench.until(lambda: bench.done("stopped"), client)
    os.killpg(client.pid, signal.SIGINT)  # as a terminal does
    told = bench.end(client, 130)
    assert "runs are kept; go on with: limber sweep stopped --resume" in told, told
    assert len(told.splitlines()) == 2, told  # how far it came, and the command
    kept = len(bench.done("stopped"))
    told = bench.end(bench.begin("stopped", *laws), 2)
    assert told == "limber: stopped holds a sweep already: --resume goes on with it\n"
    told = bench.end(bench.begin("stopped", *laws, "--resume", "--seed", "2"), 2)
    assert told == "limber: stopped is another sweep: seed: 1 there, 2 here; give another --out\n"
    told = bench.end(bench.begin("stopped", *laws, "--resume"), 0)
    assert f"{kept} of {RUNS} runs are there" in told
    rows = parquet.read_table(bench.whole("stopped")).to_pylist()
    refused = [row for row in rows if row["gains.law"] == "admittance"]
    assert len(refused) == RUNS / 2 and {row["outcome"] for row in refused} == {"refused"}
    assert all("request." in row["reason"] for row in refused), refused[0]
    assert "refused" not in {row["outcome"] for row in rows if row not in refused}


def test_a_worker_of_another_version_is_refused_by_name(bench):
    other = bench.folder / "other" / "limber_arm-9.9.dist-info"
    other.mkdir(parents=True)
    (other / "METADATA").write_text("Metadata-Version: 2.1\nName: limber-arm\nVersion: 9.9\n")
    _, address = bench.scheduler()
    bench.worker(address, PYTHONPATH=str(other.parent))
    told = bench.end(bench.begin("refused", "--on", address), 3)
    assert f"limber 9.9; this machine has {__version__}" in told, told
    assert not bench.done("refused") and not bench.counts.read_text(encoding="utf-8")
