# SPDX-License-Identifier: GPL-3.0-or-later
"""The motion of a reading of the whole shutter, carried over to a later reading of the frame alone.

What the first picture of an edit shows: the scene as it is now, moving as it did.  Where the edit changes the motion
itself, or who is there, the next reading of the shutter tells; until then that part is still, or as before.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class ShutterTimes:
    """Of a reading."""

    length: float  # frames
    frame_time: float  # of Blender's frame within it: 0, 1/2 or 1

    def times_of(self, other, count):
        """float64 [count]: where equidistant times of this shutter lie in another one, 0 to 1 within it."""
        offsets = (np.linspace(0.0, 1.0, count) - self.frame_time) * self.length
        return offsets / other.length + other.frame_time if other.length > 0.0 else offsets * 0.0


def carried(still, times, moving, moving_times):
    """The snapshot of the frame with the motion of another one.

    Args:
        still: snapshot without motion.
        times: ShutterTimes that its picture is to have.
        moving: snapshot with motion, of an earlier state.
        moving_times: its ShutterTimes.
    """
    before = _Before(times, moving_times)
    return {
        **still,
        "camera": _camera(still["camera"], moving["camera"], before),
        "instances": _instances(still["instances"], moving["instances"], before),
        "geometries": _each(_geometry, still["geometries"], moving["geometries"], before),
        "lights": _each(_light, still["lights"], moving["lights"], before),
    }


def corrected(moving, times, places, still):
    """The snapshot of a whole shutter, with what the artist has moved since it was keyed where it is now.

    What is evaluated at other times plays back what is keyed; at the frame the artist sees changes that are not.
    Where the two agree, the snapshot is as it was to the bit.

    Args:
        moving, times, places: snapshot, its ShutterTimes and its Places: a path of few knots is bent a little.
        still: snapshot of the frame as the artist sees it.
    """
    before = _Before(times, times)
    found = dict(moving)
    if not _agree(places.camera, _place(still["camera"])):
        path = _matrices(
            _place(still["camera"]), moving["camera"]["world_from_camera"], before, camera_at
        )
        found["camera"] = {**moving["camera"], "world_from_camera": path}
    now, then = still["instances"], moving["instances"]
    if now["name"] == then["name"] and np.array_equal(now["key"], then["key"]):
        found["instances"] = _corrected_instances(
            now["world_from_object"], then, places.instances, before
        )
    if [light["name"] for light in still["lights"]] == [
        light["name"] for light in moving["lights"]
    ]:
        found["lights"] = [
            light
            if _agree(place, here["world_from_light"][0])
            else {
                **light,
                "world_from_light": _matrices(
                    here["world_from_light"][0], light["world_from_light"], before
                ),
            }
            for here, light, place in zip(
                still["lights"], moving["lights"], places.lights, strict=True
            )
        ]
    return found


def _place(camera):
    return camera["world_from_camera"][0]


def _agree(a, b):
    """Of single precision."""
    return np.allclose(a, b, rtol=1e-5, atol=1e-5)


def _corrected_instances(now, then, places, before):
    knots = then["knots"]
    ends = np.cumsum(knots)
    count = len(places)  # lamps that are drawn as surfaces come after these
    moved = np.zeros(len(knots), dtype=bool)
    moved[:count] = ~np.isclose(places, now[:count], rtol=1e-5, atol=1e-5).all(axis=(1, 2))
    if not moved.any():
        return then
    paths = then["world_from_object"].copy()
    for i in np.flatnonzero(moved):
        part = slice(ends[i] - knots[i], ends[i])
        path = _matrices(now[i], paths[part], before)
        paths[part] = path  # of one knot where it has no extent at the frame: still
    return {**then, "world_from_object": paths}


def camera_at(path, times):
    """float64 [len(times), 4, 4]: as path_at() of a camera's world_from_camera.

    What it sees goes straight between its knots, and so does its inverse (native/scene/camera_path.h).  At knots it is
    these, to the bit.
    """
    found, inverse = path_at(path, times), path_at(np.linalg.inv(path), times)
    place = times * (len(path) - 1)
    between = (place != np.round(place)) | (place < 0) | (place > len(path) - 1)
    between &= np.abs(np.linalg.det(inverse)) > 1e-12
    found[between] = np.linalg.inv(inverse[between])
    return found


def path_at(path, times):
    """[len(times), ...]: where an equidistant path [K, ...] is at times of its shutter; it goes on straight."""
    last = len(path) - 1
    place = times * last
    first = np.clip(np.floor(place).astype(int), 0, max(last - 1, 0))
    part = (place - first).reshape(-1, *[1] * (path.ndim - 1))
    found = path[first] * (1.0 - part) + path[np.minimum(first + 1, last)] * part
    return found.astype(path.dtype)


class _Before:
    """Paths of the earlier reading at the times of the new one."""

    def __init__(self, times, moving_times):
        self._times, self._moving_times = times, moving_times
        self._is_same = times == moving_times

    def at_frame(self, path, places_at=path_at):
        """Where a path [K, ...] was at Blender's frame.  `places_at`: of a camera camera_at."""
        return places_at(path, np.array([self._moving_times.frame_time]))[0]

    def knots(self, path, places_at=path_at):
        """The path at as many times of the new shutter; it goes on straight where that is longer."""
        if self._is_same:
            return path
        return places_at(path, self._times.times_of(self._moving_times, len(path)))


