"""Drive protocols by their words, as `limber new --drives` takes them."""

from dataclasses import replace

import pytest

from limber.errors import InputError
from limber.model import protocols


@pytest.mark.parametrize("word", ["damiao_mit", "damiao", "cia", "moteus"])
def test_a_word_or_its_beginning(word):
    assert protocols.protocol(word).word.startswith(word)


@pytest.mark.parametrize("word", ["", "steam", "Moteus"])
def test_any_other_word_lists_them(word):
    with pytest.raises(
        InputError,
        match="there are damiao_mit, moteus, cia402, robstride, myactuator, cubemars, odrive",
    ):
        protocols.protocol(word)


def test_a_word_that_another_begins_with(monkeypatch):
    moteus = protocols.protocol("moteus")
    longer = replace(moteus, word="moteus_two")
    monkeypatch.setattr(protocols, "protocols", lambda: (longer, moteus))
    assert protocols.protocol("moteus") is moteus
    assert protocols.protocol("moteus_t") is longer
    with pytest.raises(InputError):
        protocols.protocol("mot")
