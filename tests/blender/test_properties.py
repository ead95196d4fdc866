# SPDX-License-Identifier: GPL-3.0-or-later
"""A fixed part of the flips of `./dev bench properties`: what changes Cycles' picture changes Granita's alike, or
the artist is told, by a warning or by the manual."""

import hashlib
import re
import sys
from pathlib import Path

import bpy
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "properties"))
import exceptions  # noqa: E402
from all_probes import all_probes  # noqa: E402
from session import Session  # noqa: E402
from verdict import FAULTS, STAY, UNSET, Judge  # noqa: E402
from walk import flips  # noqa: E402

# Of each subject (a type of node, of light, of settings, ...) as many flips are tried until one changes a picture,
# in the order of a hash of their names: the same ones in every run, and of what a new Blender brings its share.
MOST_TRIED = 3

PROBES = all_probes()


def _order(flip):
    return hashlib.sha256(flip.identifier.encode()).digest()


def _subject(flip):
    """ "PointLight.energy" and "ShaderNodeMath[Value]" -> "PointLight", "ShaderNodeMath"; deeds are their own."""
    return re.split(r"[.\[]", flip.key)[0]


def _as_sample(probe):
    """All of Blender 4's settings and data in every run; of its hundred nodes a share, which have tests of their own."""
    is_sample = not probe.node and bpy.app.version >= (4, 0)
    return pytest.param(probe, marks=pytest.mark.sample) if is_sample else probe


@pytest.fixture(scope="module")
def session():
    made = Session()
    yield made
    made.close()


@pytest.fixture(scope="module")
def samples(session):
    """{probe's name: [[Flip]]}: a subject's are those of the probe that has the first of them."""
    subjects = {}
    for probe in PROBES:
        _scene, roots = session.build(probe)
        for flip in flips(probe, roots):
            subjects.setdefault(_subject(flip), []).append(flip)
    found = {probe.name: [] for probe in PROBES}
    for members in subjects.values():
        members.sort(key=_order)
        home = members[0].probe
        found[home].append([flip for flip in members if flip.probe == home][:MOST_TRIED])
    return found


@pytest.mark.parametrize("probe", [*map(_as_sample, PROBES)], ids=lambda probe: probe.name)
def test_flips_change_both_pictures_alike_or_are_told(scene, session, samples, probe):
    table = exceptions.entries(exceptions.read_parts())
    subjects = samples[probe.name]
    if not subjects:
        pytest.skip("its subjects are another probe's turn, or not in this Blender")
    judge = Judge(session, probe)
    # What is unchanged, too: beside a picture that failed every flip would be alike.
    verdicts = [judge.baseline().record()]
    verdicts += [record for tried in subjects for record in _judged(judge, tried)]
    faults = [v for v in verdicts if v["verdict"] in FAULTS and not exceptions.listed(v, table)]
    assert not faults, faults


def _judged(judge, tried):
    for flip in tried:
        verdict = judge.judge(flip)
        yield verdict.record()
        if verdict.verdict not in (STAY, UNSET):
            return
