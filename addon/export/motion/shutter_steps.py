# SPDX-License-Identifier: GPL-3.0-or-later
"""What is read at the times of the shutter that were stepped to."""

import numpy as np

from ..base.report import poll
from ..base.transforms import is_finite
from ..base.updates import changed_geometry, lights_changed, originals, read_updates
from ..geometry.mesh import whole_mesh
from ..geometry.subdivision import cage_mesh, has_cage
from ..scene.depsgraph import visit
from ..scene.lamps import energies
from .instance_velocity import InstanceVelocities
from .lifespan import complete, lifespans, particle_life, runs


class ShutterSteps:
    """The places, cameras and deformed points of the ticks that were read.

    Attributes:
        ticks: list of int, in the order in which they were read; the frame's is the first.
        cameras: {tick: float64 [4, 4]}.
        lenses: {tick: float64 [2]}, radius and focus distance; empty for a pinhole.
    """

    def __init__(
        self,
        scene,
        frame_tick,
        tick_frames,
        report,
        check_cancel,
        appearing=None,
        velocities=None,
        rigid="its topology changes within the shutter: rendered without deformation blur; "
        "a 'velocity' attribute on its points would blur it",
    ):
        self._rigid_message = rigid
        self._scene = scene
        self._tick_frames = tick_frames  # frames a tick
        self._appearing = (
            appearing  # AppearingInstances; None: what is not at the frame is not there
        )
        self._velocities = velocities or InstanceVelocities(0.0, report)
        self._at_frame = len(scene.visit.prototype)  # things from here on appear within the shutter
        self._report = report
        self._check_cancel = check_cancel
        self._plain = scene.plain
        can_blur = np.array([prototype.blurs for prototype in scene.visit.prototypes], dtype=bool)
        self._can_blur = scene.is_seen() & can_blur[scene.visit.prototype]
        self._changed = set()  # addresses of datablocks
        self._lost = set()  # what was reported to stay as it was
        self._rigid = set()  # geometries whose topology changed
        # As things were at the last time that was visited.
        self._now = scene.visit.matrices.copy()
        self._present = np.ones(len(self._now), dtype=bool)
        self._stays = ~scene.visit.is_instance  # throughout the shutter, even where it is not seen
        self._lives = {}  # thing that came or went -> lifespan.Life or None
        self._touched = np.zeros(len(self._now), dtype=bool)
        self._add_velocities(np.flatnonzero(self._can_blur & ~self._stays), scene.visit, frame_tick)
        self._last_points = {}
        self.frame_tick = frame_tick
        self.ticks = [frame_tick]
        self.cameras = {frame_tick: scene.camera_record["world_from_camera"][0]}
        self._records = {}  # tick -> (things, present, matrices)
        self._point_records = {frame_tick: {}}  # tick -> {geometry: points, None = not there}
        self._energies = {frame_tick: scene.energies}
        record = scene.camera_record
        self.lenses = {}
        if record["lens_radius"] > 0.0:
            at_frame = np.array([record["lens_radius"], record["focus_distance"]])
            self.lenses[frame_tick] = at_frame
        self._follows = bool(self.lenses) and scene.viewpoint.follows_object(scene.depsgraph)
        self._focused_on_itself = False

    def read(self, tick, knows_updates):
        """Reads the scene, which stands at the tick's time."""
        poll(self._check_cancel)
        self._report_gone()
        self.ticks.append(tick)
        self._read_camera(tick)  # what its lens does is no change of place or geometry
        updates = read_updates(self._scene.depsgraph) if knows_updates else None
        self._read_energies(tick, updates)
        self._velocities.note(tick, self._scene.depsgraph)
        if updates is None or any(moved or formed for _, moved, formed, _ in updates):
            changes = self._plain.changes(updates) if knows_updates else None
            if knows_updates:
                self._changed |= changed_geometry(updates)
            if changes is None or self._may_make_instances(changes):
                self._walk(knows_updates)
            else:
                self._take(changes)
        self._read_radii()
        things = np.flatnonzero(self._touched)
        self._records[tick] = (things, self._present[things], self._now[things])
        self._point_records[tick] = dict(self._last_points)

    def _may_make_instances(self, changes):
        """What has nothing to show at the frame may have nodes that make instances now."""
        prototypes = self._scene.visit.prototype[list(changes.objects)]
        nothing = (self._scene.geometry_of_prototype < 0) & ~self._scene.is_light
        return bool(nothing[prototypes].any())

    def _report_gone(self):
        for name, how in self._plain.gone(self._scene.depsgraph.view_layer):
            self._lose(f"object '{name}'", how)

    def _lose(self, datablock, how):
        if (datablock, how) not in self._lost:
            self._lost.add((datablock, how))
            self._report(datablock, f"{how} while the frame was read: it stays as it was")

    def _lose_place(self, things):
        """Of things whose transform is not finite now; what had none at the frame is not there at all."""
        scan = self._scene.visit
        for thing in things[self._can_blur[things] & is_finite(scan.matrices[things])]:
            prototype = scan.prototypes[scan.prototype[thing]]
            self._lose(f"object '{prototype.name}'", "had no finite transform at a time")

    def _read_camera(self, tick):
        scene, last = self._scene, self.ticks[-2]
        viewpoint, seen = scene.viewpoint, (scene.depsgraph, scene.camera_record)
        name = f"camera '{scene.camera_record['name']}'"
        knot = lens = None
        try:
            knot = viewpoint.knot(*seen)
            if self._follows and not viewpoint.follows_object(scene.depsgraph):
                self._lose(name, "was left without its focus object")
            elif self.lenses and knot is not None:
                lens = viewpoint.lens(*seen)
                if lens is None and not self._focused_on_itself:
                    self._focused_on_itself = True
                    self._report(
                        name,
                        "focuses on itself within the shutter: its focus stays as it was just before",
                    )
        except ReferenceError:  # a handler of another add-on deleted it
            self._lose(name, "was deleted")
        self.cameras[tick] = self.cameras[last] if knot is None else knot
        if self.lenses:
            self.lenses[tick] = self.lenses[last] if lens is None else lens

    def _read_energies(self, tick, updates):
        now = before = self._energies[self.ticks[-2]]
        if before and (updates is None or lights_changed(updates)):
            # What a handler has deleted stays as it was.
            now = {**before, **energies(self._scene.depsgraph, self._scene.lamp_graphs)}
        self._energies[tick] = now

    def _take(self, changes):
        things = np.array(changes.moved, dtype=int)
        matrices = np.reshape(changes.matrices, (-1, 4, 4))
        finite = is_finite(matrices)
        self._lose_place(things[~finite])
        finite &= self._can_blur[things]
        self._now[things[finite]] = matrices[finite]
        self._touched[things[finite]] = True
        for index, source in enumerate(self._scene.sources):
            thing = changes.objects.get(source.example)
            if thing is not None and self._deforms(index, source):
                cage = source.cage
                self._read_points(index, source, thing, None if cage else thing.data, cage)

    def _walk(self, knows_updates):
        scan = self._scene.visit
        now = visit(self._scene.depsgraph, _silent, self._check_cancel, scan.cages)
        here, there = match(scan.identity, scan.order, now.identity)
        if self._appearing is not None and len(there) < len(now.prototype):
            self._take_appearing(now, there)
            scan = self._scene.visit
            here, there = match(scan.identity, scan.order, now.identity)
        usable = is_finite(now.matrices[there]) & self._can_blur[here]
        nowhere = here[~is_finite(now.matrices[there])]
        self._lose_place(nowhere)
        self._stays[nowhere] = True
        self._present[:] = ~self._can_blur
        self._present[here[usable]] = True
        self._now[here[usable]] = now.matrices[there[usable]]
        self._touched |= ~self._present | (self._now != scan.matrices).any(axis=(1, 2))
        self._look_at(np.flatnonzero(~self._present & ~self._stays))
        place = np.full(len(scan.prototype), -1)
        place[here] = there
        for index, source in enumerate(self._scene.sources):
            poll(self._check_cancel)
            if not self._deforms(index, source):
                continue
            if place[source.example] < 0:
                self._last_points[index] = None
            elif not knows_updates or self._changed & source.pointers:
                prototype = now.prototypes[now.prototype[place[source.example]]]
                self._read_points(index, source, prototype.source, prototype.data, prototype.cage)

    def _take_appearing(self, now, known):
        new = now.is_instance & is_finite(now.matrices)
        new[known] = False
        which, prototype = self._appearing.find(self._scene, now, np.flatnonzero(new))
        if len(which) == 0:
            return
        self._scene.visit = self._scene.visit.with_more(now, which, prototype)
        more = len(which)
        self._now = np.concatenate([self._now, now.matrices[which]])
        self._present, self._touched, self._can_blur = (
            np.concatenate([mask, np.ones(more, dtype=bool)])
            for mask in (self._present, self._touched, self._can_blur)
        )
        self._stays = np.concatenate([self._stays, np.zeros(more, dtype=bool)])
        count = len(self._now)
        self._look_at(np.arange(count - more, count))
        self._add_velocities(np.arange(count - more, count), self._scene.visit, self.ticks[-1])

    def _add_velocities(self, things, scan, tick):
        self._velocities.add(scan, things, tick, self._scene.depsgraph)
        self._touched[list(self._velocities.of)] = True

    def _look_at(self, things):
        """What came or went: why, while it can be asked.  What is hidden now and not at the frame stays:
        an animated visibility belongs to the frame."""
        things = [int(thing) for thing in things if thing not in self._lives]
        everything = originals() if things else {}
        scan, hidden = self._scene.visit, {}
        for thing in things:
            prototype = scan.prototypes[scan.prototype[thing]]
            owners = prototype.owners(everything, self._scene.depsgraph)
            if owners is None or owners[-1].name in self._plain.unlinked:
                self._stays[thing] = True
                continue
            if scan.prototype[thing] not in hidden:
                hidden[scan.prototype[thing]] = prototype.is_hidden_now(owners)
            self._stays[thing] = hidden[scan.prototype[thing]]
            if not self._stays[thing]:
                self._lives[thing] = particle_life(owners[-1], *scan.persistent[thing, :2])

    def _deforms(self, index, source):
        return source.deforms and index not in self._rigid

    def _read_points(self, index, source, thing, mesh, cage):
        if (cage is None) != (source.cage is None) or (cage and not has_cage(thing, cage)):
            points = None
        elif cage is None:
            with whole_mesh(thing, mesh) as mesh:
                points = source.topology.points_again(thing, mesh)
        else:
            with cage_mesh(thing, cage, self._scene.depsgraph) as mesh:
                points = source.topology.points_again(thing, mesh)
        if points is None:
            self._rigid.add(index)
            self._report(source.geometry.name, self._rigid_message)
            return
        if np.array_equal(points, source.at_frame(points.shape[1])):
            self._last_points.pop(index, None)
            return
        broken = ~(np.isfinite(points).all(axis=1))
        points[broken] = source.at_frame(points.shape[1])[broken]
        self._last_points[index] = points

    def _read_radii(self):
        scan = self._scene.visit
        swelling = [
            (index, source)
            for index, source in enumerate(self._scene.sources)
            if source.swells and self._deforms(index, source)
        ]
        everything = originals() if swelling else {}
        for index, source in swelling:
            points = self._last_points.get(index, source.at_frame(3))
            owner = everything.get(scan.prototypes[scan.prototype[source.example]].address)
            if points is not None and owner is not None:
                thing = owner.evaluated_get(self._scene.depsgraph)
                self._last_points[index] = source.topology.with_radii(points[:, :3], thing)

    def places(self):
        """(int [m] numbers of the Runs of things that ever move, int [m] these things, {tick: float64
        [m, 4, 4]})."""
        things, ticks, runs = self._runs()
        path = np.repeat(self._scene.visit.matrices[things][None], len(ticks), axis=0)
        for tick, (known, _, matrices) in self._records.items():
            path[ticks.index(tick), np.searchsorted(things, known)] = matrices
        if len(runs.things) > len(things):
            path = path[:, np.searchsorted(things, runs.things)]
        rows = np.flatnonzero((runs.first > 0) | (runs.last < len(ticks) - 1))
        if len(rows):
            partial = path[:, rows]
            going_on = self._going_on(runs.things[rows])
            complete(partial, ticks, runs.first[rows], runs.last[rows], *going_on)
            path[:, rows] = partial
        if self._velocities.of:
            whole = (runs.first == 0) & (runs.last == len(ticks) - 1)
            self._velocities.take(runs.things, path, ticks, whole)
        moves = (path != path[:1]).any(axis=(0, 2, 3))
        path = {tick: path[i, moves] for i, tick in enumerate(ticks)}
        return runs.numbers[moves], runs.things[moves], path

    def lifespans(self, start):
        """(int [m] numbers of Runs that do not last throughout, float32 [m, 2] when they do: of
        lifespan.lifespans).

        Args:
            start: Blender's frame.
        """
        _, ticks, runs = self._runs()
        ends = (runs.first > 0) | (runs.last < len(ticks) - 1)
        goes = np.flatnonzero(ends & ~self._stays[runs.things])
        lives = [self._lives.get(int(thing)) for thing in runs.things[goes]]
        own = np.array(
            [(np.nan, np.nan) if life is None else (life.birth, life.death) for life in lives]
        ).reshape(-1, 2)
        own = ((own - start) / self._tick_frames + self.frame_tick) / ticks[-1]
        times = np.array(ticks) / ticks[-1]
        return runs.numbers[goes], lifespans(times, runs.first[goes], runs.last[goes], *own.T)

    def come_again(self):
        """int [c], the things of Runs with numbers that the visit does not have, in their order."""
        _, _, runs = self._runs()
        return runs.things[runs.numbers >= len(self._scene.visit.prototype)]

    def _runs(self):
        """(int [m] things that were touched, their ticks, lifespan.Runs)."""
        ticks = sorted(self.ticks)
        things = np.flatnonzero(self._touched)
        seen = np.repeat((things < self._at_frame)[None], len(ticks), axis=0)
        for tick, (known, present, _) in self._records.items():
            seen[ticks.index(tick), np.searchsorted(things, known)] = present
        frame, count = ticks.index(self.frame_tick), len(self._scene.visit.prototype)
        return things, ticks, runs(things, seen, frame, self._stays[things], count)

    def _going_on(self, things):
        """(float64 [m, 3] metres a tick of what is seen at one tick, bool [m] whether it goes on at all)."""
        lives = [self._lives.get(int(thing)) for thing in things]
        velocity = [np.zeros(3) if life is None else life.velocity for life in lives]
        velocity = np.reshape(velocity, (-1, 3)) * self._tick_frames
        return velocity, ~self._stays[things]

    def energies(self):
        """{address of an original lamp: {tick: float64 [1]}} of those whose strength changes, and that are
        placed at some time."""
        prototypes = self._scene.visit.prototypes
        placed = {prototype.address for prototype in prototypes if prototype.type == "LIGHT"}
        paths = {
            address: {
                tick: np.array([self._energies[tick][address]]) for tick in sorted(self.ticks)
            }
            for address in placed & set(self._scene.energies)
        }
        return {
            address: path
            for address, path in paths.items()
            if np.ptp(np.stack(list(path.values()))) > 0.0
        }

    def points(self):
        """{geometry index: {tick: float32 [V, 3 or 4]}} of what deforms."""
        found = {}
        for index in set().union(*self._point_records.values()) - self._rigid:
            records = [record.get(index) for record in self._point_records.values()]
            columns = max((points.shape[1] for points in records if points is not None), default=3)
            source = self._scene.sources[index]
            at_frame = source.at_frame(columns)
            path = {t: record.get(index, at_frame) for t, record in self._point_records.items()}
            for tick, nearer in hold_order(self.ticks, self.frame_tick):
                if path[tick] is None:
                    path[tick] = path[nearer]
                path[tick] = source.widened(path[tick], columns)
            if any(not np.array_equal(points, at_frame) for points in path.values()):
                found[index] = {tick: path[tick] for tick in sorted(path)}
        return found


def match(identity, order, now):
    """Pairs of equal identities.

    Args:
        identity: uint64 [n], unique.
        order: argsort of it.
        now: uint64 [m], unique.

    Returns:
        (int [p] indices in `identity`, int [p] indices in `now`).
    """
    if len(identity) == 0 or len(now) == 0:
        return np.zeros(0, dtype=int), np.zeros(0, dtype=int)
    place = np.minimum(np.searchsorted(identity, now, sorter=order), len(identity) - 1)
    here = order[place]
    there = np.flatnonzero(identity[here] == now)
    return here[there], there


def hold_order(ticks, frame_tick):
    """(tick, the adjacent one towards the frame) pairs, from the frame outwards."""
    ticks = sorted(ticks)
    middle = ticks.index(frame_tick)
    later = [(ticks[i], ticks[i - 1]) for i in range(middle + 1, len(ticks))]
    return later + [(ticks[i], ticks[i + 1]) for i in range(middle - 1, -1, -1)]


def _silent(_datablock, _message):
    """What a walk has to say was said at the frame."""
