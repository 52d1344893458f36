# shellcheck shell=bash
# Builds the Python package as a wheel: sourced after common.sh, not run.

# install_wheel <environment> <folder for the wheel> <package of PyPI>...: makes the virtual environment where there is none,
# and installs the packages and the wheel into it.
install_wheel() {
    local environment="$1" wheels="$2"
    shift 2
    # Nothing of the caller's own Python: only what is installed here.
    unset PYTHONPATH PYTHONHOME
    export PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_QUIET=1 PYTHONDONTWRITEBYTECODE=1
    [[ -x "$environment/bin/pip" ]] || python3 -m venv --clear "$environment" ||
        fail "python3 cannot make a virtual environment in $environment. On Debian: scripts/setup.sh"
    "$environment/bin/pip" install "$@" || fail "pip could not install $*"

    say 'Building the wheel'
    rm -rf "$wheels"
    "$environment/bin/pip" wheel --no-deps --no-build-isolation --wheel-dir "$wheels" "$root" ||
        fail 'the wheel could not be built'
    "$environment/bin/pip" install --force-reinstall --no-deps "$wheels"/*.whl || fail 'the wheel could not be installed'
    say "$(ls -sh "$wheels"/*.whl | sed "s|$root/||")"
}
