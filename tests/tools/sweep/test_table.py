"""Rows on the disk at once, each once, and one table in the end, whatever the order."""

import pytest

parquet = pytest.importorskip("pyarrow.parquet", reason="comes with ./limber test")

from limber.errors import InputError  # noqa: E402
from limber.sweep.table import PIECE, Table  # noqa: E402
from limber.sweep.variation import parse  # noqa: E402

VARY = (parse("a.b_kg=0..1"), parse("n=1..9:whole"), parse("w=x,y"))


def row(run: int, **more) -> dict:
    word = "xy"[run % 2]
    return {"run": run, "seed": run, "a.b_kg": 0.1 * run, "n": run, "w": word, **more}


def test_what_was_added_is_there_after_a_kill(tmp_path):
    table = Table(tmp_path, VARY)
    for run in (3, 1, 2):
        table.add([row(run, outcome="holds", overshoot=None)])
    again = Table(tmp_path, VARY)  # nothing was closed
    assert again.done == {1, 2, 3}
    again.add([row(0), row(2, outcome="fault")])
    kept = again.rows().to_pylist()
    assert [found["run"] for found in kept] == [0, 1, 2, 3]
    assert kept[2]["outcome"] == "holds", "a run that is there stays as it was"
    assert [found["w"] for found in kept] == ["x", "y", "x", "y"]
    assert kept[1]["overshoot"] is None and kept[1]["a.b_kg"] == 0.1


def test_the_whole_does_not_depend_on_the_order(tmp_path):
    wholes = []
    for number, order in enumerate((range(2 * PIECE + 5), reversed(range(2 * PIECE + 5)))):
        folder = tmp_path / str(number)
        folder.mkdir()
        table = Table(folder, VARY)
        runs = list(order)
        for first in range(0, len(runs), 100):
            table.add([row(run) for run in runs[first : first + 100]])
        assert len(list(folder.glob("runs/*"))) == 2
        Table(folder, VARY).finish()
        assert [path.name for path in folder.iterdir()] == ["runs.parquet"]
        assert Table(folder, VARY).done == set(range(2 * PIECE + 5))
        wholes.append((folder / "runs.parquet").read_bytes())
    assert wholes[0] == wholes[1]


def test_half_a_piece_is_named(tmp_path):
    Table(tmp_path, VARY).add([row(1)])
    (piece,) = tmp_path.glob("runs/piece-*")
    piece.write_bytes(piece.read_bytes()[:-20])
    with pytest.raises(InputError, match=rf"{piece} cannot be read: .*remove it"):
        Table(tmp_path, VARY)
