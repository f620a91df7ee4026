"""Pictures reach a guest through memory that it can read and never change, and look as they did in the host."""

from __future__ import annotations

import mmap
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from law_cases import cases

from hthor.guest import Guest
from hthor.guest.protocol import shared_frames
from hthor.types import Action
from tests.support.guest_agents import BRIEFING, HEAD, Sensors, agent, look

pytestmark = pytest.mark.skipif(not hasattr(os, "memfd_create"), reason="this system has no such memory")
SHAPES = arrays.array_shapes(min_dims=0, max_dims=4, max_side=9, min_side=0)
TYPES = st.sampled_from(["u1", "<f4", "<i4", "<f8", "?"])


@given(st.lists(TYPES.flatmap(lambda dtype: arrays.arrays(dtype, SHAPES)), max_size=4))
@settings(max_examples=cases(40))
def test_what_is_put_in_comes_out_the_same(given_arrays: list[Any]) -> None:
    window = shared_frames.FrameWriter()
    view = shared_frames.FrameReader(window.handle)
    told = [window.put(array) for array in given_arrays]
    for array, value in zip(given_arrays, told, strict=True):
        assert value is not None
        taken = view.take(value)
        assert taken.dtype == array.dtype
        np.testing.assert_array_equal(taken, array)
        assert not taken.flags.writeable
    window.close()


def test_nobody_but_the_host_can_change_it() -> None:
    window = shared_frames.FrameWriter()
    with pytest.raises(PermissionError):
        mmap.mmap(window.handle, shared_frames.SIZE, mmap.MAP_SHARED, mmap.PROT_READ | mmap.PROT_WRITE)
    with pytest.raises(PermissionError):
        os.pwrite(window.handle, b"x", 0)
    for size in (0, 2 * shared_frames.SIZE):
        with pytest.raises(PermissionError):
            os.ftruncate(window.handle, size)
    window.close()


def test_what_does_not_fit_or_is_no_picture_travels_otherwise() -> None:
    window = shared_frames.FrameWriter()
    assert window.put(np.zeros(shared_frames.SIZE + 1, np.uint8)) is None
    assert window.put(np.array([object()])) is None
    assert window.put("text") is None
    assert window.put(np.zeros(shared_frames.SIZE - 10, np.uint8)) is not None
    assert window.put(np.zeros(20, np.uint8)) is None
    window.clear()
    assert window.put(np.zeros(20, np.uint8)) is not None
    window.close()


ACT = """
import mmap
handle = int(os.environ["HTHOR_FRAMES"])
memory = mmap.mmap(handle, 4 << 20, mmap.MAP_SHARED, mmap.PROT_READ)
print("left over:", memory[:4096].strip(b"\\0"))
try:
    mmap.mmap(handle, 4 << 20)
except PermissionError:
    print("cannot write")
first = observation.rgb
assert first[0, 1, 2] == 5 and memory[5] == 5 and not first.flags.writeable
assert (observation.segmentation == np.arange(-4, 4).reshape(2, 4)).all() and observation.rgb is first
assert observation.segmentation.dtype == np.int32
return Action()
"""


class Coloured(Sensors):
    def segmentation(self) -> Any:
        return np.arange(-4, 4, dtype=np.int32).reshape(2, 4)


def test_a_guest_sees_what_its_robot_sees_and_nothing_of_the_trial_before(tmp_path: Path) -> None:
    path = tmp_path / "my_agent.py"
    path.write_text(HEAD + "import numpy as np\n" + agent(ACT.strip()))
    with Guest(path) as mind:
        for _ in range(2):
            mind.begin(BRIEFING)
            assert mind.act(look(0, Coloured())) == Action()
        assert mind.log.split("\n")[:4] == ["left over: b''", "cannot write"] * 2
