"""Numbers from a script, checked before they become a message."""

from collections.abc import Iterable
from difflib import get_close_matches

import numpy as np
from numpy.typing import ArrayLike

from limber.arrays import Floats
from limber.errors import InputError
from limber.live.meant import meant


def numbers(
    key: str, value: ArrayLike, shape: tuple[int, ...], one_for_all: bool = False
) -> Floats:
    """`value` as finite floats of `shape`; with `one_for_all` a single number stands for each."""
    try:
        given = np.asarray(value, float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{key}: {value!r} is no number or array of numbers") from error
    if one_for_all and given.ndim == 0:
        given = np.full(shape, given)
    if given.shape != shape:
        wanted = " x ".join(map(str, shape)) or "one"
        raise InputError(f"{key}: expected {wanted} numbers, got shape {given.shape}")
    if not np.isfinite(given).all():
        raise InputError(f"{key}: {value!r} is not finite")
    return given


def number(key: str, value: float, low: float = -np.inf, high: float = np.inf) -> float:
    """`value`, if it is finite and within low..high."""
    given = float(numbers(key, value, ()))
    if not low <= given <= high:
        raise InputError(f"{key}: {given:g} is out of range; expected {low:g} to {high:g}")
    return given


def unit(key: str, value: ArrayLike, size: int) -> Floats:
    """A vector of length 1 within rounding, made exactly so."""
    given = numbers(key, value, (size,))
    length = float(np.linalg.norm(given))
    if not abs(length - 1.0) <= 1e-3:
        raise InputError(f"{key}: has length {length:g}; expected 1")
    exact: Floats = given / length
    return exact


def one_of(what: str, word: str, known: Iterable[str]) -> str:
    """`word`, if it is known; else an error with what it may mean, or all."""
    known = list(known)
    if word in known:
        return word
    near = [one for one in known if str(word) in one.split("_")]  # of a part, all that have it
    near = near or get_close_matches(str(word), known, 1)
    hint = f"did you mean {' or '.join(map(repr, near))}?"
    if not near:
        hint = f"expected one of: {', '.join(known)}"
        if meant(str(word)):
            hint = f"as a request it is {meant(str(word))}"
    raise InputError(f"{what} {word!r} is not known; {hint}")
