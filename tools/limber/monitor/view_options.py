"""What of the scene is seen."""

import viser

from limber.monitor.scene import Scene

WORDS = {
    "goal": ("goal", "Where the arm is away from it."),
    "forces": ("forces", None),
    "stiffness": ("stiffness", None),
    "springs": ("springs", "Of elastic joints, drawn 20 times as bent as they are."),
}


def add_view_options(gui: viser.GuiApi, scene: Scene) -> None:
    for key, (label, hint) in WORDS.items():
        _checkbox(gui, scene, key, label, hint)


def _checkbox(gui: viser.GuiApi, scene: Scene, key: str, label: str, hint: str | None) -> None:
    box = gui.add_checkbox(label, scene.seen[key], hint=hint)

    @box.on_update
    async def _(_event: viser.GuiEvent) -> None:
        scene.seen[key] = box.value
