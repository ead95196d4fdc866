# SPDX-License-Identifier: GPL-3.0-or-later
"""What is found wrong with a file that was just written; the formats' ends: tests/blender/test_written_frames.py."""

import errno
import os

import pytest

from addon import whole_file

WHOLE = b"\x89PNG\r\n\x1a\n" + bytes(100) + b"IEND\xae\x42\x60\x82"


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "frame_0001.png"
    path.write_bytes(WHOLE)
    return path


def test_nothing_is_wrong_with_a_whole_file(file):
    assert whole_file.fault(file) == ""


def test_a_cut_file_may_be_a_full_disks(file):
    file.write_bytes(WHOLE[:50])
    assert whole_file.fault(file) == "the disk may be full"


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EDQUOT, errno.EIO])
def test_a_disk_that_does_not_take_it_says_why(file, monkeypatch, code):
    def refuses(_descriptor):
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(os, "fsync", refuses)
    assert whole_file.fault(file) == os.strerror(code)


@pytest.mark.parametrize("code", [errno.EINVAL, errno.ENOSYS, errno.EOPNOTSUPP])
def test_a_disk_that_cannot_flush_lost_nothing(file, monkeypatch, code):
    def refuses(_descriptor):
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(os, "fsync", refuses)
    assert whole_file.fault(file) == ""
    file.write_bytes(WHOLE[:50])
    assert whole_file.fault(file) == "the disk may be full"


def test_a_file_that_may_only_be_read_is_opened_for_that(file, monkeypatch):
    """Whoever runs this may be one that may write everything."""
    modes = []

    def opens(path, mode, *others, **more):
        modes.append(mode)
        return open(path, mode, *others, **more)

    monkeypatch.setattr(whole_file, "open", opens, raising=False)
    assert whole_file.fault(file) == ""
    assert set(modes) == {"rb"}


def test_a_file_that_is_not_there_raises(tmp_path):
    with pytest.raises(FileNotFoundError):
        whole_file.fault(tmp_path / "none.png")
