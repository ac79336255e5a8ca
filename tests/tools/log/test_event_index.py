"""All events at once, or one by one: the same places."""

import mmap

import numpy as np
import pytest
from made_logs import event_bytes

from limber.log import event_index
from limber.log.event_file import SYNC, Damage


def mapped(tmp_path, content: bytes) -> mmap.mmap:
    path = tmp_path / "log"
    path.write_bytes(content)
    with open(path, "rb") as file:
        return mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)


def random_log(seed: int) -> list[bytes]:
    """Channels of different lengths, messages of 0 to 2000 bytes."""
    random = np.random.default_rng(seed)
    names = ["A", "B", "LONGER", "LINGER", "LINGE\0", "OF_FOURTEEN_BY"]
    sizes = random.integers(0, 2000, 400)
    return [
        event_bytes(str(random.choice(names)), random.bytes(size), i, 1000 * i)
        for i, size in enumerate(sizes)
    ]


def require_same(at_once, one_by_one):
    assert list(at_once) == list(one_by_one)
    for name, found in at_once.items():
        for key in ("offsets", "sizes", "stamps_us"):
            assert np.array_equal(getattr(found, key), getattr(one_by_one[name], key))


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("piece", [100, event_index.PIECE])  # sync words across two pieces
def test_both_find_the_same(tmp_path, monkeypatch, seed, piece):
    monkeypatch.setattr(event_index, "PIECE", piece)
    data = mapped(tmp_path, b"".join(random_log(seed)))
    at_once = event_index._all_at_once(np.frombuffer(data, np.uint8))
    assert sum(map(len, at_once.values())) == 400
    require_same(at_once, event_index._one_by_one(data, Damage()))


LOG = random_log(7)
WHOLE = b"".join(LOG)
BAD = {
    "a sync word in a message": b"".join([*LOG, event_bytes("A", b"123" + SYNC + bytes(9)), *LOG]),
    "bytes before": b"xy" + WHOLE,
    "bytes between": b"".join([*LOG[:9], b"xy", *LOG[9:]]),
    "bytes behind": WHOLE + b"xy",
    "cut in a message": WHOLE[:-1],
    "cut in a header": WHOLE + LOG[0][:20],
    "cut in a sync word": WHOLE + SYNC[:3],
    "a name beyond ASCII": WHOLE + event_bytes("A", b"1").replace(b"A", b"\xe4"),
    "a negative size": WHOLE + SYNC + bytes(8 + 8) + b"\0\0\0\1" + b"\xff\xff\xff\xff" + b"A",
}


@pytest.mark.parametrize("content", BAD.values(), ids=BAD)
def test_in_any_other_log_they_are_found_one_by_one(tmp_path, content):
    data, damage, by_one = mapped(tmp_path, content), Damage(), Damage()
    assert event_index._all_at_once(np.frombuffer(data, np.uint8)) is None
    require_same(event_index.index(data, damage), event_index._one_by_one(data, by_one))
    assert damage == by_one