def _matrices(now, path, before, places_at=path_at):
    """float64 [K, 4, 4]: what is at `now` [4, 4] moves as the path did, in world space."""
    at_frame = before.at_frame(path, places_at)
    knots = before.knots(path, places_at)
    if np.array_equal(now, at_frame):
        return knots
    if abs(np.linalg.det(at_frame[:3, :3])) < 1e-12:
        return now[None]
    return knots @ np.linalg.inv(at_frame) @ now


def _camera(now, then, before):
    if len(then["world_from_camera"]) == 1 and "lens_knots" not in then:
        return now
    found = dict(now)
    found["world_from_camera"] = _matrices(
        now["world_from_camera"][0], then["world_from_camera"], before, camera_at
    )
    lens = then.get("lens_knots")
    if lens is not None and now["lens_radius"] > 0.0:
        at_frame = before.at_frame(lens)
        scale = np.array([now["lens_radius"], now["focus_distance"]]) / np.maximum(at_frame, 1e-12)
        found["lens_knots"] = np.maximum(before.knots(lens) * scale, 1e-6)
    return found


def _instances(now, then, before):
    if now["name"] != then["name"] or not np.array_equal(now["key"], then["key"]):
        return now
    if (then["knots"] == 1).all() or (now["knots"] != 1).any():
        return now
    ends = np.cumsum(then["knots"])
    paths = [
        matrix[None]
        if knots == 1
        else _matrices(matrix, then["world_from_object"][end - knots : end], before)
        for matrix, knots, end in zip(now["world_from_object"], then["knots"], ends, strict=True)
    ]
    found = {**now, "world_from_object": np.concatenate(paths)}
    found["knots"] = np.array([len(path) for path in paths], dtype=np.int32)
    return found


def _each(one, now, then, before):
    """A list with the motion of another one: one(now, then, before) by place; still where there are more, or fewer."""
    if len(now) != len(then):
        return now
    return [one(a, b, before) for a, b in zip(now, then)]


def _geometry(now, then, before):
    knots = then["points"]
    if len(knots) == 1 or knots.shape[1:] != now["points"].shape[1:]:
        return now
    moved = before.knots(knots) + (now["points"][0] - before.at_frame(knots))
    return {**now, "points": np.ascontiguousarray(moved, dtype=np.float32)}


def _light(now, then, before):
    path = then["world_from_light"]
    if len(path) == 1 or now["name"] != then["name"]:
        return now
    return {**now, "world_from_light": _matrices(now["world_from_light"][0], path, before)}
