# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# The beginning of scripts that measure programs of the preset bench: to be sourced in the directory of the project.
source scripts/packages.sh
source scripts/build.sh
need_packages "${packages_bench[@]}"
configure_preset bench
