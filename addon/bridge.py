# SPDX-License-Identifier: GPL-3.0-or-later
"""The way to the native library: the only importer of `granita_core`.

The module lies inside the add-on's folder (an installed package) or on Python's path (a build
tree, a wheel).  It is imported when it is first needed, so that a missing or foreign build is a
message in the panel and at render, never a failed registration.
"""

import importlib
import os
import sys
import tempfile
from contextlib import contextmanager, suppress
from pathlib import Path

from . import host
from .export.base.report import Cancelled

MODULE = "granita_core"


class NativeModuleMissing(Exception):
    """`granita_core` cannot be loaded; the text says why and what to do."""


class DeviceError(Exception):
    """OpenGL failed while it rendered.  (That it is absent the library finds itself.)"""


class RenderError(Exception):
    """The native library refused the scene or failed; the text names the datablock."""


class MemoryShort(RenderError):
    """The frame wanted more memory than its limit, or than the system gives; the text says what took it."""


# What the library says then (native/render/frame_memory.cpp, render_job.cpp).
_MEMORY_SHORT = ("the frame wants more memory", "the system gives no more memory")


def load():
    """Returns the module `granita_core`.  Raises NativeModuleMissing."""
    unfit = host.problem(host.this_host())
    if unfit:
        raise NativeModuleMissing(unfit)
    for name, package in ((f".{MODULE}", __package__), (MODULE, None)):
        absolute = f"{package}{name}" if package else name
        try:
            return importlib.import_module(name, package)
        except ModuleNotFoundError as error:
            if error.name != absolute:
                raise NativeModuleMissing(f"{MODULE} cannot be loaded: {error}") from error
        except ImportError as error:
            raise NativeModuleMissing(f"{MODULE} cannot be loaded: {error}") from error
    raise NativeModuleMissing(_why_missing())


def problem():
    """What stops the native module from being used, for the panel; "" when nothing does."""
    try:
        load()
    except NativeModuleMissing as error:
        return str(error)
    return ""


def _why_missing():
    here = f"Python {sys.version_info.major}.{sys.version_info.minor}"
    folders = [Path(__file__).parent, *(Path(entry) for entry in sys.path if entry)]
    found = sorted({file.name for folder in folders for file in folder.glob(f"{MODULE}.*")})
    if found:
        return f"the native module is not for {here}, which runs here: there is {', '.join(found)}"
    return f"the native module {MODULE} is not installed: install a Granita package for {here}"


def crash_file():
    """Where a fault of this process leaves its report."""
    return os.path.join(tempfile.gettempdir(), f"granita-crash-{os.getpid()}.txt")


@contextmanager
def rendering(snapshot, about=""):
    """Renders a scene snapshot (docs/scene_snapshot.md): yields the running granita_core.Render.
    The snapshot is emptied.  `about`: lines that a report of a crash begins with.

    On a normal exit the job is finished and its first failure raised; on any other it is
    cancelled and joined.  Native exceptions arrive as those of this file.
    """
    core = load()
    with _crash_reported(core, about), _translated(core):
        scene = core.Scene(snapshot)
        snapshot.clear()  # copied: a large scene need not be held twice
        job = core.Render(scene)
        try:
            yield job
        except BaseException:
            job.cancel()
            with suppress(core.Error):
                job.finish()
            raise
        job.finish()


def new_session():
    """A granita_core.Session: keeps what the next picture can use again."""
    core = load()
    with _translated(core):
        return core.Session()


def begin(snapshot, session):
    """A running granita_core.Render of a snapshot, which is copied and kept.  `session`: of `new_session`."""
    core = load()
    with _translated(core):
        return core.Render(core.Scene(snapshot, session))


def end(job):
    """Joins a job that is done and raises its first failure; at once where it is done."""
    with _translated(load()):
        job.finish()


@contextmanager
def _crash_reported(core, about):
    """A fault of the process leaves a file."""
    report = core.CrashReport(crash_file(), about)
    try:
        yield
    finally:
        del report


@contextmanager
def _translated(core):
    """Native exceptions as those of this file."""
    try:
        yield
    except core.Cancelled as error:
        raise Cancelled from error
    except core.GlError as error:
        raise DeviceError(str(error)) from error
    except core.Error as error:
        kind = MemoryShort if str(error).startswith(_MEMORY_SHORT) else RenderError
        raise kind(str(error)) from error
