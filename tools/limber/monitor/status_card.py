"""Mode, faults and limits at the top of the page, with the buttons that lead on."""

from dataclasses import dataclass, field
from html import escape

import viser

from limber.live.way import LEADS_TO, TAKES, WAY
from limber.monitor.words import BAD, GOOD, WANTED, WARN, Note, Situation
from limber.problems import MORE

COLORS = {GOOD: "#1a7f4b", WARN: "#9a5b00", BAD: "#c62828"}
CARD = "border-radius:8px;padding:9px 12px;color:#fff;margin:2px 0 5px 0"
NOTE = "border-left:4px solid {};padding:2px 8px;margin:5px 0;font-size:0.85em;line-height:1.3"
SMALL = "font-size:0.85em;line-height:1.3;margin-top:4px"
ASIDE = ("idle", "release")
BUTTONS = (*WAY, *ASIDE)


@dataclass
class Shown:
    """All that the card tells. `control`: the page may move the arm. `pending`: what of the gains
    will be in effect once the law runs. `answers`: what became of requests. `lines`: what is too
    long for the facts, below them.
    """

    now: Situation
    facts: list[str] = field(default_factory=list)
    hints: list[str] = field(default_factory=list)
    pending: list[str] = field(default_factory=list)
    answers: list[Note] = field(default_factory=list)
    control: bool = False
    lines: list[str] = field(default_factory=list)


class StatusCard:
    """Parts of their own, so that a second that passes does not draw the buttons anew."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._parts = [gui.add_html("") for _ in range(3)]

    def show(self, shown: Shown) -> None:
        for part, content in zip(self._parts, card(shown), strict=True):
            if content != part.content:
                part.content = content


def card(shown: Shown) -> tuple[str, str, str]:
    """HTML of the box, of the facts below it and of the notes. Words that come from messages and
    files are escaped.
    """
    now = shown.now
    caused = now.faulty and now.notes and now.notes[0].code not in WANTED
    cause = _cause(now.notes[0]) if caused else ""
    pending = "".join(f"<div>{escape(line)}</div>" for line in shown.pending)
    if pending:
        pending = f'<div style="{SMALL}"><b>With <i>active</i> the gains become</b>{pending}</div>'
    buttons = _buttons(now) if shown.control else _without_control(now)
    box = (
        f'<div style="padding:4px 10px 0 10px"><div style="background:{COLORS[now.level]};{CARD}">'
        f'<div style="font-size:1.25em;font-weight:700">{escape(now.headline)}</div>'
        f'<div style="font-size:0.9em">{escape(now.detail)}</div>{cause}{pending}{buttons}</div>'
        + "".join(map(_note, shown.answers))
        + "</div>"
    )
    facts = escape(" · ".join(shown.facts))
    facts += "".join(f"<div>{escape(line)}</div>" for line in shown.lines)
    facts = f'<div style="font-size:0.85em;opacity:0.8;margin:0 12px">{facts}</div>'
    others = now.notes[1:] if cause else now.notes
    notes = [_note(note) for note in others]
    notes += [_note(Note(WARN, "", hint)) for hint in shown.hints]
    if any(note.code for note in now.notes):
        notes.append(f'<div style="font-size:0.75em;opacity:0.7">Causes: {MORE}</div>')
    return box, facts, f'<div style="padding:0 10px">{"".join(notes)}</div>'


def _buttons(now: Situation) -> str:
    """In the order of the way to ACTIVE, and others below; the present mode is marked."""
    if not now.mode:
        return ""
    way, others = ("".join(_button(word, now) for word in row) for row in (WAY, ASIDE))
    return (
        f'<div class="limber-buttons">{way}</div>'
        f'<div class="limber-buttons limber-aside">{others}</div>'
    )


def _button(word: str, now: Situation) -> str:
    """In IDLE, *idle* releases drives that still hold the arm by themselves; before, *hold* cannot
    enable one that let go.
    """
    here = word != "acknowledge" and LEADS_TO.get(word) == now.mode
    releases = word == "idle" and now.mode == "IDLE" and now.fallback
    can = word in TAKES.get(now.mode, ()) or word == "release" or releases
    can = can and not (word == "hold" and now.let_go)
    state = ' aria-current="true"' if here else ""
    state += "" if can else " disabled"
    return f'<button type="button" data-limber="{word}"{state}>{word}</button>'


def _without_control(now: Situation) -> str:
    if not now.faulty:
        return ""
    words = "acknowledge, hold, active: on a page with --control, or limber send recover"
    return f'<div style="{SMALL}">{words}</div>'


def _cause(note: Note) -> str:
    do = f"<div><i>To do:</i> {escape(note.do)}</div>" if note.do else ""
    return f'<div style="{SMALL}"><b>{escape(note.code)}</b>: {escape(note.what)}{do}</div>'


def _note(note: Note) -> str:
    code = f"<b>{escape(note.code)}</b> " if note.code else ""
    what = f"{code}{escape(note.what)}"
    if note.do and note.code:
        what = f"<details><summary>{what}</summary><i>To do:</i> {escape(note.do)}</details>"
    return f'<div style="{NOTE.format(COLORS[note.level])}">{what}</div>'
