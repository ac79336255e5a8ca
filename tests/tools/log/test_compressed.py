"""A compressed log is read as the plain one; of a damaged one, every whole block."""

import io

import numpy as np
import pytest
import zstandard
from made_logs import event_bytes, records
from rich.console import Console

from limber.errors import InputError, RunError
from limber.log import compressed
from limber.log.convert import conversion
from limber.log.events import Names
from limber.log.reader import Log

COUNT, A_BLOCK = 60, 10


def states():
    made = records("joint_state_t", COUNT)
    made["q"] = np.random.default_rng(7).normal(size=made["q"].shape)
    return made


def blocks() -> list[bytes]:
    """Each of ten whole events."""
    events = [event_bytes("JOINT_STATE", row.tobytes(), i, i) for i, row in enumerate(states())]
    return [b"".join(events[i : i + A_BLOCK]) for i in range(0, COUNT, A_BLOCK)]


def frames() -> list[bytes]:
    compressor = zstandard.ZstdCompressor(write_checksum=True)
    return [compressor.compress(block) for block in blocks()]


@pytest.fixture
def write(tmp_path):
    def write(data: bytes, name: str = "run.lcmlog.zst"):
        (tmp_path / name).write_bytes(data)
        return tmp_path / name

    return write


def numbers(path) -> list[int]:
    return Log(path).read("JOINT_STATE")["seq"].tolist()


def test_reads_as_the_plain_log(write):
    log = Log(write(b"".join(frames())).parent)
    plain = Log(write(b"".join(blocks()), "plain.lcmlog"))
    np.testing.assert_array_equal(log.read("JOINT_STATE"), plain.read("JOINT_STATE"))
    assert log.damage() == ""
    assert log.path.name == "run.lcmlog.zst"


def test_converts_to_the_plain_log_byte_for_byte(write):
    path = write(b"".join(frames()))
    conversion.convert(path, "lcm", None, [], Names([], []), Console(file=io.StringIO()))
    assert path.with_name("run.lcmlog").read_bytes() == b"".join(blocks())


def test_cut_off_anywhere_every_whole_block_is_read(write):
    """As after a power failure."""
    made = frames()
    ends = np.cumsum([len(frame) for frame in made])
    rng = np.random.default_rng(1)
    for cut in [*rng.integers(int(ends[0]), int(ends[-1]), 40), *ends, *(ends - 1)[1:]]:
        whole = int((ends <= cut).sum())
        log = Log(write(b"".join(made)[: int(cut)]))
        kept = log.read("JOINT_STATE")["seq"]
        assert len(kept) >= whole * A_BLOCK
        np.testing.assert_array_equal(kept, np.arange(len(kept)))
        unfinished = int(cut) - (int(ends[whole - 1]) if whole else 0)
        told = f"the last block is cut off ({unfinished} bytes)" in log.damage()
        assert told == bool(unfinished)


@pytest.mark.parametrize("piece", [1 << 17, 1])
@pytest.mark.parametrize("place", [0, 3, 100, 1000, -1])
def test_a_damaged_block_costs_that_block_only(write, place, piece, monkeypatch):
    """No number in it is believed: in the middle of a frame only the checksum tells. A frame that
    is read in several pieces has been unpacked by then.
    """
    monkeypatch.setattr(compressed, "PIECE", piece)
    made = frames()
    hurt = bytearray(made[2])
    hurt[place] ^= 0x10
    path = write(b"".join([*made[:2], bytes(hurt), *made[3:]]))
    assert numbers(path) == [*range(20), *range(30, COUNT)]
    assert f"{len(hurt)} damaged compressed bytes skipped" in Log(path).damage()


def test_garbage_between_blocks_and_behind_them(write):
    made = frames()
    path = write(b"".join([*made[:3], b"\x28\xb5\x2f\xfd garbage", *made[3:], bytes(4096)]))
    assert numbers(path) == list(range(COUNT))
    assert "damaged compressed bytes skipped" in Log(path).damage()


def test_one_frame_made_by_zstd_itself(write):
    """`zstd run.lcmlog`; cut off, it is read as far as it goes."""
    many = records("joint_state_t", 3000)
    many["q"] = np.random.default_rng(3).normal(size=many["q"].shape)
    plain = b"".join(event_bytes("JOINT_STATE", row.tobytes()) for row in many)
    packed = zstandard.ZstdCompressor(level=3).compress(plain)
    path = write(packed)
    assert numbers(path) == list(range(3000))
    path.write_bytes(packed[: len(packed) // 2])
    kept = numbers(path)
    assert kept == list(range(len(kept))) and 1000 < len(kept) < 2000


@pytest.mark.parametrize("data", [b"no compressed log", b"\x28\xb5\x2f\xfd", bytes(100)])
def test_no_compressed_log(write, data):
    with pytest.raises(InputError, match="no compressed log"):
        Log(write(data))


def test_no_room_to_unpack(write, monkeypatch):
    class Full(io.BytesIO):
        def write(self, _data):
            raise OSError(28, "No space left on device")

    monkeypatch.setattr("tempfile.TemporaryFile", Full)
    with pytest.raises(RunError, match=r"No space left on device; set TMPDIR"):
        Log(write(b"".join(frames())))
