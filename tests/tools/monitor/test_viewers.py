"""What each viewer's browser is told apart from the others."""

from unittest.mock import MagicMock

import pytest

from limber.monitor.viewers import Viewers


@pytest.mark.parametrize("software", [True, False])
def test_shadows_are_for_graphics_cards(software):
    server, client = MagicMock(), MagicMock()
    server.get_clients.return_value = {3: client}
    viewers = Viewers(server, MagicMock())
    server.scene.configure_default_lights.assert_called_with(cast_shadow=False)
    viewers._notes[3] = MagicMock()
    viewers._size(3, {"width": 1000, "software": software})
    client.scene.configure_default_lights.assert_called_once_with(cast_shadow=not software)
