#!/usr/bin/env bash
# Makes the manual as one site, with a search, from the pages in docs/ and the texts of the C and C++ headers and the Python package.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/manual.sh [--help]

Writes build/site. Open build/site/index.html: the site needs no server and no network. The pages are those of docs/, in the
order of mkdocs.yml; Doxygen adds the C headers, and MkDocs the docstrings of the Python package. MkDocs and its theme come from
PyPI, in the versions of docs/site/requirements.txt, into target/manual/venv.
A dead link, a page that mkdocs.yml does not name, and a site of more than 10 MB are errors.
Exit status: 0 when the site is made, 1 when something failed, 2 for a wrong command line.
END
}

case "${1:-}" in
    '') ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac

most_bytes=10000000
environment=target/manual/venv

command -v doxygen >/dev/null || fail 'doxygen is missing. On Debian: scripts/setup.sh'
# Nothing of the caller's own Python: only what is installed here.
unset PYTHONPATH PYTHONHOME
export PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_QUIET=1 PYTHONDONTWRITEBYTECODE=1 NO_MKDOCS_2_WARNING=1
make_environment "$environment"
"$environment/bin/pip" install --requirement docs/site/requirements.txt ||
    fail 'pip could not install docs/site/requirements.txt: is there a network?'

rm -rf build/reference build/site
mkdir -p build/reference
doxygen - <<END || fail 'doxygen could not make pages of the headers'
@INCLUDE               = docs/Doxyfile
INPUT                  = include
FILE_PATTERNS          = *.h *.hpp
USE_MDFILE_AS_MAINPAGE =
OUTPUT_DIRECTORY       = build/reference
HTML_OUTPUT            = html
VERBATIM_HEADERS       = NO
SEARCHENGINE           = NO
GENERATE_XML           = YES
XML_PROGRAMLISTING     = NO
END
"$environment/bin/mkdocs" build || fail 'MkDocs could not make the site'

bytes="$(find build/site -type f -printf '%s\n' | awk '{ sum += $1 } END { print sum }')"
((bytes <= most_bytes)) || fail "build/site has $bytes bytes, more than $most_bytes: what is new and large in docs/?"
say "$root/build/site/index.html, $bytes bytes"
