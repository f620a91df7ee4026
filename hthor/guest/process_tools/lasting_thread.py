"""Starts processes from a thread that lives as long as this process.

A Linux process that asks to end with its parent ends with the *thread* that started it. So a process that was started
by a thread of one trial would end in the middle of another.
"""

import functools
import os
import threading
from collections.abc import Callable
from concurrent.futures import Future
from queue import SimpleQueue
from typing import Any, TypeVar

_T = TypeVar("_T")
_Calls = SimpleQueue[tuple[Callable[[], Any], Future[Any]]]


def run_in_lasting_thread(call: Callable[[], _T]) -> _T:
    """The result of a call, made by the main thread if that is the caller, else by a thread that never ends.

    Raises:
        Exception: any exception of the call.
    """
    if threading.current_thread() is threading.main_thread():
        return call()
    result: Future[_T] = Future()
    _calls(os.getpid()).put((call, result))
    return result.result()


@functools.cache
def _calls(pid: int) -> _Calls:  # noqa: ARG001  a forked process has none of its parent's threads
    """The queue of this process's lasting thread. Two threads that call this first at once get one each."""
    calls = _Calls()
    threading.Thread(target=_serve, args=(calls,), name="hthor-guest-starter", daemon=True).start()
    return calls


def _serve(calls: _Calls) -> None:
    while True:
        call, result = calls.get()
        try:
            result.set_result(call())
        except BaseException as error:  # the caller's to handle
            result.set_exception(error)
        del call, result  # or they would live on until the next call
