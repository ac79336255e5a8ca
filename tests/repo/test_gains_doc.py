"""The tables of gains in scenarios/README.md, against what the controller lists."""

from limber_qa import gains_doc


def test_the_readme_has_the_tables_of_the_controller():
    text = gains_doc.TABLE.path.read_text(encoding="utf-8")
    assert gains_doc.TABLE.updated(text) == text, "run: ./limber dev docs"


def test_a_laws_own_number_is_listed_with_its_law():
    laws = {law["name"]: law for law in gains_doc.listing()["laws"]}
    (gain,) = laws["full_state"]["parameters"]
    assert (gain["key"], gain["low"], gain["high"], gain["default"]) == ("torque_gain", 0, 20, 0)
    assert laws["deflection_pd"]["demonstration"] and not laws["joint_pd"]["demonstration"]
    assert "refusal" not in laws["joint_pd"]


def test_with_a_robot_the_list_says_what_it_cannot_run():
    laws = {law["name"]: law for law in gains_doc.listing("openarm")["laws"]}
    assert laws["cartesian_impedance"]["refusal"] is None
    assert "elastic joint" in laws["tomei"]["refusal"]
