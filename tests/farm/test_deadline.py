# SPDX-License-Identifier: GPL-3.0-or-later
"""AWS Deadline Cloud without an account: its adaptor's own job template, its reader of job bundles."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import exr
import numpy as np
import pytest
from deadline.client.job_bundle.parameters import read_job_bundle_parameters

ROOT = Path(__file__).resolve().parents[2]
TOOLS = Path(sys.executable).parent
PACKAGE = Path(importlib.util.find_spec("deadline.blender_adaptor").origin).parents[1]
SUBMITTER = PACKAGE / "blender_submitter/addons/deadline_cloud_blender_submitter"

# ./dev gives Blender a PYTHONPATH of its own, where the adaptor's stood.
KEEP_PATH = 'import os, sys; sys.path += os.environ["ADAPTOR_PATH"].split(os.pathsep)'


@pytest.fixture
def run(blender, tmp_path):
    """run(command...) in a worker's environment, at a home of its own."""
    program = tmp_path / "blender"
    program.write_text(
        f'#!/bin/sh\nADAPTOR_PATH=$PYTHONPATH exec "{blender}" --python-expr \'{KEEP_PATH}\' "$@"\n'
    )
    program.chmod(0o755)
    (tmp_path / "home").mkdir()
    environment = os.environ | {
        "PATH": f"{TOOLS}:{os.environ['PATH']}",
        "HOME": str(tmp_path / "home"),
        "DEADLINE_CLOUD_TELEMETRY_OPT_OUT": "true",
        "BLENDER_EXECUTABLE": str(ROOT / "farm/deadline/blender"),
        "GRANITA_BLENDER": str(program),
    }

    def start(*command):
        return subprocess.run(
            [str(word) for word in command],
            env=environment,
            capture_output=True,
            text=True,
            stdin=subprocess.DEVNULL,
            timeout=300,
        )

    return start


def test_the_adaptors_own_job_renders_frames_by_granita_in_one_blender(
    run, blender, scene, tmp_path
):
    out, plain = tmp_path / "out", tmp_path / "plain"
    parameters = {"BlenderFile": scene, "Frames": "1-2", "OutputDir": out}
    parameters |= {"OutputFormat": "OPEN_EXR_MULTILAYER", "RenderEngine": "workbench"}
    words = [word for pair in parameters.items() for word in ("-p", "=".join(map(str, pair)))]
    template = SUBMITTER / "default_blender_template.yaml"
    done = run(TOOLS / "openjd", "run", template, "--step", "RenderBlender", *words)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("Read blend: ") == 1
    run(blender, "-b", scene, "-o", plain / "####", "-f", "1..2")
    for frame in ("0001", "0002"):
        expected = exr.read(plain / f"{frame}.exr")
        for channel, plane in exr.read(out / f"ViewLayer_output_{frame}.exr").items():
            np.testing.assert_array_equal(plane, expected[channel])


def test_the_adaptor_knows_no_engine_by_the_name_granita(run, scene):
    """Where this fails, farm/deadline may be superfluous."""
    start = f'{{"scene_file": "{scene}", "gpu_device": "NONE", "render_engine": "granita"}}'
    done = run(TOOLS / "blender-openjd", "run", "--init-data", start, "--run-data", '{"frame": 1}')
    assert done.returncode != 0
    assert "'granita' is not one of ['eevee', 'workbench', 'cycles']" in done.stdout + done.stderr


@pytest.mark.parametrize("name", ["granita_frames", "granita_parts"])
def test_deadlines_client_reads_the_job_bundles(name):
    found = read_job_bundle_parameters(str(ROOT / "farm/openjd" / name))
    types = {parameter["name"]: parameter["type"] for parameter in found}
    assert types["SceneFile"] == types["OutputFolder"] == "PATH"
    assert types["Frames"] == "STRING"
