# SPDX-License-Identifier: GPL-3.0-or-later
"""Keys: unique, and unmoved by what else is in the scene."""

import numpy as np
from export.base.identity import combine, random_of_name, short_keys


def names(count, start=0):
    return np.arange(start, start + count, dtype=np.uint64)


def ids(count):
    table = np.zeros((count, 8), dtype=np.int32)
    table[:, 0] = np.arange(count)
    table[:, 1:] = np.iinfo(np.int32).max
    return table


def test_keys_are_unique_for_many_instances_of_one_object():
    identity = combine(np.zeros(300_000, dtype=np.uint64), ids(300_000))
    assert len(np.unique(identity)) == 300_000
    assert len(np.unique(short_keys(identity))) == 300_000


def test_things_that_blender_cannot_tell_apart_get_keys_of_their_own():
    same = np.zeros((4, 8), dtype=np.int32)
    identity = combine(np.full(4, 9, dtype=np.uint64), same)
    assert len(set(identity.tolist())) == 4


def test_leaving_one_out_leaves_the_others_keys():
    hashes, persistent = names(1000), np.zeros((1000, 8), dtype=np.int32)
    everything = short_keys(combine(hashes, persistent))
    keep = np.arange(1000) != 500
    assert np.array_equal(short_keys(combine(hashes[keep], persistent[keep])), everything[keep])


def test_keys_do_not_depend_on_the_order_of_the_list():
    # Upper halves that meet are told apart by the identity, not by the place in the list.
    identity = np.array([5, 1, 3, 7 << 32], dtype=np.uint64)
    keys = short_keys(identity)
    assert len(set(keys.tolist())) == 4
    shuffled = short_keys(identity[[2, 3, 0, 1]])
    assert shuffled.tolist() == keys[[2, 3, 0, 1]].tolist()


def test_empty_scene():
    nothing = combine(np.zeros(0, dtype=np.uint64), np.zeros((0, 8), dtype=np.int32))
    assert len(short_keys(nothing)) == 0


def test_random_of_names_is_spread_over_the_unit_interval():
    values = np.array([random_of_name(f"Cube.{i:03}") for i in range(1000)])
    assert 0.0 <= values.min() and values.max() <= 1.0
    # The mean of 1000 uniform numbers has a standard deviation of .0091: four of them.
    assert abs(values.mean() - 0.5) < 0.037
