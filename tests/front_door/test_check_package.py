# SPDX-License-Identifier: GPL-3.0-or-later
"""The rules of zips for every Linux: each broken by a small zip of its own."""

import json
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "tools/portable")]

from check_package import MODULES, broken_package_rules, refused  # noqa: E402
from modules import deliver  # noqa: E402

DATE = (1980, 1, 1, 0, 0, 0)
TEXT = "void *PyInit_granita_core(void) { return 0; }\n"
LIBRARY = {
    "name": "zlib",
    "version": "1.3",
    "hashes": [{"alg": "SHA-256", "content": 64 * "a"}],
    "licenses": [{"expression": "Zlib"}],
}


def built(folder, text):
    """{name: bytes} of both modules and of what was stripped off them."""
    folder.mkdir()
    source, linked, delivered = folder / "m.c", folder / "linked", folder / "delivered"
    source.write_text(text)
    for path in (linked, delivered):
        path.mkdir()
    script = f"-Wl,--version-script={ROOT / 'cmake/exports.map'}"
    for name in MODULES:
        command = ["gcc", "-shared", "-fPIC", "-O2", "-nostartfiles", source, script]
        command += [f"-Wl,--build-id=0x{40 * '0'}", "-o", linked / name]
        subprocess.run([str(word) for word in command], check=True)
        deliver(linked / name, delivered)
    return {path.name: path.read_bytes() for path in delivered.iterdir()}


@pytest.fixture(scope="module")
def modules(tmp_path_factory):
    return built(tmp_path_factory.mktemp("modules") / "plain", TEXT)


class Zips:
    """The two zips and their symbols, good until one spoils them."""

    def __init__(self, folder, modules):
        self.folder = folder
        self.symbols = {n: content for n, content in modules.items() if n.endswith(".debug")}
        self.files = {n: content for n, content in modules.items() if n.endswith(".so")}
        self.files |= {"__init__.py": b"", "LICENSE": b"GPL", "blender_manifest.toml": b""}
        self.files["THIRD-PARTY.txt"] = b"In the module:\n\n  zlib 1.3  (Zlib)\n"
        self.list_libraries(LIBRARY)

    def list_libraries(self, *components):
        self.files["bom.cdx.json"] = json.dumps({"components": components}).encode()

    def legacy(self):
        self.files.pop("blender_manifest.toml", None)
        self.files = {"granita/": b"", **{f"granita/{n}": c for n, c in self.files.items()}}
        return self

    def write(self, names=None, date=DATE, before=0):
        """`before`: bytes of nothing ahead of the zip, which unpacks all the same."""
        kind = "-legacy" if any(name.startswith("granita/") for name in self.files) else ""
        path = self.folder / f"granita-9-linux-x64{kind}.zip"
        with path.open("wb") as opened:
            opened.seek(before)
            with zipfile.ZipFile(opened, "w") as archive:
                for name in names or sorted(self.files):
                    archive.writestr(zipfile.ZipInfo(name, date), self.files[name])
        with zipfile.ZipFile(self.folder / "granita-9-linux-x64-symbols.zip", "w") as archive:
            for name, content in self.symbols.items():
                archive.writestr(name, content)
        return path


@pytest.fixture
def zips(tmp_path, modules):
    return Zips(tmp_path, modules)


def test_good_zips_break_none(zips):
    assert broken_package_rules(zips.write()) == []
    assert broken_package_rules(zips.legacy().write()) == []


def test_more_than_40_mib_are_told(zips):
    assert broken_package_rules(zips.write(before=39 * 2**20)) == []
    assert broken_package_rules(zips.write(before=40 * 2**20)) == ["has 40.0 MiB"]


def test_dates_and_orders_of_the_day_are_told(zips):
    (said,) = broken_package_rules(zips.write(date=(2024, 2, 29, 12, 0, 0)))
    assert "same whenever" in said
    (said,) = broken_package_rules(zips.write(names=sorted(zips.files, reverse=True)))
    assert "same whenever" in said


def test_a_legacy_file_outside_of_the_folder_is_told(zips):
    zips.legacy().files["setup.py"] = b""
    assert broken_package_rules(zips.write()) == ["holds files outside of granita/"]


def test_a_legacy_zip_without_its_folders_entry_is_told(zips):
    del zips.legacy().files["granita/"]
    (said,) = broken_package_rules(zips.write())
    assert "no entry of granita/" in said


def test_manifests_are_of_extensions_alone(zips):
    manifest = zips.files.pop("blender_manifest.toml")
    assert broken_package_rules(zips.write()) == ["has no blender_manifest.toml"]
    zips.legacy().files["granita/blender_manifest.toml"] = manifest
    assert broken_package_rules(zips.write()) == ["has a blender_manifest.toml"]


