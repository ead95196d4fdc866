# SPDX-License-Identifier: GPL-3.0-or-later
"""The libraries of the portable module: their list, how sources are got, what is built again when."""

import hashlib
import json
import re
import subprocess
import sys
import tarfile
from dataclasses import replace
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/portable"))

import libraries as libraries_of  # noqa: E402
import notices  # noqa: E402
import recipes  # noqa: E402
import sources  # noqa: E402
from component import BuildError, Component, read_components  # noqa: E402

COMPONENTS = read_components()


@pytest.mark.parametrize("component", COMPONENTS, ids=lambda c: c.name)
def test_every_library_is_pinned_and_licensed(component):
    before = [c.name for c in COMPONENTS[: COMPONENTS.index(component)]]
    assert set(component.needs) <= set(before)
    assert re.fullmatch("[0-9a-f]{64}", component.sha256)
    assert bool(component.patches) == bool(re.fullmatch("[0-9a-f]{64}", component.patches_sha256))
    assert component.licence and component.version
    assert component.notices or not component.linked
    assert component.source.startswith(("debian:", "pypi:")) and "//" not in component.source
    assert callable(getattr(recipes, component.recipe))


def test_the_list_for_machines_has_all_that_is_linked(tmp_path):
    bill = json.loads(notices.bill(libraries_of.Libraries(tmp_path), "1.2.3"))
    assert (bill["bomFormat"], bill["specVersion"]) == ("CycloneDX", "1.5")
    assert bill["metadata"]["component"]["version"] == "1.2.3"
    listed = {c["name"]: (c["version"], c["hashes"][0]["content"]) for c in bill["components"]}
    assert listed == {c.name: (c.version, c.sha256) for c in COMPONENTS if c.linked}
    for entry in bill["dependencies"]:
        assert set(entry["dependsOn"]) <= set(listed)
    assert notices.bill(libraries_of.Libraries(tmp_path), "1.2.3") == notices.bill(
        libraries_of.Libraries(tmp_path / "elsewhere"), "1.2.3"
    )


def digest(data):
    return hashlib.sha256(data).hexdigest()


@pytest.fixture
def archive(tmp_path, monkeypatch):
    """A folder that stands for an archive of Debian's."""
    root = tmp_path / "archive"
    (root / "pool/main/t/thing").mkdir(parents=True)
    monkeypatch.setattr(sources, "archives", lambda: [f"file://{root}"])
    return root / "pool/main/t/thing"


def test_a_source_is_fetched_once(archive, tmp_path):
    (archive / "thing.tar.gz").write_bytes(b"content")
    target = tmp_path / "cache" / "thing.tar.gz"
    sources.fetch("debian:t/thing/thing.tar.gz", digest(b"content"), target)
    assert target.read_bytes() == b"content"
    (archive / "thing.tar.gz").unlink()
    sources.fetch("debian:t/thing/thing.tar.gz", digest(b"content"), target)


def test_a_source_that_is_not_to_be_had_is_named(archive, tmp_path):
    target = tmp_path / "cache" / "thing.tar.gz"
    with pytest.raises(BuildError) as failure:
        sources.fetch("debian:t/thing/thing.tar.gz", digest(b"content"), target)
    text = str(failure.value)
    assert "t/thing/thing.tar.gz" in text and str(target) in text and digest(b"content") in text


def test_another_content_is_refused_and_not_kept(archive, tmp_path):
    (archive / "thing.tar.gz").write_bytes(b"changed")
    target = tmp_path / "cache" / "thing.tar.gz"
    with pytest.raises(BuildError, match=digest(b"changed")):
        sources.fetch("debian:t/thing/thing.tar.gz", digest(b"content"), target)
    assert not list(target.parent.iterdir())


def packed(path, files, compression="gz"):
    with tarfile.open(path, f"w:{compression}") as tar:
        for name, text in files.items():
            (path.parent / "member").write_text(text)
            tar.add(path.parent / "member", name)
    (path.parent / "member").unlink()
    return sources.sha256(path)


PATCH = """--- a/code.c
+++ b/code.c
@@ -1 +1 @@
-int old;
+int patched;
"""


@pytest.fixture
def thing(archive):
    """A component with a patch of Debian's and an edit of ours."""
    origin = {"thing-1/code.c": "int old;\n", "thing-1/other.c": "int no_member;\n"}
    patches = {"debian/patches/series": "# why\none.patch\n", "debian/patches/one.patch": PATCH}
    return Component(
        name="thing",
        version="1",
        licence="MIT",
        source="debian:t/thing/thing_1.orig.tar.gz",
        sha256=packed(archive / "thing_1.orig.tar.gz", origin),
        patches="debian:t/thing/thing_1-2.debian.tar.xz",
        patches_sha256=packed(archive / "thing_1-2.debian.tar.xz", patches, "xz"),
        edits=[{"file": "other.c", "from": "no_member", "to": "member"}],
        recipe="pretend",
    )


