"""C++ and Python make the same of the same bytes: of every type, whole or garbled."""

import random
import struct
import subprocess
from pathlib import Path

import pytest

from limber import messages
from limber.paths import ROOT

CORPUS = ROOT / "tests" / "fuzz" / "corpus" / "messages"
DECODER = ROOT / "build" / "asan" / "fuzz" / "decode_messages"
TYPES = sorted(path.stem for path in (ROOT / "lcmtypes").glob("*.lcm"))
GARBLED = 20_000
REFUSED = 0xFFFFFFFF


def garbled(inputs: list[bytes], count: int, seed: int) -> list[bytes]:
    """Mostly a byte or four changed, sometimes cut or lengthened; the type byte stays."""
    choose = random.Random(seed)
    made = []
    for _ in range(count):
        data = bytearray(choose.choice(inputs))
        for _ in range(choose.randint(1, 3)):
            at = choose.randrange(1, len(data))
            kind = choose.randrange(6)
            if kind < 3:
                data[at] = choose.randrange(256)
            elif kind == 3:
                data[at : at + 4] = struct.pack(">i", choose.choice([-1, 0, 1, 5, -(2**31)]))
            elif kind == 4:
                del data[at : at + choose.randrange(1, 9)]
            else:
                data[at:at] = bytes(choose.randrange(256) for _ in range(choose.randrange(1, 5)))
            if len(data) < 2:
                data += b"\0"
        made.append(bytes(data))
    return made


def by_cpp(inputs: list[bytes]) -> list[bytes | None]:
    request = b"".join(struct.pack("<I", len(data)) + data for data in inputs)
    answer = subprocess.run([DECODER], input=request, capture_output=True, check=True).stdout
    results: list[bytes | None] = []
    while answer:
        (size,) = struct.unpack_from("<I", answer)
        refused = size == REFUSED
        results.append(None if refused else answer[4 : 4 + size])
        answer = answer[4 if refused else 4 + size :]
    return results


def by_python(data: bytes) -> bytes | None:
    try:
        return messages.decode(TYPES[data[0] % len(TYPES)], data[1:]).encode()
    except ValueError:
        return None


@pytest.fixture(scope="module")
def kept() -> list[bytes]:
    """Type byte and message: the corpus leaves the fingerprint out."""
    inputs = [path.read_bytes() for path in sorted(CORPUS.iterdir())]
    return [data[:1] + fingerprint(data[0]) + data[1:] for data in inputs]


def fingerprint(number: int) -> bytes:
    return messages.message_class(TYPES[number % len(TYPES)])().encode()[:8]


def no_python_writes(data: bytes) -> bool:
    """Text that is no UTF-8, and NaN that signals: C++ keeps their bits, Python does not."""
    message = messages.message_class(TYPES[data[0] % len(TYPES)]).decode(data[1:])
    fields = [getattr(message, name) for name in message.__slots__]
    fields += [parameter.key for parameter in getattr(message, "parameters", ())]
    fields += [text for texts in fields if isinstance(texts, list | tuple) for text in texts]
    if any("\ufffd" in text for text in fields if isinstance(text, str)):
        return True
    pairs = zip(data[1:], message.encode(), strict=True)
    return all(ours == theirs or theirs == ours | 0x40 for ours, theirs in pairs)


def test_kept_inputs_are_messages_in_both(kept):
    whole = [data for data in kept if by_python(data) is not None]
    missing = set(TYPES) - {TYPES[data[0]] for data in whole}
    assert not missing, "their types have changed; run: .venv/bin/python tests/fuzz/make_corpus.py"
    assert by_cpp(whole) == [data[1:] for data in whole] == [by_python(data) for data in whole]


@pytest.mark.parametrize("seed", [1, 2])
def test_garbled_inputs_have_one_verdict(kept, seed):
    inputs = garbled(kept, GARBLED // 2, seed)
    accepted = 0
    for data, cpp in zip(inputs, by_cpp(inputs), strict=True):
        python = by_python(data)
        if cpp is None:
            assert python is None, data.hex()
        elif cpp == data[1:]:
            assert python == cpp or no_python_writes(data), data.hex()
            accepted += 1
    assert GARBLED / 20 < accepted < GARBLED / 2


def test_the_decoder_is_there():
    assert Path(DECODER).exists(), "run: ./limber dev fuzz"
