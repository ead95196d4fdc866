# SPDX-License-Identifier: GPL-3.0-or-later
"""One flip rendered by both engines, and what is to be thought of it."""

from dataclasses import asdict, dataclass

import compare
from subject import names_of_flip, names_of_roots, tells, words_of_flip

# In this order from harmless to bad.
ALIKE = "alike"  # both pictures change, and alike
STAY = "stay"  # neither changes
WARNED = "warned"  # Cycles' picture changes, and Granita says that it does not follow, and of what
UNSET = "unset"  # Blender does not take the value
CYCLES_FAILS = "cycles fails"
DIFFERS = "differs"  # both change, each its own way, without a word
SILENT = "silent"  # Cycles' changes, Granita's does not, without a word
OWN = "own"  # Granita's changes, Cycles' does not
FAILS = "fails"  # Granita fails without saying why
FAULTS = (DIFFERS, SILENT, OWN, FAILS)


@dataclass
class Verdict:
    identifier: str
    key: str
    verdict: str
    cycles: float = 0.0  # distance of Cycles' pictures before and after
    granita: float = 0.0
    mismatch: float = 0.0  # compare.mismatch of the two changes
    said: str = ""

    def record(self):
        record = asdict(self)
        for name in ("cycles", "granita", "mismatch"):
            record[name] = round(record[name], 5)
        return record


class Judge:
    """Knows the unchanged pictures of one probe."""

    def __init__(self, session, probe):
        self.session, self.probe = session, probe
        self.base = session.seeds(lambda: session.build(probe)[0])
        scene, roots = session.build(probe)
        self.standing = session.render(scene, "GRANITA").warnings
        self._names = names_of_roots(roots)

    def baseline(self):
        """A Verdict on the unchanged picture: how far the engines are apart."""
        (theirs, noise_c), (ours, noise_g) = (self.base[e] for e in ("CYCLES", "GRANITA"))
        name = f"{self.probe.name}: unchanged"
        if theirs[0] is None or ours[0] is None:
            return Verdict(name, self.probe.name, FAILS)
        common = [name for name in theirs[0] if name in ours[0]]
        theirs, ours = ({name: p[0][name] for name in common} for p in (theirs, ours))
        apart = compare.distance(theirs, ours)
        size = max(compare.distance(theirs, {k: 0 * v for k, v in theirs.items()}), 1e-6)
        same = apart <= compare.ALIKE * size + compare.MARGIN * (noise_c + noise_g)
        about = [text for text in map(_text, self.standing) if tells(text, self._names)]
        said = " | ".join(sorted(about))
        what = ALIKE if same else WARNED if said else DIFFERS
        return Verdict(name, self.probe.name, what, noise_c, noise_g, apart / size, said)

    def judge(self, flip):
        scene, roots = self.session.build(self.probe)
        if not flip.apply(self.probe, roots):
            return Verdict(flip.identifier, flip.key, UNSET)
        theirs = self.session.render(scene, "CYCLES")
        ours = self.session.render(scene, "GRANITA")
        words = words_of_flip(flip, roots)
        return self._sort(flip, theirs, ours, names_of_flip(flip, roots) | words, words)

    def _sort(self, flip, theirs, ours, names, words):
        (before_c, noise_c), (before_g, noise_g) = (
            (pictures[0], noise)
            for pictures, noise in (self.base[e] for e in ("CYCLES", "GRANITA"))
        )
        # Of what was said before the flip, too, what tells of this property or of all of the node.
        about = [text for text in map(_text, ours.warnings - self.standing) if tells(text, names)]
        for text in map(_text, ours.warnings & self.standing):
            if tells(text, words) or self.probe.node and _not_supported(text):
                about.append(text)
        said = " | ".join(sorted(about)) or ours.error

        def verdict(what, cycles=0.0, granita=0.0, mismatch=0.0):
            return Verdict(flip.identifier, flip.key, what, cycles, granita, mismatch, said)

        if theirs.picture is None:
            return verdict(STAY if ours.picture is None else CYCLES_FAILS)
        if ours.picture is None:
            return verdict(WARNED if _explains(ours.error, names) else FAILS)
        if before_c is None or before_g is None:
            return verdict(ALIKE)
        cycles = compare.distance(before_c, theirs.picture)
        granita = compare.distance(before_g, ours.picture)
        changed_c = compare.changed(before_c, theirs.picture, noise_c)
        changed_g = compare.changed(before_g, ours.picture, noise_g)
        mismatch = compare.mismatch(before_c, theirs.picture, before_g, ours.picture)
        if not changed_c and not changed_g:
            return verdict(STAY, cycles, granita)
        # What is changed may be where the engines meet.
        loudest = compare.MARGIN * (noise_c + noise_g) + compare.ROUNDING
        if compare.distance(theirs.picture, ours.picture) <= loudest:
            return verdict(ALIKE, cycles, granita, mismatch)
        if changed_c and changed_g and mismatch <= compare.ALIKE:
            return verdict(ALIKE, cycles, granita, mismatch)
        if about:
            return verdict(WARNED, cycles, granita, mismatch)
        # Before it is a fault: what of the two changes may be noise of the changed picture?
        after = self.session.seeds(lambda: self._changed(flip))
        loud = {e: max(after[e][1], self.base[e][1]) for e in after}
        changed_c = compare.changed(before_c, theirs.picture, loud["CYCLES"])
        changed_g = compare.changed(before_g, ours.picture, loud["GRANITA"])
        unsure = compare.MARGIN * (loud["CYCLES"] + loud["GRANITA"]) + compare.ROUNDING
        apart = mismatch * max(cycles, granita)
        if not changed_c and not changed_g:
            return verdict(STAY, cycles, granita, mismatch)
        if apart <= compare.ALIKE * max(cycles, granita) + unsure:
            return verdict(ALIKE, cycles, granita, mismatch)
        what = DIFFERS if changed_c and changed_g else SILENT if changed_c else OWN
        return verdict(what, cycles, granita, mismatch)

    def _changed(self, flip):
        scene, roots = self.session.build(self.probe)
        flip.apply(self.probe, roots)
        return scene


def _explains(error, names):
    """Whether a failure is told to the artist, and not to a programmer."""
    return "Traceback" not in error and "internal error" not in error and tells(error, names)


def _text(warning):
    return "{}: {}".format(*warning)


def _not_supported(text):
    return "is not supported" in text