def test_sources_are_patched_and_edited(thing, tmp_path):
    (tmp_path / "source").mkdir()
    sources.prepare(thing, tmp_path / "downloads", tmp_path / "source")
    assert (tmp_path / "source/code.c").read_text() == "int patched;\n"
    assert (tmp_path / "source/other.c").read_text() == "int member;\n"


def test_an_edit_that_does_not_fit_is_named(thing, tmp_path):
    (tmp_path / "source").mkdir()
    spoiled = replace(thing, edits=[{"file": "other.c", "from": "gone", "to": ""}])
    with pytest.raises(BuildError, match="other.c does not hold once: gone"):
        sources.prepare(spoiled, tmp_path / "downloads", tmp_path / "source")


def test_lines_are_dropped_from_every_file_or_it_is_named(thing, tmp_path):
    def prepared(**edit):
        folder = tmp_path / f"source{len(list(tmp_path.iterdir()))}"
        folder.mkdir()
        sources.prepare(replace(thing, edits=[edit]), tmp_path / "downloads", folder)
        return [(folder / name).read_text() for name in ("code.c", "other.c")]

    assert prepared(file="*.c", drop="int .*;") == ["", ""]
    assert prepared(file="code.c", drop="int .*;") == ["", "int no_member;\n"]
    with pytest.raises(BuildError, match="code.c has no line with member"):
        prepared(file="*.c", drop="member")
    with pytest.raises(BuildError, match=r"there is no \*.h"):
        prepared(file="*.h", drop="int")


@pytest.fixture
def libraries(thing, tmp_path, monkeypatch):
    """The library list with nothing in it but the component, and how often it was built."""
    built = []

    def pretend(job):
        built.append(job.component.name)
        (job.prefix / "lib.a").write_text((job.source / "code.c").read_text())

    monkeypatch.setattr(recipes, "pretend", pretend, raising=False)
    monkeypatch.setattr(libraries_of, "read_components", lambda: [thing])
    made = libraries_of.Libraries(tmp_path / "cache")
    monkeypatch.setattr(made, "toolchain", lambda: None)
    made.built = built
    return made


def test_a_library_is_built_once(libraries, thing):
    for _ in range(2):
        libraries.build_all([])
    assert libraries.built == ["thing"]
    assert (libraries.prefix(thing) / "lib.a").read_text() == "int patched;\n"


def test_whether_all_are_built_is_told_by_the_exit_code(libraries, tmp_path, monkeypatch):
    def code():
        monkeypatch.setattr(sys, "argv", ["libraries.py", "--are-built", str(tmp_path / "cache")])
        with pytest.raises(SystemExit) as end:
            libraries_of.main()
        return end.value.code

    assert code()
    libraries.build_all([])
    assert not code()


def test_an_interrupted_library_is_built_again(libraries, thing, monkeypatch):
    libraries.prefix(thing).mkdir(parents=True)
    (libraries.prefix(thing) / "half").write_text("")
    libraries.build_all([])
    assert libraries.built == ["thing"]
    assert not (libraries.prefix(thing) / "half").exists()


def test_what_changes_a_library_gives_it_another_folder(libraries, thing):
    folder = libraries.prefix(thing).name
    for change in ({"sha256": "0" * 64}, {"options": ["A=B"]}, {"cxxflags": "-g"}, {"edits": []}):
        assert libraries.prefix(replace(thing, **change)).name != folder
    assert libraries.prefix(replace(thing, notices=["COPYING"])).name == folder


def test_what_fails_is_named_with_its_log(libraries, thing, monkeypatch):
    def fails(job):
        job.run("sh", "-c", "echo the reason; exit 3")

    monkeypatch.setattr(recipes, "pretend", fails)
    with pytest.raises(BuildError) as failure:
        libraries.build_all([])
    assert "the reason" in str(failure.value) and "thing.log" in str(failure.value)


def built_at(folder, text):
    """A delivered module, compiled with lines of debugging in a folder of its own."""
    (folder / "native/python").mkdir(parents=True)
    (folder / "m.c").write_text(text)
    linker = "-Wl,--build-id=0x" + 40 * "0"
    module = folder / "native/python/granita_core.c.so"
    command = ["gcc", "-g", "-O1", "-shared", "-fPIC", "-nostartfiles", folder / "m.c", linker]
    subprocess.run([*map(str, command), "-o", str(module)], check=True)
    script = str(ROOT / "tools/portable/modules.py")
    out = folder / "delivered"
    subprocess.run([sys.executable, script, str(folder), str(out)], check=True)
    return (out / "granita_core.c.so").read_bytes(), build_id(out / "granita_core.c.so.debug")


def build_id(path):
    notes = subprocess.run(
        ["readelf", "-n", str(path)], check=True, capture_output=True, text=True
    ).stdout
    return re.search("Build ID: ([0-9a-f]{40})", notes)[1]


def test_a_module_is_the_same_wherever_it_was_built(tmp_path):
    here, there = (built_at(tmp_path / name, "int f;\n") for name in ("a", "b"))
    assert here == there
    other = built_at(tmp_path / "c", "int f = 7;\n")
    assert other[1] != here[1]
    assert bytes.fromhex(here[1]) in here[0]
