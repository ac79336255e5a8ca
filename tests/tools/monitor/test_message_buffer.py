"""Drawing in one thread never touches who waits in the server's."""

import asyncio
import threading

from limber.monitor.message_buffer import LoopEvent


def in_another_thread(call):
    thread = threading.Thread(target=call)
    thread.start()
    thread.join()


def test_a_waiter_is_woken_by_its_own_loop_alone():
    async def wait_and_wake():
        event = LoopEvent(asyncio.get_running_loop())
        waiter = asyncio.create_task(event.wait())
        await asyncio.sleep(0)
        (future,) = event._waiters
        in_another_thread(event.set)
        assert event.is_set()
        assert not future.done(), "a future belongs to the loop's thread"
        event.set()
        assert await asyncio.wait_for(waiter, 5)

    asyncio.run(wait_and_wake())


def test_the_page_has_such_buffers(served):
    assert isinstance(served._websock_server._broadcast_buffer.message_event, LoopEvent)
