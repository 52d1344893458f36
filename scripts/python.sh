#!/usr/bin/env bash
# Builds the Python package as a wheel and tests what it installs.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/python.sh [--help]

Builds the wheel in target/python/wheel around cargo's release build, as PyPI takes it (auditwheel, twine check), installs it
in a virtual environment of its own in target/python, where it stays, checks its types with mypy, and runs python/tests
against it from outside of the sources, the listings of README.md and of the tutorial, recipes and contact system in docs/
included. Tools, numpy, scipy, trimesh and scikit-fem come from PyPI, in fixed versions; NVIDIA Newton, which is large, does not,
and its program runs where it is installed.
Exit status: 0 when all tests pass, 1 when something fails, 2 for a wrong command line.
END
}

case "${1:-}" in
    '') ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac

tools=(mypy==2.4.1 numpy==2.4.6 pytest==9.2.0 scikit-fem==12.0.2 scipy==1.17.1 trimesh==5.2.0 twine==7.0.0)
wheels="$root/target/python/wheel"
environment="$root/target/python/environment"

source scripts/wheel.sh
install_wheel "$environment" "$wheels" "${tools[@]}"

"$environment/bin/twine" check --strict "$wheels"/*.whl >&2 || fail 'PyPI would refuse the wheel, see above'
cd "$environment"
"$environment/bin/python" -m mypy --config-file "$root/pyproject.toml" --cache-dir "$environment/.mypy_cache" \
    --package raycontact || fail 'the Python types are wrong'
"$environment/bin/python" -m pytest -p no:cacheprovider --quiet --strict-markers -W error "$root/python/tests" ||
    fail 'the Python tests failed'
