#!/usr/bin/env bash
# Fetches MuJoCo's library and headers, which PyPI has as a wheel.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

# docs/mujoco.md says why no other version will do.
version=4.0.0
hash=885bd9b9cc0a6b5ba1114923eb954027652a6a0c115fa46b3218b83bae72ac4f
folder="$root/build/mujoco"

usage() {
    cat <<END
usage: scripts/mujoco.sh [--help]

Downloads MuJoCo $version for Linux on x86-64 from PyPI, checks it against a known hash, and unpacks its library and headers
under build/mujoco/, where CMake looks for them: the demo mujoco_flexes, the engine plugin and their tests are then built.
Does nothing where it is there already.
Exit status: 0 when it is there, 1 when it cannot be had, 2 for a wrong command line.
END
}

case "${1:-}" in
    '') ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac

[[ ! -e "$folder/lib/libmujoco.so.$version" ]] || exit 0

# Debian's Python has no pip of its own outside of virtual environments.
environment="$root/build/mujoco-download"
unset PYTHONPATH PYTHONHOME
export PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_QUIET=1
make_environment "$environment"
say "Downloading MuJoCo $version from PyPI"
printf 'mujoco-core==%s --hash=sha256:%s\n' "$version" "$hash" >"$environment/requirements.txt"
"$environment/bin/pip" download --no-deps --require-hashes --only-binary :all: --python-version 3.11 \
    --implementation cp --platform manylinux_2_28_x86_64 --dest "$environment" --requirement "$environment/requirements.txt" ||
    fail "PyPI did not give mujoco-core $version: is there a network?"

# The library comes last, since its presence means that all is there.
rm -rf "$folder" "$environment/unpacked"
"$environment/bin/python" -m zipfile --extract "$environment"/mujoco_core-"$version"-*.whl "$environment/unpacked"
mkdir -p "$folder/lib"
cp -r "$environment/unpacked/mujoco/include" "$environment/unpacked/mujoco_core-$version.dist-info/licenses" "$folder/"
cp "$environment/unpacked/mujoco/libmujoco.so.$version" "$folder/lib/"
rm -rf "$environment"
