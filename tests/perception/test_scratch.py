"""Room that is used again holds nothing that anybody still needs."""

import threading

import numpy as np

from narrows.perception.scratch import Scratch
from narrows.perception.voxel_grid import voxel_grid


def test_a_cloud_thinned_later_does_not_touch_the_one_before():
    rng = np.random.default_rng(3)
    first = voxel_grid(rng.uniform(size=(2000, 3)), 0.1)
    kept = first.copy()
    voxel_grid(rng.uniform(size=(3000, 3)), 0.05)
    assert np.array_equal(first, kept)


def test_room_is_kept_by_name_thread_and_up_to_a_size():
    scratch = Scratch()
    room = scratch.array("sums", (50, 3), np.float32)
    assert room.shape == (50, 3)
    assert room.dtype == np.float32
    assert np.shares_memory(room, scratch.array("sums", (40,), np.int64))
    assert not np.shares_memory(room, scratch.array("keys", (40,), np.int64))
    huge = scratch.array("huge", (3_000_000,), np.float64)
    assert not np.shares_memory(huge, scratch.array("huge", (3_000_000,), np.float64))
    others = []
    thread = threading.Thread(target=lambda: others.append(scratch.array("sums", (5,), np.int64)))
    thread.start()
    thread.join()
    assert not np.shares_memory(room, others[0])
