"""Play, pause, speed and place in a recorded run, with what happened when."""

from html import escape

import viser

from limber.log.events import Event, Names, events
from limber.log.reader import Log
from limber.monitor.field_values import show
from limber.monitor.laws import LawList
from limber.monitor.log_feed import SPEEDS, LogFeed
from limber.monitor.server import Server
from limber.monitor.typed import Field, TypedFields

MOST_MARKS = 60
AROUND = 6  # events listed before and after the place


class PlaybackPanel:
    def __init__(
        self,
        server: Server,
        feed: LogFeed,
        log: Log,
        joints: list[str],
        laws: LawList,
        typed: TypedFields,
    ) -> None:
        gui, self._feed = server.gui, feed
        self._events = events(log, Names(joints, [law.name for law in laws.laws]))
        self._play = gui.add_button("play", icon=viser.Icon.PLAYER_PLAY)
        labels = tuple(f"{speed:g}x" for speed in SPEEDS)
        speeds = dict(zip(labels, SPEEDS, strict=True))
        self._speed = gui.add_dropdown("speed", labels, initial_value="1x")
        self._slider = gui.add_slider(
            "time s",
            feed.start_s,
            max(feed.end_s, feed.start_s + 0.01),
            0.01,
            feed.start_s,
            marks=tuple(_marks(self._events, feed)),
        )
        typed.add(Field(self._slider, "time s", feed.start_s, feed.end_s, feed.jump))
        self._jumps = gui.add_button_group("event", ("previous", "next", "next fault"))
        self._list = gui.add_html("")

        @self._play.on_click
        async def _(_event: viser.GuiEvent) -> None:
            self._play_or_pause()

        @self._speed.on_update
        async def _(_event: viser.GuiEvent) -> None:
            feed.speed = speeds.get(self._speed.value, 1.0)

        @self._slider.on_update
        async def _(event: viser.GuiEvent) -> None:
            if event.client is not None and self._slider.value == self._slider.value:
                feed.jump(float(self._slider.value))

        @self._jumps.on_click
        async def _(event: viser.GuiEvent) -> None:
            self._to_event(event.target.value)

        command = gui.add_command("play or pause", hotkey="space")

        @command.on_trigger
        async def _(_event: viser.CommandEvent) -> None:
            self._play_or_pause()

    def _play_or_pause(self) -> None:
        """At the end: from the beginning."""
        if self._feed.position_s >= self._feed.end_s:
            self._feed.jump(self._feed.start_s)
        self._feed.playing = not self._feed.playing

    def _to_event(self, which: str) -> None:
        now, margin = self._feed.position_s, 0.01
        if which == "previous":
            found = [e.time_s for e in self._events if e.time_s < now - margin][-1:]
        else:
            later = [e for e in self._events if e.time_s > now + margin]
            found = [e.time_s for e in later if e.bad or which == "next"][:1]
        if found:
            self._feed.jump(found[0])

    def draw(self) -> None:
        feed = self._feed
        show(self._slider, round(feed.position_s, 2))
        word = "pause" if feed.playing else "play"
        if self._play.label != word:
            self._play.label = word
            self._play.icon = viser.Icon.PLAYER_PAUSE if feed.playing else viser.Icon.PLAYER_PLAY
        content = event_list(self._events, feed.position_s)
        if content != self._list.content:
            self._list.content = content


def _marks(found: list[Event], feed: LogFeed) -> list[tuple[float, str]]:
    """A dot for an event, ! for what is wrong. Faults come first where there are too many."""
    inside = [event for event in found if feed.start_s <= event.time_s <= feed.end_s]
    chosen = sorted(inside, key=lambda event: not event.bad)[:MOST_MARKS]
    marks = {round(event.time_s, 2): "" for event in chosen}
    marks |= {round(event.time_s, 2): "!" for event in chosen if event.bad}
    return sorted(marks.items())


def event_list(found: list[Event], now_s: float) -> str:
    """The events around a time; those that are still to come are pale."""
    at = sum(event.time_s <= now_s for event in found)
    shown = found[max(at - AROUND, 0) : at + AROUND]
    rows = []
    for event in shown:
        past = event.time_s <= now_s
        color = "#c62828" if event.bad else "inherit"
        rows.append(
            f'<tr style="opacity:{1 if past else 0.45};color:{color};vertical-align:top">'
            f'<td style="text-align:right;padding-right:6px">{event.time_s:.2f}</td>'
            f'<td style="padding-right:6px">{escape(event.who)}</td>'
            f"<td>{escape(event.text)}</td></tr>"
        )
    return f'<table style="margin:4px 10px;font-size:0.8em;line-height:1.3">{"".join(rows)}</table>'
