# SPDX-License-Identifier: GPL-3.0-or-later
# The zips for every Linux, for `dev`, which reads this: their module, what is in them, and their native tests.

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

build_portable() {  # -> $BUILD/portable/delivered
    configure_portable
    nice -n 15 ninja -C "$BUILD/portable" -j 2 granita_core >&2
    "$PYTHON" "$ROOT/tools/portable/modules.py" "$BUILD/portable" "$BUILD/portable/delivered"
    "$PYTHON" "$ROOT/tools/portable/notices.py" "$CACHE" "$BUILD/portable/delivered"
}

package_portable() {
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
