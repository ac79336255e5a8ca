"""The required keys in robots/README.md are the loader's."""

from limber_qa import robot_keys_doc


def test_the_table_is_the_loaders():
    text = robot_keys_doc.TABLE.path.read_text(encoding="utf-8")
    assert robot_keys_doc.TABLE.updated(text) == text, "run: ./limber dev docs"
