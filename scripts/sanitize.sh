#!/usr/bin/env bash
# The C and C++ tests with every access checked, the library included.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/sanitize.sh [address] [memcheck]

Builds the library and the tests of cpp_tests/ in folders of their own and runs them:
  address   with the address, leak and undefined-behaviour sanitizers: C, C++ and the library (the last by
            -Zsanitizer=address, which RUSTC_BOOTSTRAP allows on the stable compiler)
  memcheck  the C tests under valgrind, with no leak
Without arguments both, some ten minutes. Each first shows that it sees a fault made on purpose.
Exit status: 0 when nothing was found, 1 otherwise, 2 for a wrong command line.
END
}

kinds=()
while (($#)); do
    case "$1" in
        address | memcheck) kinds+=("$1") ;;
        -h | --help) usage && exit 0 ;;
        *) usage >&2 && fail "unknown argument '$1'" 2 ;;
    esac
    shift
done
((${#kinds[@]})) || kinds=(address memcheck)
scripts/setup.sh

# build <kind> <cargo's flags> <C's flags> <target>...
build() {
    local kind="$1" rust_flags="$2" c_flags="$3" folder="$root/build/sanitize-$1"
    shift 3
    export RUSTC_BOOTSTRAP=1 RUSTFLAGS="$rust_flags" CARGO_PROFILE_RELEASE_CODEGEN_UNITS=16 CARGO_PROFILE_RELEASE_DEBUG=1
    cmake -S . -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DRAYCONTACT_INSTALL=OFF \
        -DRAYCONTACT_CARGO_TARGET_DIR="$folder/cargo" -DCMAKE_C_FLAGS="$c_flags" -DCMAKE_CXX_FLAGS="$c_flags" >/dev/null
    cmake --build "$folder" --target "$@" >"$folder/log" 2>&1 || fail "$kind: the build failed: $(tail "$folder/log")"
    unset RUSTC_BOOTSTRAP RUSTFLAGS CARGO_PROFILE_RELEASE_CODEGEN_UNITS CARGO_PROFILE_RELEASE_DEBUG
}

# The fault made on purpose: the library is told of one vertex more than the array has.
sees_a_fault() {
    local kind="$1" output
    shift
    output="$("$@" 2>&1)" && fail "$kind: a fault made on purpose was not seen: $*"
    grep -qE 'AddressSanitizer: heap-buffer-overflow|Invalid read' <<<"$output" || fail "$kind: another fault: $output"
}

# Without misuse, which reads what it has destroyed.
c_tests=(bad_arguments bad_mesh bad_positions bad_vectors bad_octree coarse_sampling query_pair response scene
    body_numbers pair_memory self_collision)

for kind in "${kinds[@]}"; do
    say "$kind"
    folder="$root/build/sanitize-$kind"
    case "$kind" in
        address)
            build address -Zsanitizer=address '-fsanitize=address,undefined -fno-sanitize-recover=undefined' all short_array
            sees_a_fault address "$folder/cpp_tests/short_array"
            # Unloading is no business of the sanitizer's, which stays loaded; the manual and mixtures run no code. The
            # sanitizer makes frames larger, so what the stack takes says nothing.
            ctest --test-dir "$folder" --output-on-failure --timeout 600 -E 'manual|unload|bullet_mixed|two_rust|small_stack'
            ;;
        memcheck)
            build memcheck '' '' "${c_tests[@]}" short_array
            memcheck=(valgrind --quiet --error-exitcode=1 --leak-check=full
                --errors-for-leak-kinds=definite,indirect,possible "--suppressions=$root/scripts/memcheck.supp")
            sees_a_fault memcheck "${memcheck[@]}" "$folder/cpp_tests/short_array"
            for test in "${c_tests[@]}"; do
                # Valgrind knows no AVX-512.
                RAYCONTACT_SIMD=avx2 "${memcheck[@]}" "$folder/cpp_tests/$test" >"$folder/$test.log" 2>&1 ||
                    fail "memcheck: $test: $(cat "$folder/$test.log")"
            done
            ;;
    esac
done
say "nothing found by: ${kinds[*]}"
