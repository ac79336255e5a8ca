"""What of the scene is seen."""

import viser

from limber.monitor.scene import Scene

WORDS = {
    "goal": "goal, where the arm is away from it",
    "forces": "forces",
    "stiffness": "stiffness",
    "springs": "springs of elastic joints, 20 times as bent",
}


def add_view_options(gui: viser.GuiApi, scene: Scene) -> None:
    for key, words in WORDS.items():
        _checkbox(gui, scene, key, words)


def _checkbox(gui: viser.GuiApi, scene: Scene, key: str, words: str) -> None:
    box = gui.add_checkbox(words, scene.seen[key])

    @box.on_update
    async def _(_event: viser.GuiEvent) -> None:
        scene.seen[key] = box.value
