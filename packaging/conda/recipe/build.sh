#!/usr/bin/env bash
# The compilers of conda have the names of their target; scripts/setup calls them by their plain names.
set -euo pipefail
tools=$(mktemp -d)
ln -s "$FC" "$tools/gfortran"
ln -s "$CC" "$tools/gcc"
ln -s "$CXX" "$tools/g++"
ln -s "$AR" "$tools/ar"
export PATH=$tools:$PATH LIBRARY_PATH=$PREFIX/lib SPINTOP_FPM=$BUILD_PREFIX/bin/fpm
spintop/packaging/from_sources sundials minpack "$PREFIX"
