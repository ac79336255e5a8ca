"""Mode, faults and limits at the top of the page."""

from html import escape

import viser

from limber.monitor.words import BAD, GOOD, WARN, Note, Situation
from limber.problems import MORE

COLORS = {GOOD: "#1a7f4b", WARN: "#b26a00", BAD: "#c62828"}
CARD = "border-radius:8px;padding:10px 14px;color:#fff;margin:2px 0 6px 0"
NOTE = "border-left:4px solid {};padding:2px 8px;margin:6px 0;font-size:0.85em;line-height:1.35"


class StatusCard:
    def __init__(self, gui: viser.GuiApi) -> None:
        self._html = gui.add_html("")

    def show(self, now: Situation, facts: list[str], hints: list[str]) -> None:
        """`facts`: short, such as the law; `hints`: what was lost or could not be read."""
        content = card(now, facts, hints)
        if content != self._html.content:
            self._html.content = content


def card(now: Situation, facts: list[str], hints: list[str]) -> str:
    """HTML. Words that come from messages and files are escaped."""
    parts = [
        '<div style="padding:6px 10px 0 10px">',
        f'<div style="background:{COLORS[now.level]};{CARD}">'
        f'<div style="font-size:1.35em;font-weight:700">{escape(now.headline)}</div>'
        f'<div style="font-size:0.9em">{escape(now.detail)}</div></div>',
        f'<div style="font-size:0.85em;opacity:0.8;margin:0 2px">{escape(" · ".join(facts))}</div>',
        *(_note(note) for note in now.notes),
        *(_note(Note(WARN, "", hint)) for hint in hints),
    ]
    if any(note.code for note in now.notes):
        parts.append(f'<div style="font-size:0.75em;opacity:0.7">Causes: {MORE}</div>')
    return "".join([*parts, "</div>"])


def _note(note: Note) -> str:
    code = f"<b>{escape(note.code)}</b><br/>" if note.code else ""
    do = f"<br/><i>To do:</i> {escape(note.do)}" if note.do else ""
    return f'<div style="{NOTE.format(COLORS[note.level])}">{code}{escape(note.what)}{do}</div>'
