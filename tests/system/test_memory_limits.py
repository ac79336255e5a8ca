"""Little or no memory may be locked: the processes run, and say so in a sentence."""

import resource

import pytest

from limber.lcmtypes.controller_status_t import controller_status_t as Status


@pytest.fixture
def limit_KiB(request):
    """Of this process and those that it starts."""
    before = resource.getrlimit(resource.RLIMIT_MEMLOCK)
    resource.setrlimit(resource.RLIMIT_MEMLOCK, (1024 * request.param, before[1]))
    yield request.param
    resource.setrlimit(resource.RLIMIT_MEMLOCK, before)


@pytest.mark.realtime
@pytest.mark.parametrize("limit_KiB", [0, 64], indirect=True)
def test_an_arm_runs_and_tells(limit_KiB, stack):
    stack.under = ["setpriv", "--bounding-set=-ipc_lock"]  # whoever has it knows no limit
    stack.start_all()
    stack.bring_to(Status.MODE_ACTIVE)
    told = f"locked memory refused: only {limit_KiB} KiB are permitted (ulimit -l)"
    for name in stack.processes:
        assert told in (stack.directory / f"{name}-1.log").read_text(encoding="utf-8"), name
