#!/bin/sh
# make_venv.sh FOLDER PINS VERSION...: a virtual environment with exactly the packages of PINS, by the first Python found of one of the versions.
# In it this tree can be imported from any folder.
# PYTHON=/path/to/python in the environment is taken instead of searching.
set -eu
folder=$1 pins=$2
shift 2
versions=$*

fail() {
    echo "$0: $*" >&2
    exit 1
}

# runs and has one of the versions (a pyenv shim of a version that is not selected exists and fails)
right_version() {
    "$1" -c 'import sys; sys.exit("%d.%d" % sys.version_info[:2] not in sys.argv[1:])' $versions 2>/dev/null
}

makes_environments() {
    "$1" -c 'import ensurepip, venv' 2>/dev/null
}

candidates() {
    echo "${PYTHON:-python3}"
    [ -z "${PYTHON:-}" ] || return 0
    for version in $versions; do
        echo "python$version"
        ls -d "${PYENV_ROOT:-$HOME/.pyenv}/versions/$version".*/bin/python3 2>/dev/null || :
    done
}

case "$(uname -s) $(uname -m)" in
    'Linux x86_64') ;;
    *) fail "the ROS wheels exist for Linux on x86-64 only, this is $(uname -s) on $(uname -m); see docs/install.md for ROS from apt" ;;
esac

if ! right_version "$folder/bin/python"; then
    python='' without_venv=''
    for candidate in $(candidates); do
        right_version "$candidate" || continue
        if makes_environments "$candidate"; then
            python=$candidate
            break
        fi
        without_venv=$candidate
    done
    if [ -z "$python" ] && [ -n "$without_venv" ]; then
        fail "$without_venv lacks the module venv or ensurepip; install it (Debian, Ubuntu: apt install $(
            "$without_venv" -c 'import sys; print("python%d.%d-venv" % sys.version_info[:2])')) or name another one: make PYTHON=/path/to/python"
    fi
    if [ -z "$python" ]; then
        found=$("${PYTHON:-python3}" -V 2>/dev/null) && found="${PYTHON:-python3} = $found" || found="no ${PYTHON:-python3}"
        fail "needs Python $(echo $versions | sed 's/ /, /g; s/\(.*\),/\1 or/'), found $found; install one or name it: make PYTHON=/path/to/python"
    fi
    "$python" -m venv --clear "$folder"
fi

echo "Setting up $folder with $("$folder/bin/python" -V) from $pins (the first time some 500 MB, about a minute) ..."
pip() {
    "$folder/bin/python" -m pip --disable-pip-version-check "$@"
}
# uv unpacks on all cores, in a quarter of pip's time; a mirror that pip is told of is taken by pip
with_uv() {
    ! pip config list | grep -q 'index-url' || return 1
    [ -x "$folder/uv/bin/uv" ] || pip install --quiet --no-compile --target "$folder/uv" uv==0.13.9 || return 1
    "$folder/uv/bin/uv" pip install --quiet --system-certs --no-deps --python "$folder/bin/python" -r "$pins"
}
with_uv 2> /dev/null || pip install --quiet --no-compile --no-deps -r "$pins" ||
    fail "pip could not install $pins into $folder (its message is above); what is there stays, try again"
# as pip would, on all cores, without what hardly runs; templates of other packages are no Python
"$folder/bin/python" -m compileall -qq -j 0 -x '/(tests?|pip|setuptools)/' "$folder"/lib/python3.*/site-packages || :

(cd "$(dirname "$0")/.." && pwd) > "$(echo "$folder"/lib/python3.*/site-packages)/this_tree.pth"