@pytest.mark.parametrize("name", sorted(MODULES))
def test_a_module_that_is_not_there_is_told(zips, name):
    del zips.files[name]
    (said,) = broken_package_rules(zips.write())
    assert said.startswith("has the modules ")


def test_a_third_module_is_told(zips):
    other = "granita_core.cpython-312-x86_64-linux-gnu.so"
    zips.files[other], zips.symbols[f"{other}.debug"] = (
        next(content for name, content in part.items() if "311" in name)
        for part in (zips.files, zips.symbols)
    )
    (said,) = broken_package_rules(zips.write())
    assert said.startswith("has the modules ") and "312" in said


@pytest.mark.parametrize("name", ["LICENSE", "THIRD-PARTY.txt", "bom.cdx.json", "__init__.py"])
def test_a_file_that_is_not_there_is_named(zips, name):
    del zips.files[name]
    assert broken_package_rules(zips.write()) == [f"has no {name}"]


def test_a_library_without_its_notice_is_named(zips):
    zips.list_libraries(LIBRARY, LIBRARY | {"name": "libpng"})
    assert broken_package_rules(zips.write()) == ["has no notice of libpng 1.3"]
    zips.list_libraries(LIBRARY | {"version": "1.2"})
    assert broken_package_rules(zips.write()) == ["has no notice of zlib 1.2"]


@pytest.mark.parametrize(
    "lack", [{"hashes": [{"alg": "SHA-256", "content": "a"}]}, {"hashes": []}, {"licenses": []}]
)
def test_a_library_of_no_origin_or_licence_is_named(zips, lack):
    zips.list_libraries(LIBRARY | lack)
    assert broken_package_rules(zips.write()) == ["does not say what zlib was built from"]


def test_an_empty_list_of_libraries_is_told(zips):
    zips.list_libraries()
    assert broken_package_rules(zips.write()) == ["lists no library"]


def test_rules_of_modules_hold_in_zips(zips, tmp_path):
    (name, *_) = sorted(MODULES)
    stranger = built(tmp_path / "stranger", "void *f(void);\n" + TEXT.replace("0", "f()"))
    zips.files[name], zips.symbols[f"{name}.debug"] = stranger[name], stranger[f"{name}.debug"]
    for path in (zips.write(), zips.legacy().write()):
        assert broken_package_rules(path) == [f"{name} needs symbols of no library: f"]


def test_symbols_lie_beside_the_zips(zips, tmp_path):
    (name, *_) = sorted(MODULES)
    debug = f"{name}.debug"
    other = built(tmp_path / "other", TEXT.replace("return 0", "return (void *)1"))
    zips.symbols[debug] = other[debug]
    (said,) = broken_package_rules(zips.write())
    assert said.startswith(f"{name} is not what the symbols beside it are of")


def test_symbols_that_are_not_there_are_named(zips):
    (name, *_) = sorted(MODULES)
    del zips.symbols[f"{name}.debug"]
    path = zips.write()
    assert broken_package_rules(path) == [f"has no symbols of {name} beside it"]
    path.with_name("granita-9-linux-x64-symbols.zip").unlink()
    assert [f"has no symbols of {n} beside it" for n in sorted(MODULES)] == (
        broken_package_rules(path)
    )


@pytest.mark.parametrize(
    "program, said",
    [
        ("", []),
        ("print('Success')", []),
        ("print('ERROR: no manifest')", "ERROR: no manifest"),
        ("raise SystemExit('no manifest')", "no manifest"),
    ],
)
def test_what_a_validator_says_counts(zips, tmp_path, program, said):
    validator = tmp_path / "blender_ext.py"
    validator.write_text(f"import sys\nassert sys.argv[1] == 'validate'\n{program}\n")
    found = refused(zips.write(), f"{sys.executable}:{validator}")
    assert found == (said and [f"is refused by {validator}: {said}"])


def test_the_program_names_each_zip_and_ends_with_exit_code_1(zips):
    def ran(*words):
        words = [sys.executable, ROOT / "tools/check_package.py", *words]
        return subprocess.run([str(w) for w in words], capture_output=True, text=True)

    assert ran(zips.write()).returncode == 0
    del zips.files["LICENSE"]
    extension = zips.write()
    legacy = zips.legacy().write()
    done = ran(extension, legacy)
    assert done.returncode == 1
    assert done.stderr.splitlines() == [
        f"{extension.name} has no LICENSE",
        f"{legacy.name} has no LICENSE",
    ]
