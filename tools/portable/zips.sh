# SPDX-License-Identifier: GPL-3.0-or-later
# The zips for every Linux, for `dev`, which reads this: their module, what is in them, and their tests.

# What builds the libraries of the packages for every Linux, beside their sources (tools/portable).
PORTABLE_PACKAGES=(make patch nasm bzip2 xz-utils unzip)

# Python and blender_ext.py of each Blender that is installed as a module, joined by colons.
extension_validators() {
    local program
    for program in "$CACHE"/bpy-*/lib/python3*/site-packages/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py; do
        [[ -f $program ]] && printf '%s:%s\n' "${program%%/lib/python3*}/bin/python" "$program"
    done
}

configure_portable() {  # OPTION...
    ensure_packages "${PACKAGES[@]}" "${PORTABLE_PACKAGES[@]}"
    local toolchain
    toolchain=$("$PYTHON" "$ROOT/tools/portable/libraries.py" "$CACHE") ||
        die "the zips for every Linux are not made; ./dev package --debian12 makes some out of Debian's own libraries"
    # What CMake found of other libraries it would keep.
    grep -qsF "$toolchain" "$BUILD/portable/.configured" || rm -f "$BUILD/portable/CMakeCache.txt"
    configure "$BUILD/portable" -DCMAKE_TOOLCHAIN_FILE="$toolchain" "$@"
}

# Without them the tests would take half an hour more.
portable_libraries_are_built() { "$PYTHON" "$ROOT/tools/portable/libraries.py" --are-built "$CACHE"; }

build_portable() {  # -> $BUILD/portable/delivered
    configure_portable
    nice -n 15 ninja -C "$BUILD/portable" -j 2 granita_core >&2
    "$PYTHON" "$ROOT/tools/portable/modules.py" "$BUILD/portable" "$BUILD/portable/delivered"
    "$PYTHON" "$ROOT/tools/portable/notices.py" "$CACHE" "$BUILD/portable/delivered"
}

package_portable() {
    rm -f "$ROOT/dist/granita-$VERSION-linux-x64"*.zip  # or what was made before would be tested
    build_portable
    local delivered=$BUILD/portable/delivered name=$ROOT/dist/granita-$VERSION-linux-x64
    "$PYTHON" "$ROOT/tools/package.py" zips "$ROOT" "$ROOT/dist" linux-x64 \
        "$delivered"/*.so "$delivered"/{THIRD-PARTY.txt,bom.cdx.json}
    "$PYTHON" "$ROOT/tools/package.py" files "$name-symbols.zip" "$delivered"/*.debug
    check_portable
}

check_portable() {  # the zips in dist/, whenever they were made
    local name=$ROOT/dist/granita-$VERSION-linux-x64 validators
    mapfile -t validators < <(extension_validators)
    nice -n 15 "$PYTHON" "$ROOT/tools/check_package.py" "$name.zip" "$name-legacy.zip" -- "${validators[@]}" ||
        die "the zips break rules of docs/decisions/portable.md"
    say "Checked by the rules of docs/decisions/portable.md and ${#validators[@]} Blenders' own validators"
}

portable_native_tests() {  # built as the zips' module is
    configure_portable -DGRANITA_TESTS=ON
    nice -n 15 ninja -C "$BUILD/portable" -j 2 >&2
    native_tests "$BUILD/portable"
}

unpack_zips() {  # names them to the suites
    local zip=$ROOT/dist/granita-$VERSION-linux-x64 scripts=$BUILD/packaged/addons
    [[ -f $zip-legacy.zip ]] || die "there is no $zip-legacy.zip: ./dev package"
    rm -rf "$scripts"
    mkdir -p "$scripts"
    "$PYTHON" -m zipfile -e "$zip-legacy.zip" "$scripts"
    export GRANITA_ADDON=$scripts/granita GRANITA_ZIP=$zip.zip
}

packaged_smoke() {
    unpack_zips
    packaged_suite 3.4 -m smoke "$ROOT/tests/blender"
}

# The suites against the zips of ./dev package, in configurations that hold nothing else.
packaged_parts() {
    local version
    unpack_zips
    part 'rules of the zips' check_portable
    part 'native, clang and libc++' portable_native_tests
    for version in 3.4 4.2 4.5 5.0; do
        part "package, Blender $version" packaged_suite "$version" "$ROOT/tests/blender"
    done
    if python_313 >/dev/null; then
        part "package, Blender $NEWEST_BPY" packaged_suite "$NEWEST_BPY" "$ROOT/tests/blender"
    else
        say "Without CPython 3.13 the module for it is not tested (GRANITA_PYTHON_313 names one)"
        FAILED=1
    fi
}

packaged_suite() {  # VERSION PYTEST-ARG...
    local version=$1
    shift
    [[ $version == 3.4 ]] || ensure_bpy "$version"
    unset PYTHONPATH
    if [[ $version == 3.4 ]]; then
        exec blender -b --factory-startup --python-exit-code 1 \
            --python "$ROOT/tests/blender/run_in_blender.py" -- -p no:cacheprovider "$(report "packaged-$version")" "$@"
    fi
    exec "$CACHE/bpy-$version/bin/python" "$ROOT/tests/blender/run_in_blender.py" -- \
        -p no:cacheprovider "$(report "packaged-$version")" "$@"
}
