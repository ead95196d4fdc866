# SPDX-License-Identifier: GPL-3.0-or-later
"""What lies under a frame's name where it may be filled but not replaced, and what a trial to open it leaves."""

import errno
import os
from pathlib import Path

import pytest

from addon import final_file

FRAME = b"a frame" * 1000


@pytest.fixture
def files(tmp_path):
    """(the whole frame beside its place, the file of before that is there)"""
    file, final = tmp_path / ".unfinished", tmp_path / "frame_0001.png"
    file.write_bytes(FRAME)
    final.write_bytes(b"earlier")
    return file, final


@pytest.fixture
def refuse(monkeypatch):
    """refuse(owner, name, code, path=None): that function fails, of a path alone if one is given."""

    def refuse_it(owner, name, code, path=None):
        asked = getattr(owner, name)

        def refused(*args, **more):
            if path is None or Path(args[0]) == path:
                raise OSError(code, os.strerror(code))
            return asked(*args, **more)

        monkeypatch.setattr(owner, name, refused)

    return refuse_it


def test_a_frame_takes_its_name(files):
    file, final = files
    final_file.take_name(file, final)
    assert final.read_bytes() == FRAME and not file.exists()


def test_what_may_not_be_replaced_is_filled(files, refuse):
    file, final = files
    refuse(os, "replace", errno.EPERM)
    final_file.take_name(file, final)
    assert final.read_bytes() == FRAME and not file.exists()


@pytest.mark.parametrize("may_be_removed", [True, False])
@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EIO])
def test_what_cannot_be_filled_holds_nothing(files, refuse, code, may_be_removed):
    file, final = files
    refuse(os, "replace", errno.EPERM)
    refuse(os, "fsync", code)
    if not may_be_removed:
        refuse(Path, "unlink", errno.EPERM, final)
    with pytest.raises(OSError) as raised:
        final_file.take_name(file, final)
    assert raised.value.errno == code
    assert final.exists() != may_be_removed and (may_be_removed or final.read_bytes() == b"")
    assert file.read_bytes() == FRAME


def test_what_may_not_be_opened_stays(files, refuse, monkeypatch):
    file, final = files
    refuse(os, "replace", errno.EPERM)

    def opens(path, mode):
        if mode == "wb":
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        return open(path, mode)

    monkeypatch.setattr(final_file, "open", opens, raising=False)
    with pytest.raises(PermissionError):
        final_file.take_name(file, final)
    assert final.read_bytes() == b"earlier" and file.read_bytes() == FRAME


@pytest.mark.parametrize("below", ["", "folder", "folder/of/folders"])
def test_a_trial_leaves_nothing(tmp_path, below):
    assert final_file.why_not_opened(tmp_path / below / "frame_0001.png") == ""
    assert list(tmp_path.iterdir()) == []


def test_a_trial_says_why_and_leaves_nothing(tmp_path, refuse):
    refuse(Path, "touch", errno.EROFS)
    cause = final_file.why_not_opened(tmp_path / "folder" / "frame_0001.png")
    assert cause == os.strerror(errno.EROFS)
    assert list(tmp_path.iterdir()) == []
