"""One widget for each number or choice that the controller lists."""

from collections.abc import Callable
from html import escape
from typing import Any, Protocol

import numpy as np
import viser

from limber.monitor.field_values import show
from limber.monitor.laws import Gain
from limber.monitor.pending import several
from limber.monitor.typed import Field, TypedFields

REACH = 4.0  # a slider goes so many times as far as the value it begins with
BELOW = "font-size:0.75em;line-height:1.25;opacity:0.8;margin:-2px 12px 4px 12px"
AXES = ("x", "y", "z")
Changed = Callable[[str, Any], None]


class Widget(Protocol):
    """`show` displays a value without sending it; `words` stand below it."""

    def show(self, value: Any, words: str = "") -> None: ...


def make(
    gui: viser.GuiApi,
    gain: Gain,
    start: Any,
    joints: list[str],
    changed: Changed,
    typed: TypedFields,
) -> Widget:
    """`start`: the value that holds now; `changed` is called with key and new value."""
    if gain.kind in ("choice", "switch"):
        return _Choice(gui, gain, start, changed)
    if gain.kind == "number":
        return _Number(gui, gain, gain.label, float(start), lambda v: changed(gain.key, v), typed)
    if gain.kind == "periods":
        return _Several(gui, gain, list(gain.words), start, changed, typed, as_mapping=True)
    if gain.kind == "tip_matrix":
        axes = [*AXES, *(f"about {axis}" for axis in AXES)]
        return _Several(gui, gain, axes, start, changed, typed, as_matrix=True)
    labels = list(AXES) if gain.kind == "blocks" else joints
    return _Several(gui, gain, labels, start, changed, typed)


def slider_end(gain: Gain, value: float) -> float:
    """Where a slider ends: the range if it is short, else some times the value."""
    if gain.high <= 10.0 or gain.high <= REACH * abs(value):
        return gain.high
    if value > 0:
        return float(min(gain.high, REACH * value))
    return float(min(gain.high, 100.0))


DECIMALS = 3  # of a typed number, at least


class _Number:
    """A slider; a value beyond its end moves the end."""

    def __init__(
        self,
        gui: viser.GuiApi,
        gain: Gain,
        label: str,
        start: float,
        changed: Callable[[float], None],
        typed: TypedFields,
    ) -> None:
        self._gain = gain
        end = slider_end(gain, start)
        whole = gain.kind == "periods"
        step = 1.0 if whole else max((end - gain.low) / 200, 1e-6)
        self.slider = gui.add_slider(
            label, float(gain.low), end, step, float(np.clip(start, gain.low, end)), hint=gain.hint
        )
        if not whole:
            self.slider.precision = max(self.slider.precision, DECIMALS)
        field = Field(self.slider, label, gain.low, gain.high, lambda v: self._typed(v, changed))
        typed.add(field)

        @self.slider.on_update
        async def _(event: viser.GuiEvent) -> None:
            if event.client is None:
                return
            value = self.slider.value
            if accepted(gain, value):
                self._shown = float(value)
                changed(float(value))
            else:
                show(self.slider, self._shown)
                typed.refused(field, value)

        self._shown = float(self.slider.value)

    def _typed(self, value: float, changed: Callable[[float], None]) -> None:
        self.show(value)
        changed(value)

    def show(self, value: float, _words: str = "") -> None:
        if not np.isfinite(value):
            return
        if value > self.slider.max:
            self.slider.max = float(min(max(self._gain.high, value), REACH * value))
        self._shown = round(float(value), self.slider.precision)
        show(self.slider, self._shown)


class _Several:
    """One slider for all components, and one for each in a folder."""

    def __init__(
        self,
        gui: viser.GuiApi,
        gain: Gain,
        labels: list[str],
        start: Any,
        changed: Changed,
        typed: TypedFields,
        as_mapping: bool = False,
        as_matrix: bool = False,
    ) -> None:
        self._gain, self._labels, self._changed = gain, labels, changed
        self._mapping, self._matrix = as_mapping, as_matrix
        self.values = self._components(start)
        mixed = as_mapping or as_matrix  # one number for all would mean nothing
        self._all = None
        if not mixed:
            largest = float(self.values.max())
            self._all = _Number(gui, gain, gain.label, largest, self._set_all, typed)
            self._below = gui.add_html("", visible=False)
        name = gain.label if mixed else "one by one"
        with gui.add_folder(name, expand_by_default=False):
            self._each = [
                _Number(gui, gain, label, float(value), self._setter(i), typed)
                for i, (label, value) in enumerate(zip(labels, self.values, strict=True))
            ]

    def _components(self, value: Any) -> np.ndarray:
        if isinstance(value, dict):
            value = [value.get(label, self._gain.low) for label in self._labels]
        array = np.asarray(value, float)
        if self._matrix and array.shape == (6, 6):
            array = np.diag(array)
        return np.broadcast_to(array, len(self._labels)).copy()

    def _setter(self, index: int) -> Callable[[float], None]:
        def set_one(value: float) -> None:
            self.values[index] = value
            self._send()

        return set_one

    def _set_all(self, value: float) -> None:
        self.values[:] = value
        self.show(self.values)
        self._send()

    def _send(self) -> None:
        values: Any = self.values.tolist()
        if self._mapping:
            values = {label: int(v) for label, v in zip(self._labels, values, strict=True)}
        elif self._matrix:
            values = np.diag(self.values).tolist()
        self._changed(self._gain.key, values)

    def show(self, value: Any, words: str = "") -> None:
        """One slider cannot show several numbers: then they stand below it."""
        self.values = self._components(value)
        for each, one in zip(self._each, self.values, strict=True):
            each.show(float(one))
        if self._all is None:
            return
        self._all.show(float(self.values.max()))
        numbers = several(self.values)
        if " / " in numbers:
            words = f"{numbers} {self._gain.unit}; this slider sets all alike. {words}"
        self._below.content = f'<div style="{BELOW}">{escape(words)}</div>'
        self._below.visible = bool(words)


class _Choice:
    def __init__(self, gui: viser.GuiApi, gain: Gain, start: Any, changed: Changed) -> None:
        self._words = gain.words
        if gain.kind == "switch":
            self._handle: Any = gui.add_checkbox(
                gain.label, start in (True, "true"), hint=gain.hint
            )
        else:
            first = start if start in gain.words else gain.words[0]
            self._handle = gui.add_dropdown(gain.label, gain.words, initial_value=first)
            self._handle.hint = gain.hint

        @self._handle.on_update
        async def _(event: viser.GuiEvent) -> None:
            if event.client is not None:
                changed(gain.key, self._handle.value)

    def show(self, value: Any, _words: str = "") -> None:
        if isinstance(value, bool) or value in self._words:
            self._handle.value = value


def accepted(gain: Gain, value: float) -> bool:
    """A browser may send anything; NaN fails."""
    return bool(gain.low <= value <= gain.high)
