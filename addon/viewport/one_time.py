# SPDX-License-Identifier: GPL-3.0-or-later
"""A snapshot of a whole shutter, as it is at one time of it: what is blurred, sharp."""

import numpy as np

from .carried_motion import camera_at, path_at


def at_time(snapshot, time):
    """The snapshot with one knot of everything; shares what stands still.

    Args:
        snapshot: of docs/scene_snapshot.md.
        time: within the shutter, 0 to 1.
    """
    return {
        **snapshot,
        # Rows that are exposed one after another show other times.
        "options": {**snapshot["options"], "rolling_shutter": -1.0},
        "camera": _camera(snapshot["camera"], time),
        "instances": _instances(snapshot["instances"], time),
        "geometries": [_geometry(g, time) for g in snapshot["geometries"]],
        "lights": [_light(x, time) for x in snapshot["lights"] if _lives(x.get("lifespan"), time)],
    }


def _lives(lifespan, time):
    return lifespan is None or lifespan[0] <= time <= lifespan[1]


def _camera(camera, time):
    path = camera["world_from_camera"]
    found = {**camera, "world_from_camera": _only(path, time, camera_at)}
    lens = found.pop("lens_knots", None)
    if lens is not None:
        radius, focus = path_at(lens, np.array([time]))[0]
        found["lens_radius"], found["focus_distance"] = float(radius), float(focus)
    return found


def _only(path, time, places_at=path_at):
    """The path [K, ...] as one knot."""
    return path if len(path) == 1 else places_at(path, np.array([time]))


def _instances(instances, time):
    """Those that are not there then are scaled to nothing: order and keys stay."""
    knots = instances["knots"]
    lifespan = instances.get("lifespan")
    if (knots == 1).all() and lifespan is None:
        return instances
    ends = np.cumsum(knots)
    places = instances["world_from_object"]
    found = places[ends - 1]
    for i in np.flatnonzero(knots > 1):
        found[i] = _only(places[ends[i] - knots[i] : ends[i]], time)[0]
    if lifespan is not None:
        gone = (time < lifespan[:, 0]) | (time > lifespan[:, 1])
        found[gone, :3, :3] = 0.0
    stilled = {**instances, "world_from_object": found, "knots": np.ones_like(knots)}
    stilled.pop("lifespan", None)
    return stilled


def _geometry(geometry, time):
    found = geometry
    for name in ("points", "radius"):
        if len(geometry.get(name, ())) > 1:
            found = {**found, name: np.ascontiguousarray(_only(geometry[name], time))}
    return found


def _light(light, time):
    found = {**light, "world_from_light": _only(light["world_from_light"], time)}
    found.pop("lifespan", None)
    energies = found.pop("energy_knots", None)
    if energies is not None:
        found["energy"] = float(path_at(np.asarray(energies), np.array([time]))[0])
    return found
